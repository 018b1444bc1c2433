// SPDX-License-Identifier: Apache-2.0
#include "filters/effects/compensator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "drivers/ifog/quoted.h"
#include "filters/effects/arc.h"

namespace ifog {
namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();
// Scale factor errors are below a tenth, so each round gains a digit or more; twelve reach the last bit.
constexpr int kRounds = 12;
constexpr std::size_t kOwn = kMaxAxes;  // the rate of the axis that a term will be placed on

ChannelRange range_of(const std::string& channel, const std::vector<ChannelRange>& known) {
  ChannelRange found{channel, -kEverywhere, kEverywhere};
  for (const ChannelRange& range : known)
    if (range.channel == channel) found = range;
  return found;
}

// Whatever axis it is of.
ChannelRange range_of_reference(const std::vector<ChannelRange>& known) {
  ChannelRange found{"", -kEverywhere, kEverywhere};
  for (const ChannelRange& range : known)
    if (is_reference_rate(range.channel)) found = range;
  return found;
}

std::string label_of(const Effect& effect) {
  return effect.form + (effect.channel.empty() ? "" : " of " + effect.channel);
}

// For a complaint; of a model file with its line.
std::string place_of(const Effect& effect) {
  return "effect " + label_of(effect) + (effect.line > 0 ? " in line " + std::to_string(effect.line) : "");
}

[[noreturn]] void refuse_axis(const Effect& effect) {
  throw std::invalid_argument(place_of(effect) + ": the sensor has no axis " + in_quotes(effect.axis));
}

}  // namespace

Compensator::Compensator(const Model& model, const std::vector<std::string>& axes, double stale_after_s,
                         std::optional<double> since_power_up_s)
    : axes_(axes.size()),
      of_rate_(axes.size(), 0),
      stale_after_s_(stale_after_s),
      since_power_up_s_(since_power_up_s) {
  if (axes.empty() || axes.size() > kMaxAxes)
    throw std::invalid_argument("a compensator has 1 to 3 axes, not " + std::to_string(axes.size()));
  for (const Effect& effect : model.effects) {
    add_effect(effect, parameters_, axes, model.ranges);
    parameters_ += effect.parameters.size();
  }
  if (model.covariance.size() == parameters_ * parameters_) covariance_ = model.covariance;
  held_.resize(channels_.size());
  for (const std::string& name : channels_) ranges_.push_back(range_of(name, model.ranges));
  // Where an angle is in its arc, each effect of it says; what is nothing but an angle has no range.
  for (const bool turns : {true, false})
    for (const Term& term : terms_)
      for (const Factor& factor : term.factors)
        if (factor.channel < channels_.size() && (factor.turn > 0.0) == turns)
          ranges_[factor.channel] =
              turns ? range_of("", {}) : range_of(channels_[factor.channel], model.ranges);
  for (const Term& term : terms_) of_rate_[term.axis] |= term.of_rate ? 1 : 0;
}

void Compensator::add_effect(const Effect& effect, std::size_t first_row,
                             const std::vector<std::string>& axes, const std::vector<ChannelRange>& ranges) {
  const auto form = form_named(effect.form);
  if (!form) throw std::invalid_argument("effect form " + in_quotes(effect.form) + " is unknown");
  if (describes_noise(*form) || !carries_over(*form) || effect.shown_only) {
    left_out_.push_back(label_of(effect));
    if (*form == Form::kDeadZone) add_zone(effect, axes);
    return;
  }
  if (*form == Form::kWarmUp && !since_power_up_s_) {
    left_out_.push_back(label_of(effect) + " (the time since power-up is not known)");
    return;
  }
  const std::string channel = *form == Form::kRateRamp ? std::string(kTimeRange) : effect.channel;
  if (*form == Form::kRateRamp && !std::isfinite(range_of(channel, ranges).high)) {
    left_out_.push_back(label_of(effect) + " (for how long it was fitted is not known)");
    return;
  }
  if (*form == Form::kRebuiltRamp) return add_ramp(effect, axes);
  if (has_channel(*form) && effect.channel.empty())
    throw std::invalid_argument(place_of(effect) + " names no channel");
  Term term;
  term.coefficient = *form == Form::kLookup ? 1.0 : parameter(effect, "coefficient");
  term.parameter = kNone;
  term.coefficient_error = 0.0;
  term.of_rate = false;
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    if (effect.parameters[i].name != "coefficient" || *form == Form::kLookup) continue;
    term.parameter = first_row + i;
    // nan stands for not known: nothing is added for it, rather than nothing corrected.
    if (std::isfinite(effect.parameters[i].std_error))
      term.coefficient_error = effect.parameters[i].std_error;
  }
  try {
    add_factor(term, shape_settings(effect), channel, axes, ranges);
    if (*form == Form::kProduct)
      add_factor(term, with_shape_settings(effect), effect.with_channel, axes, ranges);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(place_of(effect) + ": " + error.what());
  }
  place(term, effect, axes);
}

void Compensator::add_ramp(const Effect& effect, const std::vector<std::string>& axes) {
  bool placed = false;
  try {
    const RampTracker tracker(ramp_settings(effect));
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      if (!effect.axis.empty() && effect.axis != axes[axis]) continue;
      ramps_.push_back({axis, tracker});
      placed = true;
    }
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(place_of(effect) + ": " + error.what());
  }
  if (!placed) refuse_axis(effect);
}

void Compensator::add_zone(const Effect& effect, const std::vector<std::string>& axes) {
  const double half_width = parameter(effect, kHalfWidth);
  if (!is_reference_rate(effect.channel) || !(half_width >= 0.0 && std::isfinite(half_width)))
    throw std::invalid_argument(place_of(effect) +
                                ": expected reference_rate and a half_width of at least 0");
  bool placed = false;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (!effect.axis.empty() && effect.axis != axes[axis]) continue;
    zones_.push_back({axis, effect.reference, half_width});
    placed = true;
  }
  if (!placed) refuse_axis(effect);
}

void Compensator::add_factor(Term& term, ShapeSettings settings, const std::string& channel,
                             const std::vector<std::string>& axes, const std::vector<ChannelRange>& ranges) {
  const std::string of_axis = axis_of_rate(channel);
  const auto other = std::find(axes.begin(), axes.end(), of_axis);
  const bool of_other = !of_axis.empty() && other != axes.end();
  const bool rate = of_other || is_reference_rate(channel);
  if (rate && (has_memory(settings.form) || settings.angle)) {
    throw std::invalid_argument("a form with memory cannot be a function of the rate");
  }
  settings.elapsed_s = since_power_up_s_.value_or(0.0);
  Factor factor{Shape(std::move(settings)), kNone, kNone, kNone, range_of(channel, ranges)};
  const ChannelNames names = names_in(channel);
  if (!names.less.empty() && (rate || !axis_of_rate(names.of).empty() || !axis_of_rate(names.less).empty() ||
                              is_reference_rate(names.of) || is_reference_rate(names.less)))
    throw std::invalid_argument("a difference is of two environment channels, not of rates");
  if (of_other) factor.rate = static_cast<std::size_t>(other - axes.begin());
  if (rate && !of_other) {
    factor.rate = kOwn;
    factor.range = range_of_reference(ranges);
  }
  if (!rate && !is_of_time(factor.shape.settings().form)) {
    factor.channel = channel_index(names.of);
    if (!names.less.empty()) factor.less = channel_index(names.less);
    if (is_of_angle(factor.shape.settings().form))
      factor.turn = turn_of(channel, factor.shape.settings().period);
  }
  term.of_rate |= rate;
  term.factors.push_back(std::move(factor));
}

void Compensator::place(const Term& term, const Effect& effect, const std::vector<std::string>& axes) {
  bool placed = false;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (!effect.axis.empty() && effect.axis != axes[axis]) continue;
    Term mine = term;
    mine.axis = axis;
    for (Factor& factor : mine.factors)
      if (factor.rate == kOwn) factor.rate = axis;
    terms_.push_back(std::move(mine));
    placed = true;
  }
  if (!placed) refuse_axis(effect);
}

std::size_t Compensator::channel_index(const std::string& name) {
  const auto found = std::find(channels_.begin(), channels_.end(), name);
  if (found != channels_.end()) return static_cast<std::size_t>(found - channels_.begin());
  channels_.push_back(name);
  return channels_.size() - 1;
}

void Compensator::hold_channels(const CompensatorInput& in, CompensatorOutput& out) noexcept {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    Held& held = held_[i];
    const double value = i < in.channels.size() ? in.channels[i] : std::numeric_limits<double>::quiet_NaN();
    const double age = i < in.age_s.size() ? in.age_s[i] : 0.0;
    const bool told = held.readings.step(value, in.dt_s, ranges_[i]);
    held.stale = !told || age > stale_after_s_;
    if (told) {
      held.seen = true;
      held.value = value;
      held.reach = reach_of(value, ranges_[i]);
    }
    if (held.stale) out.flags |= kStaleChannel;
    if (!held.seen) out.flags |= kNoChannelYet;
    if (held.seen && held.reach.outside()) out.flags |= kOutOfRange;
  }
}

void Compensator::Value::times(double factor, const Shape& shape, const Reach& reach) noexcept {
  if (reach.outside() || left_behind != 0.0 || unseen_curvature != 0.0) {
    left_behind = std::abs(left_behind * factor) + std::abs(value) * shape.left_behind(reach);
    unseen_curvature = std::abs(unseen_curvature * factor) + std::abs(value) * shape.unseen_curvature(reach);
  }
  value *= factor;
}

std::optional<Reach> Compensator::reach_of_factor(Factor& factor, double dt_s,
                                                  std::uint32_t& flags) const noexcept {
  const Held& held = held_[factor.channel];
  if (factor.less == kNone && !(factor.turn > 0.0)) return held.reach;
  double value = 0.0;
  if (factor.less == kNone) {
    value = beside_arc(held.value, factor.range, factor.turn);
  } else {
    const double difference = held.value - held_[factor.less].value;
    if (factor.turn > 0.0)
      factor.difference = beside_arc(difference, factor.range, factor.turn);
    else if (factor.readings.step(difference, dt_s, factor.range))
      factor.difference = difference;
    else
      flags |= factor.difference ? kStaleChannel : kNoChannelYet;
    if (!factor.difference) return std::nullopt;
    value = *factor.difference;
  }
  const Reach reach = reach_of(value, factor.range);
  if (reach.outside()) flags |= kOutOfRange;
  return reach;
}

void Compensator::evaluate(Term& term, double dt_s, std::uint32_t& flags) noexcept {
  term.channels = {};
  term.usable = true;
  for (Factor& factor : term.factors) {
    if (factor.rate != kNone) continue;
    if (factor.channel == kNone) {
      const double value = factor.shape.step(0.0, dt_s);
      const bool ramp = factor.shape.settings().form == Form::kRateRamp;
      const Reach reach = ramp ? reach_of(value, factor.range) : Reach{};
      if (reach.outside()) flags |= kOutOfRange;
      term.channels.times(ramp ? reach.value : value, factor.shape, reach);
      continue;
    }
    if (!held_[factor.channel].seen || (factor.less != kNone && !held_[factor.less].seen)) {
      term.usable = false;
      return;
    }
    const std::optional<Reach> reach = reach_of_factor(factor, dt_s, flags);
    if (!reach) {
      term.usable = false;
      return;
    }
    term.channels.times(factor.shape.step(*reach, dt_s), factor.shape, *reach);
  }
}

Compensator::Value Compensator::at_rates(const Term& term, const Axes& rates) const noexcept {
  Value value = term.channels;
  for (const Factor& factor : term.factors) {
    if (factor.rate == kNone) continue;
    const double rate = rates[factor.rate];
    if (factor.rate != term.axis && !std::isfinite(rate)) return {0.0, 0.0, 0.0};
    const Reach reach = reach_of(rate, factor.range);
    value.times(factor.shape.at(reach), factor.shape, reach);
  }
  return value;
}

double Compensator::correction(std::size_t axis, const Axes& rates) const noexcept {
  double sum = 0.0;
  for (const Term& term : terms_) {
    if (term.axis == axis && term.usable) sum += term.coefficient * at_rates(term, rates).value;
  }
  return sum;
}

double Compensator::parameter_variance(std::size_t axis, const Axes& rates) const noexcept {
  if (covariance_.empty()) return 0.0;
  double variance = 0.0;
  for (const Term& a : terms_) {
    if (a.axis != axis || !a.usable || a.parameter == kNone) continue;
    const double ga = at_rates(a, rates).value;
    for (const Term& b : terms_) {
      if (b.axis != axis || !b.usable || b.parameter == kNone) continue;
      variance += ga * covariance_[a.parameter * parameters_ + b.parameter] * at_rates(b, rates).value;
    }
  }
  return std::max(variance, 0.0);
}

void Compensator::judge(std::size_t axis, const Axes& rates, CompensatorOutput& out) const noexcept {
  double inflation = 0.0;
  for (const Term& term : terms_) {
    if (term.axis != axis) continue;
    for (const Factor& factor : term.factors) {
      if (factor.rate == kNone) continue;
      if (std::isfinite(rates[factor.rate]) && reach_of(rates[factor.rate], factor.range).outside())
        out.flags |= kOutOfRange;
      if (factor.rate != axis && !std::isfinite(rates[factor.rate])) out.flags |= kStaleChannel;
    }
    if (!term.usable) continue;
    const Value value = at_rates(term, rates);
    const double left = term.coefficient * value.left_behind;
    const double bent = term.coefficient_error * value.unseen_curvature;
    inflation += left * left + bent * bent;
  }
  // Any rate within is as likely: an even spread.
  for (const Zone& zone : zones_)
    if (zone.axis == axis && std::abs(rates[axis] - zone.middle) < zone.half_width)
      inflation += zone.half_width * zone.half_width / 3.0;
  out.variance_rad2ps2[axis] = parameter_variance(axis, rates) + inflation;
}

void Compensator::step(const CompensatorInput& in, CompensatorOutput& out) noexcept {
  out.flags = 0;
  hold_channels(in, out);
  for (Term& term : terms_) evaluate(term, in.dt_s, out.flags);

  Axes rates = in.rate_radps;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t axis = 0; axis < axes_; ++axis) {
      if (round > 0 && !of_rate_[axis]) continue;
      out.correction_radps[axis] = correction(axis, rates);
      rates[axis] = in.rate_radps[axis] - out.correction_radps[axis];
    }
  }
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    out.compensated_radps[axis] = rates[axis];
    judge(axis, rates, out);
  }
  subtract_ramps(in, out);
}

// Last, for a ramp is found in what the other effects leave.
void Compensator::subtract_ramps(const CompensatorInput& in, CompensatorOutput& out) noexcept {
  for (Ramp& ramp : ramps_) {
    const std::size_t axis = ramp.axis;
    const double error = ramp.tracker.step({.measured_radps = in.rate_radps[axis],
                                            .rest_radps = out.compensated_radps[axis],
                                            .dt_s = in.dt_s,
                                            .missed_s = in.missed_s[axis]});
    if (!ramp.tracker.locked()) out.flags |= kRampUnknown;
    out.correction_radps[axis] += error;
    out.compensated_radps[axis] -= error;
  }
}

}  // namespace ifog
