#include "filters/effects/compensator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

// Scale factor errors are below a tenth, so each round gains a digit or more; twelve reach the last bit.
constexpr int kRounds = 12;

std::string label_of(const Effect& effect) {
  return effect.form + (effect.channel.empty() ? "" : " of " + effect.channel);
}

}  // namespace

Compensator::Compensator(const Model& model, const std::vector<std::string>& axes, double stale_after_s,
                         std::optional<double> since_power_up_s)
    : rate_range_{"", -kEverywhere, kEverywhere},
      axes_(axes.size()),
      stale_after_s_(stale_after_s),
      since_power_up_s_(since_power_up_s) {
  if (axes.empty() || axes.size() > kMaxAxes) {
    throw std::invalid_argument("a compensator has 1 to 3 axes, not " + std::to_string(axes.size()));
  }
  for (const Effect& effect : model.effects) {
    add_effect(effect, parameters_, axes);
    parameters_ += effect.parameters.size();
  }
  if (model.covariance.size() == parameters_ * parameters_) covariance_ = model.covariance;
  held_.resize(channels_.size());
  read_ranges(model.ranges);
}

void Compensator::read_ranges(const std::vector<ChannelRange>& known) {
  for (const ChannelRange& range : known) {
    if (is_reference_rate(range.channel)) rate_range_ = range;
  }
  for (const std::string& name : channels_) {
    ChannelRange range{name, -kEverywhere, kEverywhere};
    for (const ChannelRange& each : known) {
      if (each.channel == name) range = each;
    }
    ranges_.push_back(range);
  }
}

void Compensator::add_effect(const Effect& effect, std::size_t first_row,
                             const std::vector<std::string>& axes) {
  const auto form = form_named(effect.form);
  if (!form) throw std::invalid_argument("effect form " + in_quotes(effect.form) + " is unknown");
  if (describes_noise(*form) || !carries_over(*form)) {
    left_out_.push_back(label_of(effect));
    return;
  }
  if (*form == Form::kWarmUp && !since_power_up_s_) {
    left_out_.push_back(label_of(effect) + " (the time since power-up is not known)");
    return;
  }
  if (has_channel(*form) && effect.channel.empty()) {
    throw std::invalid_argument("effect " + in_quotes(effect.form) + " names no channel");
  }
  Term term;
  term.coefficient = *form == Form::kLookup ? 1.0 : parameter(effect, "coefficient");
  term.parameter = kNone;
  term.coefficient_error = 0.0;
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    if (effect.parameters[i].name != "coefficient" || *form == Form::kLookup) continue;
    term.parameter = first_row + i;
    term.coefficient_error = effect.parameters[i].std_error;
  }
  try {
    add_factor(term, shape_settings(effect), effect.channel);
    if (*form == Form::kProduct) add_factor(term, with_shape_settings(effect), effect.with_channel);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("effect " + label_of(effect) + ": " + error.what());
  }
  place(std::move(term), effect, axes);
}

void Compensator::add_factor(Term& term, ShapeSettings settings, const std::string& channel) {
  const bool rate = is_reference_rate(channel);
  if (rate && (has_memory(settings.form) || settings.angle)) {
    throw std::invalid_argument("a form with memory cannot be a function of the rate");
  }
  const bool timed = settings.form == Form::kWarmUp;
  settings.elapsed_s = since_power_up_s_.value_or(0.0);
  term.factors.push_back({Shape(std::move(settings)), rate || timed ? kNone : channel_index(channel), rate});
}

void Compensator::place(Term term, const Effect& effect, const std::vector<std::string>& axes) {
  bool placed = false;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (!effect.axis.empty() && effect.axis != axes[axis]) continue;
    term.axis = axis;
    terms_.push_back(term);
    placed = true;
  }
  if (!placed) {
    throw std::invalid_argument("effect " + label_of(effect) + ": the sensor has no axis " +
                                in_quotes(effect.axis));
  }
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
    held.stale = !std::isfinite(value) || age > stale_after_s_;
    if (std::isfinite(value)) {
      held.seen = true;
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

void Compensator::evaluate(Term& term, double dt_s) noexcept {
  term.channels = {};
  term.usable = true;
  for (Factor& factor : term.factors) {
    if (factor.of_rate) continue;
    if (factor.channel == kNone) {
      term.channels.value *= factor.shape.step(0.0, dt_s);
      continue;
    }
    const Held& held = held_[factor.channel];
    if (!held.seen) {
      term.usable = false;
      return;
    }
    term.channels.times(factor.shape.step(held.reach, dt_s), factor.shape, held.reach);
  }
}

Compensator::Value Compensator::at_rate(const Term& term, double rate) const noexcept {
  Value value = term.channels;
  for (const Factor& factor : term.factors) {
    if (!factor.of_rate) continue;
    const Reach reach = reach_of(rate, rate_range_);
    value.times(factor.shape.at(reach), factor.shape, reach);
  }
  return value;
}

double Compensator::parameter_variance(std::size_t axis, double rate) const noexcept {
  if (covariance_.empty()) return 0.0;
  double variance = 0.0;
  for (const Term& a : terms_) {
    if (a.axis != axis || !a.usable || a.parameter == kNone) continue;
    const double ga = at_rate(a, rate).value;
    for (const Term& b : terms_) {
      if (b.axis != axis || !b.usable || b.parameter == kNone) continue;
      variance += ga * covariance_[a.parameter * parameters_ + b.parameter] * at_rate(b, rate).value;
    }
  }
  return std::max(variance, 0.0);
}

void Compensator::step(const CompensatorInput& in, CompensatorOutput& out) noexcept {
  out.flags = 0;
  hold_channels(in, out);
  for (Term& term : terms_) evaluate(term, in.dt_s);

  for (std::size_t axis = 0; axis < axes_; ++axis) {
    const double measured = in.rate_radps[axis];
    double rate = measured;
    double correction = 0.0;
    bool of_the_rate = false;
    for (const Term& term : terms_) {
      for (const Factor& factor : term.factors) of_the_rate |= term.axis == axis && factor.of_rate;
    }
    for (int round = 0; round < (of_the_rate ? kRounds : 1); ++round) {
      correction = 0.0;
      for (const Term& term : terms_) {
        if (term.axis == axis && term.usable) correction += term.coefficient * at_rate(term, rate).value;
      }
      rate = measured - correction;
    }
    if (of_the_rate && reach_of(rate, rate_range_).outside()) out.flags |= kOutOfRange;
    double inflation = 0.0;
    for (const Term& term : terms_) {
      if (term.axis != axis || !term.usable) continue;
      const Value value = at_rate(term, rate);
      const double left = term.coefficient * value.left_behind;
      const double bent = term.coefficient_error * value.unseen_curvature;
      inflation += left * left + bent * bent;
    }
    out.correction_radps[axis] = correction;
    out.compensated_radps[axis] = rate;
    out.variance_rad2ps2[axis] = parameter_variance(axis, rate) + inflation;
  }
}

void Compensator::restart() noexcept {
  for (Held& held : held_) held = {};
  for (Term& term : terms_) {
    for (Factor& factor : term.factors) factor.shape.restart();
  }
}

void Compensator::take_over(const Compensator& previous) noexcept {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    for (std::size_t j = 0; j < previous.channels_.size(); ++j) {
      if (channels_[i] != previous.channels_[j] || !previous.held_[j].seen) continue;
      held_[i].seen = true;
      held_[i].reach = reach_of(previous.held_[j].reach.value + previous.held_[j].reach.beyond, ranges_[i]);
    }
  }
  for (Term& term : terms_) {
    for (Factor& factor : term.factors) {
      for (const Term& old : previous.terms_) {
        for (const Factor& other : old.factors) {
          const bool same_channel =
              factor.channel == other.channel
                  ? factor.channel == kNone || channels_[factor.channel] == previous.channels_[other.channel]
                  : factor.channel != kNone && other.channel != kNone &&
                        channels_[factor.channel] == previous.channels_[other.channel];
          if (same_channel) factor.shape.take_over(other.shape);
        }
      }
    }
  }
}

}  // namespace ifog
