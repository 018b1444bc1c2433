// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/dead_zone.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/search/scan.h"
#include "filters/distributions/median.h"

namespace ifog {
namespace {

constexpr double kWidestZone = 0.5;   // of the largest rate
constexpr double kFactor = 1.15;      // between widths that are independent tries
constexpr double kShare = 0.1;        // of the significance: one question among all others
constexpr double kWithoutOne = 12.0;  // twice the log-likelihood that all passages but any one have to gain
constexpr double kNearlyWhole = 0.1;  // of a coefficient of -1, and three standard errors
constexpr std::size_t kWindow = 64;   // samples of the running mean that removes a slow error

// A sample whose rate is small. Its error is what is left about the mean of those around it.
struct Slow {
  double rate, bend;    // bend: second difference of the rate
  double gain;          // in the square of the error, where the sensor sees nothing of the rate
  double product;       // of rate and error
  std::size_t passage;  // through zero; it lasts as long as no rate is above the widest
};

std::vector<Slow> slow_samples(const std::vector<EvenError>& errors, const std::vector<Samples>& rates,
                               double widest) {
  std::vector<Slow> found;
  std::size_t passage = 0;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    const SharedSamples& error = errors[r].rest;
    for (std::size_t i = kWindow / 2; i + kWindow / 2 < error.size(); ++i) {
      const double rate = rates[r][i], bend = rates[r][i - 1] - 2.0 * rate + rates[r][i + 1];
      if (!(std::abs(rate) < widest) || !std::isfinite(error[i]) || !std::isfinite(bend)) {
        ++passage;
        continue;
      }
      const auto [sum, there] = finite_sum({error.begin() + i - kWindow / 2, kWindow + 1});
      if (there < 0.5 * kWindow) continue;
      const double left = error[i] - (sum - error[i]) / (there - 1.0);
      found.push_back({rate, bend, -rate * (2.0 * left + rate), rate * left, passage});
    }
  }
  return found;
}

// At rest the error is the reference's own noise with its sign changed, as if rotation as small as that were
// not seen: what lies within the noise says nothing.
void leave_out_noise(std::vector<Slow>& slow) {
  constexpr double kOwnNoise = 5.0;  // standard deviations
  std::vector<double> bends;
  bends.reserve(slow.size());
  for (const Slow& each : slow) bends.push_back(std::abs(each.bend));
  if (bends.empty()) return;
  const double noise = median(std::move(bends)) / (0.6745 * std::sqrt(6.0));
  std::erase_if(slow, [&](const Slow& each) { return std::abs(each.rate) <= kOwnNoise * noise; });
}

// What all passages but the one that says most gain.
double without_best_passage(std::vector<Slow> inside) {
  std::sort(inside.begin(), inside.end(), [](const Slow& a, const Slow& b) { return a.passage < b.passage; });
  double all = 0.0, most = 0.0, mine = 0.0;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (i > 0 && inside[i].passage != inside[i - 1].passage) mine = 0.0;
    all += inside[i].gain;
    mine += inside[i].gain;
    most = std::max(most, mine);
  }
  return all - most;
}

}  // namespace

std::optional<DeadZone> find_dead_zone(const std::vector<EvenError>& errors,
                                       const std::vector<Samples>& rates, double white_variance,
                                       double significance) {
  double most = 0.0;
  for (const Samples& rate : rates)
    for (const double each : rate)
      if (std::isfinite(each)) most = std::max(most, std::abs(each));
  std::vector<Slow> slow = slow_samples(errors, rates, kWidestZone * most);
  leave_out_noise(slow);
  std::sort(slow.begin(), slow.end(),
            [](const Slow& a, const Slow& b) { return std::abs(a.rate) < std::abs(b.rate); });
  std::vector<double> gained;  // by all samples up to that rate
  gained.reserve(slow.size());
  double sum = 0.0;
  for (const Slow& each : slow) gained.push_back(sum += each.gain);
  if (gained.empty() || !(white_variance > 0.0)) return std::nullopt;
  const auto best = std::max_element(gained.begin(), gained.end());
  const auto inside = static_cast<std::size_t>(best - gained.begin()) + 1;
  DeadZone zone;
  zone.half_width = std::abs(slow[inside - 1].rate);
  zone.ratio = *best / white_variance;
  const double tries = independent_columns(static_cast<std::size_t>(
      std::log(kWidestZone * most / std::max(std::abs(slow.front().rate), 1e-3 * most)) / std::log(kFactor)));
  // The width between its neighbours is a second parameter.
  zone.p_value = std::min(1.0, kProfiled * tail(zone.ratio, 2) * tries);
  if (zone.p_value > kShare * significance) return std::nullopt;
  // Where twice the log-likelihood is within one of the most.
  const auto close = [&](double value) { return value > *best - white_variance; };
  const auto from = std::find_if(gained.begin(), gained.end(), close) - gained.begin();
  const auto to = gained.rend() - std::find_if(gained.rbegin(), gained.rend(), close);
  zone.half_width_error = 0.5 * (std::abs(slow[static_cast<std::size_t>(to) - 1].rate) -
                                 std::abs(slow[static_cast<std::size_t>(from)].rate));
  slow.resize(inside);
  double square = 0.0, product = 0.0;
  for (const Slow& each : slow) square += each.rate * each.rate, product += each.product;
  zone.coefficient = product / square;
  zone.coefficient_error = std::sqrt(white_variance / square);
  if (std::abs(zone.coefficient + 1.0) > kNearlyWhole + 3.0 * zone.coefficient_error) return std::nullopt;
  if (without_best_passage(std::move(slow)) < kWithoutOne * white_variance) return std::nullopt;
  return zone;
}

Samples hidden_by(const DeadZone& zone, std::span<const double> rate) {
  Samples hidden;
  hidden.reserve(rate.size());
  for (const double each : rate)
    hidden.push_back(std::abs(each) < zone.half_width ? zone.coefficient * each : 0.0);
  return hidden;
}

void take_out(const DeadZone& zone, const std::vector<Samples>& rates, BlockGrid& grid,
              std::vector<EvenError>& errors) {
  for (std::size_t r = 0; r < errors.size(); ++r) take_out(hidden_by(zone, rates[r]), r, grid, errors[r]);
}

}  // namespace ifog
