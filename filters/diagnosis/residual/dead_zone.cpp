// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/residual.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "drivers/row_times/median.h"
#include "filters/diagnosis/search/scan.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/meaning.h"

namespace ifog {
namespace {

constexpr double kWidestZone = 0.5;    // of the largest rate
constexpr double kLeastWidth = 1e-3;   // of the largest rate
constexpr double kFactor = 1.15;       // ratio between widths that are independent tries
constexpr double kShare = 0.1;         // of the significance, as one of many tests
constexpr double kNearlyWhole = 0.1;   // tolerance of a coefficient of -1, besides three standard errors
constexpr double kWithoutOne = 12.0;   // required gain of twice the log-likelihood without the best crossing
constexpr std::size_t kMostTurns = 1;  // in one crossing, from one side of the zone to the other
constexpr double kFar = 1.0 / 3.0;     // of the half width: samples that are on one side
constexpr std::size_t kWindow = 64;    // samples of the running mean that removes slow error

// Minus the mean of the samples around; NaN where the sample or more than half of those around are missing.
Samples relative_to_mean(const Samples& values) {
  Samples out(values.size(), std::nan(""));
  double sum = 0.0, there = 0.0;
  const auto count = [&](double value, double sign) {
    if (!std::isfinite(value)) return;
    sum += sign * value;
    there += sign;
  };
  for (std::size_t end = 0; end < values.size(); ++end) {
    count(values[end], 1.0);
    if (end < kWindow) continue;
    const double value = values[end - kWindow / 2];
    if (there >= 0.5 * kWindow) out[end - kWindow / 2] = value - sum / there;
    count(values[end - kWindow], -1.0);
  }
  return out;
}

// One record: the true rate and the error, NaN where one of them is missing.
struct Turns {
  Samples rate, error;  // the error relative to those around it
};

// The rate where it is between these sizes, else 0.
Samples rate_between(const Samples& rate, double least, double most) {
  Samples hidden(rate);
  for (double& each : hidden)
    if (const double size = std::abs(each); size <= least || size >= most) each = 0.0;
  return hidden;
}

// Reduction of the squared error, by sample, if rates within the half width are not sensed; the error's regression on
// that rate. Both are relative to the same means.
struct Explained {
  double gain = 0.0, square = 0.0, product = 0.0;

  void add(double hidden, double error) {
    if (!std::isfinite(hidden) || !std::isfinite(error)) return;
    gain -= hidden * (2.0 * error + hidden);
    square += hidden * hidden;
    product += hidden * error;
  }
  void add(const Explained& other, double times = 1.0) {
    gain += times * other.gain;
    square += times * other.square;
    product += times * other.product;
  }
  // True if none of the rate is sensed, within three standard errors.
  [[nodiscard]] bool nearly_whole(double white_variance) const {
    return square > 0.0 &&
           std::abs(product / square + 1.0) <= kNearlyWhole + 3.0 * std::sqrt(white_variance / square);
  }
};

Explained explained_by(const std::vector<Turns>& records, double least, double half_width) {
  Explained sums;
  for (const Turns& record : records) {
    const Samples hidden = relative_to_mean(rate_between(record.rate, least, half_width));
    for (std::size_t i = 0; i < hidden.size(); ++i) sums.add(hidden[i], record.error[i]);
  }
  return sums;
}

// Standard deviation of the reference's noise, from second differences of the rate below the widest zone.
double noise_of(const std::vector<Turns>& records, double widest) {
  std::vector<double> bends;
  for (const Turns& record : records)
    for (std::size_t i = 1; i + 1 < record.rate.size(); ++i) {
      const double bend = record.rate[i - 1] - 2.0 * record.rate[i] + record.rate[i + 1];
      if (std::abs(record.rate[i]) < widest && std::isfinite(bend)) bends.push_back(std::abs(bend));
    }
  return bends.empty() ? 0.0 : median(std::move(bends)) / (0.6745 * std::sqrt(6.0));
}

// The same of the crossings alone, without the one that gains most. A turn crosses the zone once; at rest the reference's
// jitter changes its sign time and again, and its error is minus the jitter, as in a dead zone.
Explained explained_by_crossings(const std::vector<Turns>& records, double least, double half_width) {
  Explained all, best;
  for (const Turns& record : records) {
    const Samples hidden = relative_to_mean(rate_between(record.rate, least, half_width));
    for (std::size_t i = 0, end = 0; i < hidden.size(); i = end + 1) {
      Explained crossing;
      double side = 0.0;
      std::size_t turns = 0;
      for (end = i; end < hidden.size() && std::abs(record.rate[end]) < half_width; ++end) {
        const double rate = record.rate[end];
        crossing.add(hidden[end], record.error[end]);
        if (std::abs(rate) < kFar * half_width) continue;
        turns += rate * side < 0.0 ? 1 : 0;
        side = rate;
      }
      if (turns > kMostTurns) continue;
      all.add(crossing);
      if (crossing.gain > best.gain) best = crossing;
    }
  }
  all.add(best, -1.0);
  return all;
}

struct ZoneWidth {
  double half_width = 0.0, gain = 0.0;
};

std::vector<ZoneWidth> widths_between(const std::vector<Turns>& records, double least, double from, double to,
                                      double factor) {
  std::vector<ZoneWidth> tried;
  for (double width = from; width < to; width *= factor)
    tried.push_back({width, explained_by(records, least, width).gain});
  return tried;
}

// rates: true rates on the grid of the errors, by record, NaN missing; white_variance: of a sample. The coefficient is error /
// rate inside, -1 if no rotation is sensed.
std::optional<FoundEffect> find_dead_zone(const std::vector<EvenError>& errors,
                                          const std::vector<Samples>& rates, double white_variance,
                                          double significance) {
  std::vector<Turns> records;
  double most = 0.0;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    Samples rate = rates[r], error = *errors[r].rest;
    for (std::size_t i = 0; i < rate.size(); ++i) {
      if (!std::isfinite(rate[i] + error[i])) rate[i] = error[i] = std::nan("");
      if (std::isfinite(rate[i])) most = std::max(most, std::abs(rate[i]));
    }
    records.push_back({std::move(rate), relative_to_mean(error)});
  }
  // At rest the error is minus the reference's noise, as in a dead zone.
  constexpr double kOwnNoise = 5.0;  // standard deviations
  const double widest = kWidestZone * most, least = kOwnNoise * noise_of(records, widest);
  const double narrowest = std::max(least, kLeastWidth * most);
  if (!(white_variance > 0.0) || !(narrowest < widest)) return std::nullopt;
  const ZoneWidth coarse =
      std::ranges::max(widths_between(records, least, narrowest, widest, kFactor), {}, &ZoneWidth::gain);
  if (!(coarse.gain > 0.0)) return std::nullopt;
  const double step = std::pow(kFactor, 1.0 / 64.0);
  const std::vector<ZoneWidth> tried =
      widths_between(records, least, coarse.half_width / kFactor, coarse.half_width * kFactor, step);
  const ZoneWidth best = std::ranges::max(tried, {}, &ZoneWidth::gain);
  // True if twice the log-likelihood is within one of the maximum.
  const auto close = [&](const ZoneWidth& each) { return each.gain > best.gain - white_variance; };
  const double half_width_error =
      0.5 * (std::find_if(tried.rbegin(), tried.rend(), close)->half_width -
             std::ranges::find_if(tried, close)->half_width + best.half_width * (step - 1.0));
  FoundEffect zone;
  zone.likelihood_ratio = best.gain / white_variance;
  const double tries =
      independent_columns(static_cast<std::size_t>(std::log(widest / narrowest) / std::log(kFactor)));
  // The width is a second parameter.
  zone.p_value = std::min(1.0, kProfiled * chi_squared_above(zone.likelihood_ratio, 2.0) * tries);
  if (zone.p_value > kShare * significance) return std::nullopt;
  const Explained inside = explained_by(records, least, best.half_width);
  const Explained crossings = explained_by_crossings(records, least, best.half_width);
  if (!inside.nearly_whole(white_variance) || !crossings.nearly_whole(white_variance) ||
      crossings.gain < kWithoutOne * white_variance)
    return std::nullopt;
  zone.effect.parameters = {
      {"coefficient", inside.product / inside.square, std::sqrt(white_variance / inside.square), ""},
      {std::string(kHalfWidth), best.half_width, half_width_error, "rad/s"}};
  return zone;
}

}  // namespace

std::optional<FoundEffect> take_out_dead_zone(const std::vector<Record>& records, const std::string& channel,
                                              double significance, BlockGrid& grid,
                                              std::vector<EvenError>& errors) {
  std::vector<Samples> rates;
  for (const Record& record : records)
    rates.push_back(on_even_grid(record, grid.sample_s, record.reference_radps));
  std::optional<FoundEffect> found = find_dead_zone(errors, rates, grid.white_variance, significance);
  if (!found) return found;
  Effect& effect = found->effect;
  effect.form = name_of(Form::kDeadZone);
  effect.channel = channel;
  effect.parameters[0].unit = coefficient_unit(effect);
  effect.meaning = meaning_of(effect);
  double explained = 0.0, total = 0.0;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    // Error that the zone causes; zero where the rate is missing.
    Samples hidden(rates[r]);
    for (double& rate : hidden)
      rate = std::abs(rate) < effect.parameters[1].value ? effect.parameters[0].value * rate : 0.0;
    explained += variance_of(hidden);
    total += variance_of(*errors[r].before);
    take_out(hidden, r, grid, errors[r]);
  }
  found->variance_explained = total > 0.0 ? std::min(1.0, explained / total) : 0.0;
  return found;
}

}  // namespace ifog
