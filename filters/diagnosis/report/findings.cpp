// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/search/scan.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/meaning.h"
#include "filters/effects/reach.h"
#include "filters/model_file/channel_names.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

// The joint fit is linear in the logarithm of a time constant; it is not valid beyond this.
constexpr double kFarthest = 0.3;
// Required significance of a curvature, in standard errors, for extrapolation.
constexpr double kWellKnown = 5.0;
constexpr int kHighestFollowed = 3;  // higher powers are only a series expansion

std::vector<double> used_values(const BlockGrid& grid, const Eigen::VectorXd& values) {
  std::vector<double> used;
  for (std::size_t b = 0; b < grid.size(); ++b)
    if (grid.valid[b]) used.push_back(values[static_cast<Eigen::Index>(b)]);
  return used;
}

// Index in the joint fit of parameter `at` of an effect; -1 if it has none there.
Eigen::Index index_in(const JointFit& joint, const BlockGrid& grid, std::size_t i, const Effect& effect,
                      std::size_t at) {
  if (at == 0) return column_of(grid, i) - 1;
  for (std::size_t j = 0; j < joint.searched.size(); ++j)
    if (joint.searched[j].effect == i && joint.searched[j].name_in(effect) == effect.parameters[at].name)
      return joint.first_searched() + static_cast<Eigen::Index>(j);
  return -1;
}

// Capture that would distinguish two effects.
std::string capture_that_separates(const BlockData& data, const Candidate& one, const Candidate& other) {
  const bool timed = one.channel == Candidate::kNone || other.channel == Candidate::kNone;
  const std::size_t channel = one.channel == Candidate::kNone ? other.channel : one.channel;
  const std::string name = channel == Candidate::kNone ? "" : data.channels[channel].name;
  if (!name.empty() && other.form == Form::kStep) {
    const double at_s = data.grid.origin_of(other.record).in_s(other.time_s);
    return "a capture in which " + name + " changes while the gyro stays on and untouched, not only at " +
           told_time(at_s) + " s";
  }
  if (timed && !name.empty()) {
    return "a capture in which " + name +
           " goes up and comes down again, so that it does not run with the time";
  }
  if (timed) return "a longer capture, started from cold";
  if (one.channel != other.channel) {
    return "a capture in which " + data.channels[one.channel].name + " changes while " +
           data.channels[other.channel].name + " stays";
  }
  if (has_memory(one.form) || has_memory(other.form)) {
    const double tau = std::max(one.time_constant_s, other.time_constant_s);
    return "a capture in which " + name + " changes and then rests for several times " +
           formatted("%.3g s", tau) + ", at different speeds";
  }
  const double reference = reference_of(name);
  return "a capture over a wider range of " + name + ", on both sides of " +
         std::to_string(static_cast<int>(reference)) + " " + unit_of(name);
}

}  // namespace

Effect effect_with(const BlockData& data, const Candidate& candidate, double coefficient,
                   const std::string& axis) {
  Effect effect = effect_of(data, candidate);
  effect.axis = axis;
  effect.parameters.front().value = coefficient;
  return effect;
}

JointFit settle(const BlockData& reconstructed, SearchResult& found) {
  const Eigen::VectorXd coefficients = coefficients_of(found.chosen);
  JointFit joint = joint_fit(reconstructed, candidates_of(found.chosen), found.noise, &coefficients);
  const Eigen::Index linear = joint.first_searched();
  for (std::size_t j = 0; j < joint.searched.size(); ++j) {
    Candidate& candidate = found.chosen[joint.searched[j].effect].candidate;
    const double by = std::clamp(joint.values[linear + static_cast<Eigen::Index>(j)], -kFarthest, kFarthest);
    candidate = joint.searched[j].moved(candidate, by);
  }
  // The searched parameters have moved, so the coefficients' covariance is taken from the joint one.
  joint.of_coefficients = joint.covariance.topLeftCorner(linear, linear);
  if (!joint.searched.empty()) {
    const JointFit there = joint_fit(reconstructed, candidates_of(found.chosen), found.noise);
    joint.values.head(linear) = there.values.head(linear);
    joint.of_coefficients = there.covariance.topLeftCorner(linear, linear);
  }
  for (std::size_t i = 0; i < found.chosen.size(); ++i)
    found.chosen[i].coefficient = joint.values[column_of(reconstructed.grid, i) - 1];
  return joint;
}

namespace {

int highest_power(const Effect& effect) {
  const Form form = form_named(effect.form).value_or(Form::kLinear);
  return power_of(form == Form::kProduct ? form_named(effect.with_form).value_or(Form::kLinear) : form);
}

// True if its power is of the rate.
bool is_of_rate(const Effect& effect) {
  const std::string& of = effect.form == name_of(Form::kProduct) ? effect.with_channel : effect.channel;
  return kind_of(of) == ChannelKind::kReferenceRate;
}

// Extrapolates a significant curvature as a square instead of a tangent, whose error one span outside the
// range is as large as the square's part within. Not if the channel has higher powers: they are a series. A
// cube is extrapolated only of the rate; for environmental channels it is a series as well (a regulator below
// its supply limit).
void follow_known_curves(const BlockData& data, std::vector<FoundEffect>& effects) {
  const auto channels = [](const Effect& effect) {
    return std::array<std::string, 2>{effect.channel, effect.with_channel};
  };
  for (FoundEffect& found : effects) {
    Effect& effect = found.effect;
    const int power = highest_power(effect);
    if (power < 2 || power > kHighestFollowed) continue;
    const bool series = std::ranges::any_of(effects, [&](const FoundEffect& other) {
      const int its = highest_power(other.effect);
      return (its > kHighestFollowed || (its > 2 && !is_of_rate(other.effect))) &&
             channels(other.effect) == channels(effect);
    });
    const ModelParameter& size = effect.parameters.front();
    if (series || !(std::abs(size.value) > kWellKnown * size.std_error)) continue;
    const std::string& of = effect.form == name_of(Form::kProduct) ? effect.with_channel : effect.channel;
    if (const std::optional<std::size_t> channel = data.index_of(of))
      effect.parameters.push_back({std::string(kCurveReach),
                                   data.channels[*channel].high - data.channels[*channel].low, 0.0,
                                   unit_of(of)});
  }
}

// Chosen effects with parameters, their errors, and each one's part of the error by block.
std::vector<Eigen::VectorXd> add_effects(const BlockData& data, const SearchResult& found,
                                         const JointFit& joint, const std::string& axis,
                                         std::vector<FoundEffect>& effects) {
  std::vector<Eigen::VectorXd> parts;
  const BlockGrid& grid = data.grid;
  const Columns columns = design(data, candidates_of(found.chosen));
  const double total = variance_of(used_values(grid, grid.error));
  for (std::size_t i = 0; i < found.chosen.size(); ++i) {
    const Chosen& chosen = found.chosen[i];
    FoundEffect effect;
    effect.effect = effect_with(data, chosen.candidate, chosen.coefficient, axis);
    effect.p_value = chosen.p_value;
    effect.likelihood_ratio = chosen.likelihood_ratio;
    std::vector<ModelParameter>& parameters = effect.effect.parameters;
    const Eigen::Index at = column_of(grid, i) - 1;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const Eigen::Index index = index_in(joint, grid, i, effect.effect, k);
      if (index < 0) continue;
      const double sigma = std::sqrt(joint.covariance(index, index));
      parameters[k].std_error = k == 0 ? sigma : sigma * parameters[k].value;
    }
    Eigen::VectorXd part = columns.col(1 + at) * chosen.coefficient;
    // p-value from the fit's error bar, if that is less significant than the likelihood ratio.
    if (joint.of_coefficients(at, at) > 0.0) {
      const double z = joint.values[at] / std::sqrt(joint.of_coefficients(at, at));
      const double tries = chosen.of_a_law ? 1.0 : found.tries;
      effect.p_value =
          std::max(effect.p_value, std::min(1.0, kProfiled * chi_squared_above(z * z, 1.0) * tries));
    }
    const double share = total > 0.0 ? variance_of(used_values(grid, part)) / total : 0.0;
    effect.variance_explained = std::min(1.0, share);
    parts.push_back(std::move(part));
    effects.push_back(std::move(effect));
  }
  return parts;
}

void add_alternatives(const BlockData& data, const SearchResult& found, Diagnosis& diagnosis) {
  for (const Alternative& alternative : found.alternatives)
    diagnosis.indistinguishable.push_back(
        {{diagnosis.effects[alternative.of].effect, effect_of(data, alternative.candidate)},
         alternative.correlation,
         capture_that_separates(data, found.chosen[alternative.of].candidate, alternative.candidate)});
}

// On one heading the Earth's rate in a tilting axis cannot be distinguished from g-sensitivity: same
// regressor.
void add_earth_rate(Diagnosis& diagnosis) {
  for (const FoundEffect& each : diagnosis.effects) {
    const Effect& effect = each.effect;
    if (effect.form != name_of(Form::kEarthRate)) continue;
    Indistinguishable pair;
    pair.effects = {effect, effect};
    pair.effects[1].form = name_of(Form::kLinear);
    pair.correlation = 1.0;
    pair.separate_by =
        "the same capture with the heading reversed: the horizontal part of the Earth's rate changes its "
        "sign, g-sensitivity does not; its vertical part, along the gyro's own axis, only an acceleration "
        "without tilt tells";
    diagnosis.indistinguishable.push_back(std::move(pair));
  }
}

}  // namespace

std::vector<Eigen::VectorXd> write_findings(const BlockData& data, const SearchResult& found,
                                            const JointFit& joint, const std::string& axis,
                                            Diagnosis& diagnosis) {
  diagnosis.effects.clear();
  diagnosis.indistinguishable.clear();
  std::vector<Eigen::VectorXd> parts = add_effects(data, found, joint, axis, diagnosis.effects);
  follow_known_curves(data, diagnosis.effects);
  add_alternatives(data, found, diagnosis);
  add_earth_rate(diagnosis);
  return parts;
}

std::vector<double> covariance_of(const std::vector<FoundEffect>& effects, const JointFit& joint,
                                  const BlockGrid& grid, std::size_t jointly) {
  struct Row {
    Eigen::Index index = -1;  // in the joint fit
    double scale = 1.0;       // parameter / that value's unit
    double alone = 0.0;       // variance of a parameter that is not in the joint fit
  };
  std::vector<Row> rows;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const Effect& effect = effects[i].effect;
    for (std::size_t j = 0; j < effect.parameters.size(); ++j) {
      const ModelParameter& parameter = effect.parameters[j];
      rows.push_back({i < jointly ? index_in(joint, grid, i, effect, j) : -1, j == 0 ? 1.0 : parameter.value,
                      parameter.std_error * parameter.std_error});
    }
  }
  const std::size_t n = rows.size();
  std::vector<double> covariance(n * n, 0.0);
  for (std::size_t a = 0; a < n; ++a) {
    covariance[a * n + a] = rows[a].alone;
    for (std::size_t b = 0; b < n; ++b) {
      if (rows[a].index < 0 || rows[b].index < 0) continue;
      covariance[a * n + b] = rows[a].scale * rows[b].scale * joint.covariance(rows[a].index, rows[b].index);
    }
  }
  return covariance;
}

namespace {

// True if one of its channels had the value at which the effect is zero. An effect of time, of a change, of a
// phase or of a vibration is zero where the sensor is at rest.
bool is_zero_within(const Effect& effect, const std::vector<ChannelRange>& ranges) {
  const auto covers = [&](const std::string& channel, double reference) {
    const auto range = std::ranges::find(ranges, channel, &ChannelRange::channel);
    return range == ranges.end() || (range->low <= reference && reference <= range->high);
  };
  const Form form = form_named(effect.form).value_or(Form::kBias);
  if (form == Form::kProduct)
    return covers(effect.channel, effect.reference) || covers(effect.with_channel, effect.with_reference);
  return (power_of(form) == 0 && form != Form::kLagged) || covers(effect.channel, effect.reference);
}

}  // namespace

std::vector<double> means_of_corrections(const std::vector<FoundEffect>& effects,
                                         const std::vector<ChannelRange>& ranges,
                                         const Eigen::VectorXd& of_chosen) {
  std::vector<double> means;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const Effect& effect = effects[i].effect;
    const auto at = static_cast<Eigen::Index>(i);
    const bool beyond = at < of_chosen.size() && !is_zero_within(effect, ranges);
    means.resize(means.size() + effect.parameters.size(), 0.0);
    if (beyond) means[means.size() - effect.parameters.size()] = of_chosen[at];
  }
  return means;
}

std::vector<ChannelRange> ranges_of(const BlockData& data, const std::vector<FoundEffect>& effects) {
  std::vector<ChannelRange> ranges;
  const bool ramp = std::ranges::any_of(
      effects, [](const FoundEffect& found) { return found.effect.form == name_of(Form::kRateRamp); });
  if (ramp)
    ranges.push_back(
        {std::string(kTimeRange), 0.0, static_cast<double>(data.grid.longest()) * data.grid.block_s});
  for (std::size_t c = 0; c < data.channels.size(); ++c) {
    const FineChannel& channel = data.channels[c];
    if (channel.period > 0.0) continue;  // an angle covers the whole turn
    const auto uses = [&](const FoundEffect& found) {
      if (found.effect.shown_only) return false;
      return found.effect.channel == channel.name || found.effect.with_channel == channel.name;
    };
    if (std::ranges::any_of(effects, uses)) ranges.push_back({channel.name, channel.low, channel.high});
  }
  return ranges;
}

}  // namespace ifog
