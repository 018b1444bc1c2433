// SPDX-License-Identifier: Apache-2.0
// Conversion of a candidate to regression columns and to an effect and back; price of a form.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "filters/diagnosis/regression/candidates.h"
#include "filters/effects/meaning.h"
#include "filters/effects/shape.h"

namespace ifog {
namespace {

ShapeSettings settings_of(const BlockData& data, Form form, std::size_t channel, double first, double second,
                          double period = 0.0) {
  ShapeSettings settings;
  settings.form = form;
  settings.period = period;
  settings.reference = channel == Candidate::kNone ? 0.0 : reference_of(data.channels[channel].name);
  settings.time_constant_s = first;
  settings.second_time_constant_s = second;
  settings.begins_at_mean = true;
  return settings;
}

}  // namespace

double complexity(const Candidate& candidate) {
  switch (candidate.form) {
    case Form::kLinear:
      return 0.0;
    case Form::kQuadratic:
    case Form::kAbsolute:
    case Form::kCosine:
    case Form::kSine:
    case Form::kRateRamp:
      return 2.0;
    case Form::kQuintic:
      return 5.0;
    case Form::kSeptic:
      return 6.0;
    case Form::kLagged:  // a channel without lag has a form of its own, and a short lag fits noise
    case Form::kWarmUp:
    case Form::kTransition:  // centre and width are free
      return 8.0;
    case Form::kProduct:  // scale factor, or its nonlinearity, that depends on a channel
      return candidate.with_form == Form::kLinear ? 4.0 : 8.0;
    default:
      return 4.0;
  }
}

double long_past_s(const BlockGrid& grid, const Candidate& candidate) {
  if (candidate.form != Form::kWarmUp) return 0.0;
  const auto on_for = [&](const BlockRange& record) { return grid.time_s[record.first] - record.power_up_s; };
  const double least_s = on_for(std::ranges::min(grid.records, {}, on_for));
  return least_s > 3.0 * candidate.time_constant_s ? least_s : 0.0;  // of which 5 % are left
}

Eigen::VectorXd regressor(const BlockData& data, const Candidate& candidate) {
  const BlockGrid& grid = data.grid;
  if (candidate.channel != Candidate::kNone) {
    if (candidate.form == Form::kProduct) {
      return column(
          data, settings_of(data, Form::kLinear, candidate.channel, 0.0, 0.0), candidate.channel,
          settings_of(data, candidate.with_form, candidate.with_channel, candidate.time_constant_s, 0.0),
          candidate.with_channel);
    }
    ShapeSettings settings = settings_of(data, candidate.form, candidate.channel, candidate.time_constant_s,
                                         candidate.second_time_constant_s, candidate.period);
    settings.half_width = candidate.half_width;
    if (candidate.is_transition()) settings.reference = candidate.centre;
    return column(data, settings, candidate.channel);
  }
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(grid.size()));
  const double later_s = long_past_s(grid, candidate);
  for (std::size_t r = 0; r < grid.records.size(); ++r) {
    const double start = grid.time_s[grid.records[r].first];
    for (std::size_t b = grid.records[r].first; b < grid.records[r].end; ++b) {
      const auto row = static_cast<Eigen::Index>(b);
      switch (candidate.form) {
        case Form::kRateRamp:
          values[row] = grid.time_s[b] - start;
          break;
        case Form::kWarmUp:
          values[row] =
              std::exp((later_s + grid.records[r].power_up_s - grid.time_s[b]) / candidate.time_constant_s);
          break;
        case Form::kStep:
          values[row] = r == candidate.record && grid.time_s[b] > candidate.time_s ? 1.0 : 0.0;
          break;
        default:
          throw std::logic_error("no column is made of " + std::string(name_of(candidate.form)));
      }
    }
  }
  return values;
}

Effect effect_of(const BlockData& data, const Candidate& candidate) {
  Effect effect;
  effect.form = name_of(candidate.form);
  if (candidate.channel != Candidate::kNone) {
    effect.channel = data.channels[candidate.channel].name;
    effect.reference = reference_of(effect.channel);
    effect.period = candidate.period;
    if (candidate.is_transition()) effect.reference = candidate.centre;
  }
  if (candidate.form == Form::kProduct) {
    effect.with_form = name_of(candidate.with_form);
    effect.with_channel = data.channels[candidate.with_channel].name;
    effect.with_reference = reference_of(effect.with_channel);
  }
  effect.parameters = {{"coefficient", 0.0, 0.0, coefficient_unit(effect)}};
  if (candidate.is_transition()) {
    effect.parameters.push_back(
        {std::string(kHalfWidth), candidate.half_width, 0.0, std::string(unit_of(effect.channel))});
  } else if (candidate.searched()) {
    effect.parameters.push_back(
        {std::string(time_constant_name(effect)), candidate.time_constant_s, 0.0, "s"});
  }
  const bool power = second_time_constant_name(effect) == "average_s";
  if (candidate.second_time_constant_s > 0.0 || power) {
    const double second =
        candidate.second_time_constant_s > 0.0 ? candidate.second_time_constant_s : kPowerAverage_s;
    effect.parameters.push_back({std::string(second_time_constant_name(effect)), second, 0.0, "s"});
  }
  if (candidate.form == Form::kStep) {
    const double time_s = data.grid.origin_of(candidate.record).in_s(candidate.time_s);
    effect.parameters.push_back({"time_s", time_s, 0.0, "s"});
  }
  if (candidate.is_earth_rate() && candidate.form == Form::kLinear) effect.form = name_of(Form::kEarthRate);
  effect.shown_only = candidate.shown();
  effect.meaning = candidate.is_earth_rate() ? meaning_of_earth_rate(effect) : meaning_of(effect);
  if (candidate.first_reading == FirstReading::kSettlingShown)
    effect.meaning =
        "the bias settles exponentially after the start of the record; the sensor had long been on, so a "
        "record from power-up on is needed to correct it";
  if (candidate.first_reading == FirstReading::kProxyShown)
    effect.meaning = "a proxy: larger than any gyro's " + std::string(name_of(candidate.form)) +
                     " effect of " + effect.channel + ", which moves or drifts with the cause";
  return effect;
}

std::optional<Candidate> candidate_of(const BlockData& data, const Effect& effect) {
  const std::optional<Form> form = form_named(effect.form);
  if (!form || *form == Form::kLookup || *form == Form::kRebuiltRamp || *form == Form::kBias ||
      *form == Form::kLine || describes_noise(*form))
    return std::nullopt;
  Candidate candidate;
  candidate.form = *form == Form::kEarthRate ? Form::kLinear : *form;
  if (has_channel(*form)) {
    candidate.channel = data.index_of(effect.channel).value_or(Candidate::kNone);
    if (candidate.channel == Candidate::kNone) return std::nullopt;
  }
  if (*form == Form::kProduct) {
    candidate.with_form = form_named(effect.with_form).value_or(Form::kLinear);
    candidate.with_channel = data.index_of(effect.with_channel).value_or(Candidate::kNone);
    if (candidate.with_channel == Candidate::kNone) return std::nullopt;
  }
  candidate.time_constant_s = parameter(effect, time_constant_name(effect));
  candidate.second_time_constant_s = parameter(effect, second_time_constant_name(effect));
  candidate.period = effect.period;
  candidate.half_width = parameter(effect, kHalfWidth);
  if (candidate.is_transition()) candidate.centre = effect.reference;
  return candidate;
}

}  // namespace ifog
