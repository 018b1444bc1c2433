// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/dead_zone.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/search/scan.h"
#include "filters/distributions/chi_squared.h"
#include "filters/distributions/median.h"
#include "filters/effects/meaning.h"

namespace ifog {
namespace {

constexpr double kWidestZone = 0.5;    // of the largest rate
constexpr double kFactor = 1.15;       // ratio between widths that are independent tries
constexpr double kShare = 0.1;         // of the significance, as one of many tests
constexpr double kWithoutOne = 12.0;   // required gain of twice the log-likelihood without the best crossing
constexpr double kNearlyWhole = 0.1;   // tolerance of a coefficient of -1, besides three standard errors
constexpr std::size_t kMostTurns = 1;  // in one crossing, from one side of the zone to the other
constexpr double kFar = 1.0 / 3.0;     // of the half width: samples that are on one side
constexpr std::size_t kWindow = 64;    // samples of the running mean that removes slow error

// A sample with a small rate. Its error is relative to the mean of those around it.
struct Slow {
  double rate, bend;    // bend: second difference of the rate
  double gain;          // reduction of the squared error if the sensor does not sense the rate
  double product;       // rate times error
  std::size_t passage;  // index of the crossing of zero, which lasts while the rate is below the widest
};

std::vector<Slow> slow_samples(const std::vector<EvenError>& errors, const std::vector<Samples>& rates,
                               double widest) {
  std::vector<Slow> found;
  std::size_t passage = 0;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    const Samples& error = *errors[r].rest;
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

// At rest the error is minus the reference's noise, as in a dead zone. So rates within that noise are
// excluded.
void leave_out_noise(std::vector<Slow>& slow) {
  constexpr double kOwnNoise = 5.0;  // standard deviations
  std::vector<double> bends;
  bends.reserve(slow.size());
  for (const Slow& each : slow) bends.push_back(std::abs(each.bend));
  if (bends.empty()) return;
  const double noise = median(std::move(bends)) / (0.6745 * std::sqrt(6.0));
  std::erase_if(slow, [&](const Slow& each) { return std::abs(each.rate) <= kOwnNoise * noise; });
}

// Gain of the crossings without the one that gains most. A turn crosses the zone once; at rest the reference's jitter
// changes its sign time and again, and its error is minus the jitter, as in a dead zone.
double without_best_crossing(const std::vector<Slow>& inside, double half_width) {
  double all = 0.0, most = 0.0;
  for (std::size_t i = 0, end = 0; i < inside.size(); i = end) {
    double gain = 0.0, side = 0.0;
    std::size_t turns = 0;
    for (end = i; end < inside.size() && inside[end].passage == inside[i].passage; ++end) {
      const double rate = inside[end].rate;
      gain += inside[end].gain;
      if (std::abs(rate) < kFar * half_width) continue;
      turns += rate * side < 0.0 ? 1 : 0;
      side = rate;
    }
    if (turns > kMostTurns) continue;
    all += gain;
    most = std::max(most, gain);
  }
  return all - most;
}

struct DeadZone {
  double half_width = 0.0;  // rad/s
  double half_width_error = 0.0;
  double coefficient = 0.0;  // error / rate inside; -1 if no rotation is sensed
  double coefficient_error = 0.0;
  double ratio = 0.0;  // gain of twice the log-likelihood
  double p_value = 1.0;
};

// rates: true rates on the grid of the errors, by record, NaN missing; white_variance: of a sample.
std::optional<DeadZone> find_dead_zone(const std::vector<EvenError>& errors,
                                       const std::vector<Samples>& rates, double white_variance,
                                       double significance) {
  double most = 0.0;
  for (const Samples& rate : rates)
    for (const double each : rate)
      if (std::isfinite(each)) most = std::max(most, std::abs(each));
  std::vector<Slow> slow = slow_samples(errors, rates, kWidestZone * most);
  leave_out_noise(slow);
  std::ranges::sort(slow, [](const Slow& a, const Slow& b) { return std::abs(a.rate) < std::abs(b.rate); });
  std::vector<double> gained;  // by all samples up to this rate
  gained.reserve(slow.size());
  double sum = 0.0;
  for (const Slow& each : slow) gained.push_back(sum += each.gain);
  if (gained.empty() || !(white_variance > 0.0)) return std::nullopt;
  const auto best = std::ranges::max_element(gained);
  const auto inside = static_cast<std::size_t>(best - gained.begin()) + 1;
  DeadZone zone;
  const double last = std::abs(slow[inside - 1].rate);  // inside
  const double next = std::abs(slow[std::min(inside, slow.size() - 1)].rate);
  zone.half_width = 0.5 * (last + next);
  zone.ratio = *best / white_variance;
  const double tries = independent_columns(static_cast<std::size_t>(
      std::log(kWidestZone * most / std::max(std::abs(slow.front().rate), 1e-3 * most)) / std::log(kFactor)));
  // The width is a second parameter.
  zone.p_value = std::min(1.0, kProfiled * chi_squared_above(zone.ratio, 2.0) * tries);
  if (zone.p_value > kShare * significance) return std::nullopt;
  // True if twice the log-likelihood is within one of the maximum.
  const auto close = [&](double value) { return value > *best - white_variance; };
  const auto from = std::ranges::find_if(gained, close) - gained.begin();
  const auto to = gained.rend() - std::find_if(gained.rbegin(), gained.rend(), close);
  zone.half_width_error = 0.5 * (std::abs(slow[static_cast<std::size_t>(to) - 1].rate) -
                                 std::abs(slow[static_cast<std::size_t>(from)].rate) + next - last);
  slow.resize(inside);
  double square = 0.0, product = 0.0;
  for (const Slow& each : slow) square += each.rate * each.rate, product += each.product;
  zone.coefficient = product / square;
  zone.coefficient_error = std::sqrt(white_variance / square);
  if (std::abs(zone.coefficient + 1.0) > kNearlyWhole + 3.0 * zone.coefficient_error) return std::nullopt;
  if (without_best_crossing(slow_samples(errors, rates, zone.half_width), zone.half_width) <
      kWithoutOne * white_variance)
    return std::nullopt;
  return zone;
}

// Error that the zone causes, by sample; zero where the rate is missing.
Samples hidden_by(const DeadZone& zone, std::span<const double> rate) {
  Samples hidden;
  hidden.reserve(rate.size());
  for (const double each : rate)
    hidden.push_back(std::abs(each) < zone.half_width ? zone.coefficient * each : 0.0);
  return hidden;
}

}  // namespace

std::optional<FoundEffect> take_out_dead_zone(const std::vector<Record>& records, const std::string& channel,
                                              double significance, BlockGrid& grid,
                                              std::vector<EvenError>& errors) {
  std::vector<Samples> rates;
  for (const Record& record : records)
    rates.push_back(on_even_grid(record, grid.sample_s, record.reference_radps));
  const auto zone = find_dead_zone(errors, rates, grid.white_variance, significance);
  if (!zone) return std::nullopt;
  FoundEffect found;
  Effect& effect = found.effect;
  effect.form = name_of(Form::kDeadZone);
  effect.channel = channel;
  effect.parameters = {{"coefficient", zone->coefficient, zone->coefficient_error, coefficient_unit(effect)},
                       {std::string(kHalfWidth), zone->half_width, zone->half_width_error, "rad/s"}};
  effect.meaning = meaning_of(effect);
  found.p_value = zone->p_value;
  found.likelihood_ratio = zone->ratio;
  double explained = 0.0, total = 0.0;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    const Samples hidden = hidden_by(*zone, rates[r]);
    explained += variance_of(hidden);
    total += variance_of(*errors[r].before);
    take_out(hidden, r, grid, errors[r]);
  }
  found.variance_explained = total > 0.0 ? std::min(1.0, explained / total) : 0.0;
  return found;
}

}  // namespace ifog
