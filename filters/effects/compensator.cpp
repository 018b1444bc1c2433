// SPDX-License-Identifier: Apache-2.0
#include "filters/effects/compensator.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "filters/effects/reach.h"

namespace ifog {
namespace {

constexpr int kRounds = 12;  // three suffice for laws that are nearly linear
// Of the rates: step for the slope. Of the true rate: below, what is measured of it is too little to solve for.
constexpr double kSmall = 1e-4;

}  // namespace

void Compensator::hold_channels(const CompensatorInput& in, CompensatorOutput& out) noexcept {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    Held& held = held_[i];
    double value = i < in.channels.size() ? in.channels[i] : std::numeric_limits<double>::quiet_NaN();
    const double age = i < in.age_s.size() ? in.age_s[i] : 0.0;
    bool known = held.readings.step(value, in.dt_s, ranges_[i]);
    held.stale = !known || age > stale_after_s_;
    if (DelayedReading& delayed = delayed_[i]; delayed.delays() && (known || delayed.begun())) {
      value = known ? delayed.step(value, in.dt_s) : delayed.hold(in.dt_s);
      known = true;
    }
    if (known) {
      held.seen = true;
      held.value = value;
      held.reach = reach_of(value, ranges_[i]);
    }
    if (held.stale) out.flags |= kStaleChannel;
    if (!held.seen) out.flags |= kNoChannelYet;
    if (held.seen && held.reach.outside()) out.flags |= kOutOfRange;
  }
}

void Compensator::Value::doubt(double factor, const Shape& shape, const Reach& reach) noexcept {
  left_behind = std::abs(left_behind * factor) + std::abs(value) * shape.left_behind(reach);
  unseen_curvature = std::abs(unseen_curvature * factor) + std::abs(value) * shape.unseen_curvature(reach);
}

std::optional<Reach> Compensator::reach_of_factor(Factor& factor, double dt_s,
                                                  std::uint32_t& flags) const noexcept {
  const Held& held = held_[factor.channel];
  if (!held.seen || (factor.less != kNone && !held_[factor.less].seen)) return std::nullopt;
  if (factor.less == kNone && !(factor.turn > 0.0)) return held.reach;
  double value = 0.0;
  if (factor.less == kNone) {
    value = nearest_on_arc(held.value, factor.range, factor.turn);
  } else {
    const double difference = held.value - held_[factor.less].value;
    if (factor.turn > 0.0)
      factor.difference = nearest_on_arc(difference, factor.range, factor.turn);
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
    const std::optional<Reach> reach = reach_of_factor(factor, dt_s, flags);
    term.usable = reach.has_value();
    if (!term.usable) return;
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
  for (std::size_t i = of_axis_[axis].begin; i < of_axis_[axis].end; ++i) {
    const Term& term = terms_[i];
    if (!term.usable) continue;
    sum += term.coefficient * (term.of_rate ? at_rates(term, rates).value : term.channels.value);
  }
  return sum;
}

// Uses values_.
double Compensator::parameter_variance(std::size_t axis) const noexcept {
  if (covariance_.values.empty()) return 0.0;
  double variance = 0.0;
  const AxisTerms& of = of_axis_[axis];
  for (std::size_t i = of.begin; i < of.end; ++i) {
    const Term& a = terms_[i];
    if (!a.usable || a.parameter == kNone) continue;
    for (std::size_t j = of.begin; j < of.end; ++j) {
      const Term& b = terms_[j];
      if (!b.usable || b.parameter == kNone) continue;
      variance += values_[i] * covariance_.values[a.parameter * covariance_.size + b.parameter] * values_[j];
    }
  }
  return std::max(variance, 0.0);
}

void Compensator::judge(std::size_t axis, const Axes& rates, CompensatorOutput& out) noexcept {
  double inflation = 0.0;
  for (std::size_t i = of_axis_[axis].begin; i < of_axis_[axis].end; ++i) {
    const Term& term = terms_[i];
    if (term.of_rate) {
      for (const Factor& factor : term.factors) {
        if (factor.rate == kNone) continue;
        if (std::isfinite(rates[factor.rate]) && reach_of(rates[factor.rate], factor.range).outside())
          out.flags |= kOutOfRange;
        if (factor.rate != axis && !std::isfinite(rates[factor.rate])) out.flags |= kStaleChannel;
      }
    }
    if (!term.usable) continue;
    const Value value = term.of_rate ? at_rates(term, rates) : term.channels;
    values_[i] = value.value;
    if (value.surely()) continue;
    const double left = term.coefficient * value.left_behind;
    const double bent = term.coefficient_error * value.unseen_curvature;
    inflation += left * left + bent * bent;
  }
  // Uniform distribution within the zone.
  for (const Zone& zone : zones_)
    if (zone.axis == axis && std::abs(rates[axis] - zone.middle) < zone.half_width)
      inflation += zone.half_width * zone.half_width / 3.0;
  out.variance_rad2ps2[axis] = parameter_variance(axis) + inflation;
}

// One step of Newton's method from rate `at`, exact for a constant scale factor error of any size, also for one
// of -2 (reversed sign).
double Compensator::better_rate(std::size_t axis, double measured, double at, Axes rates) const noexcept {
  rates[axis] = at;
  const double here = correction(axis, rates);
  rates[axis] = at + kSmall * (std::abs(at) + std::abs(measured));
  double slope = (correction(axis, rates) - here) / (rates[axis] - at);
  if (!(std::abs(1.0 + slope) > kSmall)) slope = 0.0;
  return (measured - here + slope * at) / (1.0 + slope);
}

void Compensator::solve(const CompensatorInput& in, CompensatorOutput& out) noexcept {
  Axes rates = in.rate_radps;
  bool of_rate = false;
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    of_rate |= of_axis_[axis].of_rate;
    if (of_axis_[axis].of_rate) continue;
    out.correction_radps[axis] = correction(axis, rates);
    rates[axis] = in.rate_radps[axis] - out.correction_radps[axis];
  }
  // The iteration stops when the rates no longer change. It starts at zero, which is within the fitted range.
  for (int round = 0; of_rate && round < kRounds; ++round) {
    of_rate = false;
    for (std::size_t axis = 0; axis < axes_; ++axis) {
      if (!of_axis_[axis].of_rate) continue;
      const double rate = better_rate(axis, in.rate_radps[axis], round == 0 ? 0.0 : rates[axis], rates);
      out.correction_radps[axis] = in.rate_radps[axis] - rate;
      of_rate |= std::bit_cast<std::uint64_t>(rate) != std::bit_cast<std::uint64_t>(rates[axis]);
      rates[axis] = rate;
    }
  }
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    out.compensated_radps[axis] = rates[axis];
    judge(axis, rates, out);
  }
}

void Compensator::step(const CompensatorInput& in, CompensatorOutput& out) noexcept {
  out.flags = 0;
  hold_channels(in, out);
  for (Term& term : terms_) evaluate(term, in.dt_s, out.flags);
  solve(in, out);
  subtract_ramps(in, out);
}

// Last, since a ramp is detected in the residual of the other effects.
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
