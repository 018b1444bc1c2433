// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/channels/reconstruct.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "drivers/row_times/median.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/step_means.h"
#include "filters/model_file/channel_names.h"

namespace ifog {
namespace {

// Largest number of readings, or means of readings, for the estimate of smoothness.
constexpr std::size_t kMostReadings = 4096;
// Required gain of log-likelihood over a random walk, whose jumps a spline would blur.
constexpr double kSmoother = 5.0;
constexpr double kScatter = 6.0;
// Required standard deviation in units of the reading noise.
constexpr double kAboveNoise = 3.0;

struct Reading {
  double step;  // position on the fine grid, fractional
  double value;
};

double change_of(std::span<const Reading> readings) {
  std::vector<double> changes;
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const double change = std::abs(readings[i].value - readings[i - 1].value);
    if (change != 0.0) changes.push_back(change);
  }
  return changes.empty() ? 0.0 : median(std::move(changes));
}

// Readings that repeat a neighbour. Where a coarse reading crosses from one level to the next, noise makes others.
std::vector<Reading> repeated(std::span<const Reading> readings) {
  std::vector<Reading> found;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const bool before = i > 0 && readings[i - 1].value == readings[i].value;
    const bool after = i + 1 < readings.size() && readings[i + 1].value == readings[i].value;
    if (before || after) found.push_back(readings[i]);
  }
  return found;
}

// Where a coarse reading changes from one level to another.
struct Crossing {
  double first, last;  // steps between which it is
  double value;
};

// While a channel crosses from one level to the next, noise makes its reading flip. Crossings of one value whose distance
// is at most their own length are one.
void join(std::vector<Crossing>& crossings) {
  for (std::size_t before = 0; before != crossings.size();) {
    before = crossings.size();
    std::vector<Crossing> joined;
    for (const Crossing& each : crossings) {
      Crossing* const last = joined.empty() ? nullptr : &joined.back();
      if (last && last->value == each.value &&
          each.first - last->last <= last->last - last->first + each.last - each.first)
        last->last = each.last;
      else
        joined.push_back(each);
    }
    crossings = std::move(joined);
  }
}

// Positions where a coarse reading changes, at half a step; a change over several steps is one.
std::vector<Reading> crossings(std::span<const Reading> readings, double step) {
  std::vector<Crossing> found;
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const Reading &before = readings[i - 1], &after = readings[i];
    const double change = after.value - before.value;
    if (change == 0.0) continue;
    if (std::abs(change) < 1.5 * step) {
      found.push_back({before.step, after.step, 0.5 * (after.value + before.value)});
    } else {
      if (found.empty() || found.back().last < before.step)
        found.push_back({before.step, before.step, before.value});
      found.push_back({after.step, after.step, after.value});
    }
  }
  join(found);
  std::vector<Reading> middles;
  for (const Crossing& each : found) middles.push_back({0.5 * (each.first + each.last), each.value});
  return middles;
}

// What drives the channel between its readings: a random walk of its slope, or of its level.
enum class Course { kSmooth, kWalk };

// Level and slope; covariance relative to a reading's variance.
struct State {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

Eigen::Matrix2d transition(double d) { return (Eigen::Matrix2d() << 1.0, d, 0.0, 1.0).finished(); }

// d: steps; drive: variance of the walk per step.
State predicted(const State& s, double d, Course course, double drive) {
  State ahead{transition(d) * s.value, transition(d) * s.covariance * transition(d).transpose()};
  if (course == Course::kWalk)
    ahead.covariance(0, 0) += drive * d;
  else
    ahead.covariance +=
        drive * (Eigen::Matrix2d() << d * d * d / 3.0, d * d / 2.0, d * d / 2.0, d).finished();
  return ahead;
}

State updated(const State& s, double reading) {
  const Eigen::Vector2d gain = s.covariance.col(0) / (s.covariance(0, 0) + 1.0);
  return {s.value + gain * (reading - s.value[0]), s.covariance - gain * s.covariance.row(0)};
}

// State after the first two readings, with a diffuse prior of what the course leaves free.
State started(const Reading& a, const Reading& b, Course course, double drive) {
  State s;
  s.value[0] = b.value;
  s.covariance(0, 0) = 1.0;
  if (course == Course::kWalk) return s;
  const double d = b.step - a.step;
  s.value[1] = (b.value - a.value) / d;
  s.covariance(0, 1) = s.covariance(1, 0) = 1.0 / d;
  s.covariance(1, 1) = 2.0 / (d * d) + drive * d / 3.0;
  return s;
}

// Log-likelihood of the readings after the second one, so that those of the courses are comparable.
double likelihood(std::span<const Reading> readings, Course course, double drive) {
  double square = 0.0, determinant = 0.0;
  State s = started(readings[0], readings[1], course, drive);
  for (std::size_t i = 2; i < readings.size(); ++i) {
    s = predicted(s, readings[i].step - readings[i - 1].step, course, drive);
    const double variance = s.covariance(0, 0) + 1.0;
    square += std::pow(readings[i].value - s.value[0], 2) / variance;
    determinant += std::log(variance);
    s = updated(s, readings[i].value);
  }
  const auto count = static_cast<double>(readings.size() - 2);
  return -0.5 * (count * std::log(std::max(square, 1e-300) / count) + determinant);
}

// Means of readings, as many as allowed, over the whole record, because the spline must follow its few kinks.
std::vector<Reading> thinned(const std::vector<Reading>& readings) {
  const std::size_t share = (readings.size() + kMostReadings - 1) / kMostReadings;
  if (share < 2) return readings;
  std::vector<Reading> means;
  for (std::size_t i = 0; i + share <= readings.size(); i += share) {
    Reading mean{0.0, 0.0};
    for (std::size_t j = i; j < i + share; ++j) {
      mean.step += readings[j].step / static_cast<double>(share);
      mean.value += readings[j].value / static_cast<double>(share);
    }
    means.push_back(mean);
  }
  return means;
}

struct Drive {
  double drive, likelihood;
};

// Most likely ratio, per step, of the slope's (or level's) random walk to the reading variance: the best decade,
// then Brent's search around it.
Drive best_drive(std::span<const Reading> readings, Course course) {
  const auto lacking = [&](double power) { return -likelihood(readings, course, std::pow(10.0, power)); };
  double decade = 0.0, least = std::numeric_limits<double>::infinity();
  for (int power = -16; power <= 4; ++power)
    if (const double value = lacking(power); value < least) least = value, decade = power;
  constexpr int kBits = 4;  // an eighth of a decade
  const auto [power, value] =
      boost::math::tools::brent_find_minima(lacking, decade - 1.0, decade + 1.0, kBits);
  return {std::pow(10.0, power), -value};
}

// Rauch-Tung-Striebel smoother; levels and slopes at the readings.
std::vector<State> smoothed(std::span<const Reading> readings, double drive) {
  const auto steps_to = [&](std::size_t i) { return readings[i].step - readings[i - 1].step; };
  std::vector<State> states(readings.size());
  states[1] = started(readings[0], readings[1], Course::kSmooth, drive);
  for (std::size_t i = 2; i < readings.size(); ++i)
    states[i] = updated(predicted(states[i - 1], steps_to(i), Course::kSmooth, drive), readings[i].value);
  for (std::size_t i = readings.size() - 1; i-- > 1;) {
    State& s = states[i];
    const State ahead = predicted(s, steps_to(i + 1), Course::kSmooth, drive);
    const Eigen::Matrix2d gain =
        s.covariance * transition(steps_to(i + 1)).transpose() * ahead.covariance.inverse();
    s.value += gain * (states[i + 1].value - ahead.value);
  }
  states[0].value = transition(-steps_to(1)) * states[1].value;
  return states;
}

// Cubic Hermite spline through levels and slopes; arguments must not decrease.
class Spline {
 public:
  Spline(std::span<const Reading> readings, double drive)
      : readings_(readings), states_(smoothed(readings, drive)) {}

  double at(double step) {
    const Reading &first = readings_.front(), &last = readings_.back();
    while (i_ + 2 < readings_.size() && readings_[i_ + 1].step <= step) ++i_;
    if (step < first.step) return (transition(step - first.step) * states_.front().value)[0];
    if (step > last.step) return (transition(step - last.step) * states_.back().value)[0];
    return between(readings_[i_], states_[i_], readings_[i_ + 1], states_[i_ + 1], step);
  }

 private:
  static double between(const Reading& from, const State& a, const Reading& to, const State& b, double step) {
    const double d = to.step - from.step;
    const double u = (step - from.step) / d;
    const double rest = 1.0 - u;
    return a.value[0] * (1.0 + 2.0 * u) * rest * rest + b.value[0] * u * u * (3.0 - 2.0 * u) +
           d * u * rest * (a.value[1] * rest - b.value[1] * u);
  }

  std::span<const Reading> readings_;
  std::vector<State> states_;
  std::size_t i_ = 0;
};

bool is_read(std::span<const std::uint8_t> read, std::size_t step) { return read.empty() || read[step] != 0; }

std::vector<Reading> readings_in(std::span<const double> values, std::span<const std::uint8_t> read) {
  std::vector<Reading> readings;
  readings.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (is_read(read, i)) readings.push_back({static_cast<double>(i), values[i]});
  return readings;
}

Reconstruction as_read(std::span<const double> values) { return {{values.begin(), values.end()}, false}; }

}  // namespace

Reconstruction reconstruct(std::span<const double> values, std::span<const std::uint8_t> read) {
  std::vector<Reading> readings = readings_in(values, read);
  const bool coarse = is_coarse(values);
  if (coarse) readings = repeated(readings);
  const double step = coarse ? change_of(readings) : 0.0;
  const std::vector<Reading> used = coarse ? crossings(readings, step) : readings;
  if (used.size() < 8) return as_read(values);
  const std::vector<Reading> few = thinned(used);
  const Drive smooth = best_drive(few, Course::kSmooth);
  if (smooth.likelihood < best_drive(few, Course::kWalk).likelihood + kSmoother) return as_read(values);
  // Ratio of the variance of a mean to that of a reading.
  const double share = static_cast<double>(few.size()) / static_cast<double>(used.size());
  Spline spline(used, smooth.drive * share);
  Reconstruction result{{}, true};
  std::vector<double> taken;  // the residual must be reading noise
  for (std::size_t i = 0; i < values.size(); ++i) {
    double value = spline.at(static_cast<double>(i));
    if (coarse) value = std::clamp(value, values[i] - 0.5 * step, values[i] + 0.5 * step);
    result.values.push_back(value);
    if (is_read(read, i)) taken.push_back(values[i] - value);
  }
  if (!coarse && !stands_still(taken)) return as_read(values);
  return variance_of(result.values) > kAboveNoise * kAboveNoise * variance_of(taken) ? result
                                                                                     : as_read(values);
}

bool stands_still(std::span<const double> readings) {
  std::vector<double> means(readings.begin(), readings.end());
  const double white = variance_of(means);
  for (double length = 4.0; means.size() >= 64; length *= 4.0) {
    const std::size_t n = means.size() / 4;
    for (std::size_t i = 0; i < n; ++i) {
      means[i] = 0.25 * (means[4 * i] + means[4 * i + 1] + means[4 * i + 2] + means[4 * i + 3]);
    }
    means.resize(n);
    const double excess = variance_of(means) * length / std::max(white, 1e-300) - 1.0;
    if (excess > kScatter * std::sqrt(2.0 / static_cast<double>(n))) return false;
  }
  return true;
}

// The difference of two quantised readings has irregular steps, so it is recomputed.
void rebuild_differences(BlockData& data) {
  for (FineChannel& channel : data.channels) {
    const ChannelNames names = names_in(channel.name);
    if (names.less.empty()) continue;
    const std::optional<std::size_t> of = data.index_of(names.of), less = data.index_of(names.less);
    if (!of || !less) continue;
    const FineChannel &one = data.channels[*of], &other = data.channels[*less];
    channel.smooth = one.smooth && other.smooth;
    for (std::size_t k = 0; k < channel.values.size(); ++k)
      channel.values[k] = one.values[k] - other.values[k];
  }
}

BlockData with_reconstructed_channels(const BlockData& data) {
  BlockData reconstructed = data;
  const BlockGrid& grid = data.grid;
  for (std::size_t c = 0; c < reconstructed.channels.size(); ++c) {
    FineChannel& channel = reconstructed.channels[c];
    if (static_cast<std::ptrdiff_t>(c) == data.reference || !channel.varies || !channel.environment())
      continue;
    for (const BlockRange& record : grid.records) {
      const bool first = record.first == 0;
      const BlockRange steps = grid.fine_steps(record);
      const auto part = [&](const auto& all) {
        return all.empty() ? std::span(all) : std::span(all).subspan(steps.first, steps.size());
      };
      const std::span<const double> values = part(data.channels[c].values);
      const std::span<const std::uint8_t> read = part(data.channels[c].read);
      const Reconstruction found = reconstruct(values, read);
      std::vector<double> readings;
      for (std::size_t k = 0; k < values.size(); ++k)
        if (is_read(read, k)) readings.push_back(values[k]);
      std::copy(found.values.begin(), found.values.end(),
                channel.values.begin() + static_cast<std::ptrdiff_t>(steps.first));
      channel.smooth = found.smooth && (first || channel.smooth);
      channel.still = stands_still(readings) && (first || channel.still);
    }
  }
  rebuild_differences(reconstructed);
  return reconstructed;
}

}  // namespace ifog
