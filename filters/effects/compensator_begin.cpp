// SPDX-License-Identifier: Apache-2.0
// Construction, start and restart of a compensator, and takeover of the state of the one before.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "filters/effects/compensator.h"
#include "filters/effects/meaning.h"
#include "filters/effects/reach.h"
#include "filters/model_file/channel_names.h"

namespace ifog {
namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();
constexpr std::size_t kOwn = kMaxAxes;  // placeholder for the rate of the term's own axis

ChannelRange range_of(const std::string& channel, const std::vector<ChannelRange>& known) {
  ChannelRange found{channel, -kEverywhere, kEverywhere};
  for (const ChannelRange& range : known)
    if (range.channel == channel) found = range;
  return found;
}

// Range of a channel that is not a rate.
ChannelRange range_of_channel(const std::string& channel, const std::vector<ChannelRange>& known) {
  ChannelRange found = range_of(channel, known);
  found.fades = motion_of(channel) != Motion::kNone;
  return found;
}

// For any axis.
ChannelRange range_of_reference(const std::vector<ChannelRange>& known) {
  ChannelRange found{"", -kEverywhere, kEverywhere};
  for (const ChannelRange& range : known)
    if (is_reference_rate(range.channel)) found = range;
  return found;
}

// For error messages; with the line in the model file.
std::string place_of(const Effect& effect) {
  return "effect " + name_of(effect) + (effect.line > 0 ? " in line " + std::to_string(effect.line) : "");
}

// Calls use(axis) for each axis that the effect is of.
template <class Use>
void each_axis_of(const Effect& effect, const std::vector<std::string>& axes, const Use& use) {
  bool any = effect.axis.empty();
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (!effect.axis.empty() && effect.axis != axes[axis]) continue;
    use(axis);
    any = true;
  }
  if (!any)
    throw std::invalid_argument(place_of(effect) + ": the sensor has no axis " + in_quotes(effect.axis));
}

}  // namespace

Compensator::Compensator(const Model& model, const std::vector<std::string>& axes, double stale_after_s,
                         std::optional<double> since_power_up_s)
    : axes_(axes.size()), stale_after_s_(stale_after_s), since_power_up_s_(since_power_up_s) {
  if (axes.empty() || axes.size() > kMaxAxes)
    throw std::invalid_argument("a compensator has 1 to 3 axes, not " + std::to_string(axes.size()));
  for (const Effect& effect : model.effects) {
    add_effect(effect, covariance_.size, axes, model.ranges);
    covariance_.size += effect.parameters.size();
  }
  if (model.covariance.size() == covariance_.size * covariance_.size) covariance_.values = model.covariance;
  held_.resize(channels_.size());
  for (const std::string& name : channels_) ranges_.push_back(range_of_channel(name, model.ranges));
  // The arc is a property of each effect's angle; a channel that is only used as an angle has no range.
  for (const bool turns : {true, false})
    for (const Term& term : terms_)
      for (const Factor& factor : term.factors)
        if (factor.channel < channels_.size() && (factor.turn > 0.0) == turns)
          ranges_[factor.channel] =
              turns ? range_of("", {}) : range_of_channel(channels_[factor.channel], model.ranges);
  for (const std::string& name : channels_) delayed_.emplace_back(range_of(name, model.ranges).early_s);
  arrange_terms();
}

void Compensator::arrange_terms() {
  std::ranges::stable_sort(terms_, [](const Term& one, const Term& other) { return one.axis < other.axis; });
  values_.resize(terms_.size());
  for (std::size_t axis = 0, next = 0; axis < axes_; ++axis) {
    AxisTerms& of = of_axis_[axis];
    of.begin = next;
    while (next < terms_.size() && terms_[next].axis == axis) of.of_rate |= terms_[next++].of_rate;
    of.end = next;
  }
}

void Compensator::add_effect(const Effect& effect, std::size_t first_row,
                             const std::vector<std::string>& axes, const std::vector<ChannelRange>& ranges) {
  const auto form = form_named(effect.form);
  if (!form) throw std::invalid_argument("effect form " + in_quotes(effect.form) + " is unknown");
  if (!carries_over(*form) || effect.shown_only) {
    left_out_.push_back(name_of(effect));
    if (*form == Form::kDeadZone) add_zone(effect, axes);
    return;
  }
  if (*form == Form::kWarmUp && !since_power_up_s_) {
    left_out_.push_back(name_of(effect) + " (the time since power-up is not known)");
    return;
  }
  const std::string channel = *form == Form::kRateRamp ? std::string(kTimeRange) : effect.channel;
  if (*form == Form::kRateRamp && !std::isfinite(range_of(channel, ranges).high)) {
    left_out_.push_back(name_of(effect) + " (for how long it was fitted is not known)");
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
    // nan means unknown: then nothing is added to the variance, and the correction is still applied.
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
  each_axis_of(effect, axes, [&](std::size_t axis) {
    Term& mine = terms_.emplace_back(term);
    mine.axis = axis;
    for (Factor& factor : mine.factors)
      if (factor.rate == kOwn) factor.rate = axis;
  });
}

void Compensator::add_ramp(const Effect& effect, const std::vector<std::string>& axes) {
  std::optional<RampTracker> tracker;
  try {
    tracker.emplace(ramp_settings(effect));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(place_of(effect) + ": " + error.what());
  }
  each_axis_of(effect, axes, [&](std::size_t axis) { ramps_.push_back({axis, *tracker}); });
}

void Compensator::add_zone(const Effect& effect, const std::vector<std::string>& axes) {
  const double half_width = parameter(effect, kHalfWidth);
  if (!is_reference_rate(effect.channel) || !(half_width >= 0.0 && std::isfinite(half_width)))
    throw std::invalid_argument(place_of(effect) +
                                ": expected reference_rate and a half_width of at least 0");
  each_axis_of(effect, axes, [&](std::size_t axis) {
    zones_.push_back({axis, effect.reference, half_width});
  });
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
  Factor factor{.shape = Shape(std::move(settings)), .range = range_of(channel, ranges)};
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
    if (is_of_angle(factor.shape.settings().form) && !factor.shape.settings().fringe)
      factor.turn = turn_of(channel, factor.shape.settings().period);
  }
  term.of_rate |= rate;
  term.factors.push_back(std::move(factor));
}

std::size_t Compensator::channel_index(const std::string& name) {
  const auto found = std::find(channels_.begin(), channels_.end(), name);
  if (found != channels_.end()) return static_cast<std::size_t>(found - channels_.begin());
  channels_.push_back(name);
  return channels_.size() - 1;
}

void Compensator::begin(double since_power_up_s) noexcept {
  for (Term& term : terms_)
    for (Factor& factor : term.factors) factor.shape.begin(since_power_up_s);
}

void Compensator::take_over(const Compensator& previous) noexcept {
  for (Ramp& ramp : ramps_) {
    for (const Ramp& other : previous.ramps_)
      if (ramp.axis == other.axis && ramp.tracker.take_over(other.tracker)) break;
  }
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    for (std::size_t j = 0; j < previous.channels_.size(); ++j) {
      if (channels_[i] != previous.channels_[j] || !previous.held_[j].seen) continue;
      held_[i].seen = true;
      held_[i].value = previous.held_[j].value;
      held_[i].readings = previous.held_[j].readings;
      delayed_[i].take_over(previous.delayed_[j]);
      held_[i].reach = reach_of(held_[i].value, ranges_[i]);
    }
  }
  const auto same = [&](std::size_t mine, std::size_t other) {
    if (mine == kNone || other == kNone) return mine == other;
    return channels_[mine] == previous.channels_[other];
  };
  for (Term& term : terms_) {
    for (Factor& factor : term.factors) {
      for (const Term& old : previous.terms_) {
        for (const Factor& other : old.factors) {
          if (!same(factor.channel, other.channel) || !same(factor.less, other.less)) continue;
          factor.shape.take_over(other.shape);
          if (factor.less == kNone) continue;
          factor.readings = other.readings;
          factor.difference = other.difference;
        }
      }
    }
  }
}

}  // namespace ifog
