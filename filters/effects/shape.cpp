// SPDX-License-Identifier: Apache-2.0
#include "filters/effects/shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "drivers/ifog/quoted.h"
#include "filters/effects/meaning.h"
#include "filters/effects/reach.h"

namespace ifog {
namespace {

// Fraction of the step response of a first-order low-pass after dt: exact for a constant input.
double share(double dt, double time_constant) {
  return time_constant > 0.0 ? -std::expm1(-dt / time_constant) : 1.0;
}

// How far beyond the range the form's own curve is used.
double curve_reach(const ShapeSettings& settings) noexcept {
  return power_of(settings.form) > 1 ? settings.half_width : 0.0;
}

// The channel limited to its reach.
double followed(const ShapeSettings& settings, const Reach& channel) noexcept {
  const double reach = curve_reach(settings);
  return channel.edge + std::clamp(channel.past_the_edge(), -reach, reach);
}

std::string_view name_of_width(Form form) { return power_of(form) > 1 ? kCurveReach : kHalfWidth; }

double power(double c, Form form) noexcept {
  const double c2 = c * c;
  switch (form) {
    case Form::kAbsolute:
      return std::abs(c);
    case Form::kQuadratic:
      return c2;
    case Form::kCubic:
      return c2 * c;
    case Form::kQuintic:
      return c2 * c2 * c;
    case Form::kSeptic:
      return c2 * c2 * c2 * c;
    default:
      return c;
  }
}

}  // namespace

ShapeSettings shape_settings(const Effect& effect) {
  const auto form = form_named(effect.form);
  if (!form) throw std::invalid_argument("effect form " + in_quotes(effect.form) + " is unknown");
  ShapeSettings settings;
  settings.form = *form == Form::kProduct || *form == Form::kEarthRate ? Form::kLinear : *form;
  settings.reference = effect.reference;
  if (*form == Form::kProduct) return settings;
  settings.time_constant_s = parameter(effect, time_constant_name(*form));
  settings.second_time_constant_s = parameter(effect, second_time_constant_name(*form));
  settings.begins_at_mean = settings.second_time_constant_s > 0.0;
  settings.table_x = effect.table_x;
  settings.table_y = effect.table_y;
  settings.period = effect.period;
  settings.angle = effect.angle;
  settings.fringe = is_of_angle(settings.form) && turn_by_unit(effect.channel) == 0.0;
  settings.half_width = parameter(effect, name_of_width(settings.form));
  return settings;
}

ShapeSettings with_shape_settings(const Effect& effect) {
  const auto form = form_named(effect.with_form);
  if (!form || !may_be_factor(*form)) {
    throw std::invalid_argument("product with form " + in_quotes(effect.with_form) +
                                ", expected a form of a channel other than product, lookup, cosine and sine");
  }
  ShapeSettings settings;
  settings.form = *form;
  settings.reference = effect.with_reference;
  settings.time_constant_s = parameter(effect, time_constant_name(*form));
  settings.second_time_constant_s = parameter(effect, second_time_constant_name(*form));
  settings.begins_at_mean = settings.second_time_constant_s > 0.0;
  if (power_of(*form) > 1) settings.half_width = parameter(effect, kCurveReach);
  return settings;
}

Shape::Shape(ShapeSettings settings)
    : has_state_(has_memory(settings.form) || is_of_time(settings.form) || settings.angle),
      bounded_(is_of_angle(settings.form) || settings.form == Form::kTransition),
      power_(power_of(settings.form)),
      settings_(std::move(settings)) {
  const bool lookup = settings_.form == Form::kLookup;
  if (lookup && (settings_.table_x.size() < 2 || settings_.table_x.size() != settings_.table_y.size())) {
    throw std::invalid_argument("a lookup needs a table of at least two knots");
  }
  if (is_of_angle(settings_.form) && !(settings_.period > 0.0))
    throw std::invalid_argument("a cosine or sine of an angle needs its period");
  if (settings_.time_constant_s < 0.0 || settings_.second_time_constant_s < 0.0) {
    throw std::invalid_argument("a time constant is negative");
  }
  if (settings_.half_width < 0.0) throw std::invalid_argument("a half width is negative");
  if (settings_.form == Form::kTransition && !(settings_.half_width > 0.0))
    throw std::invalid_argument("a transition needs its half_width");
  if (!has_channel(settings_.form) && !is_of_time(settings_.form)) {
    throw std::invalid_argument("form " + in_quotes(std::string(name_of(settings_.form))) +
                                " has no channel to be a shape of");
  }
}

double Shape::table(double value) const noexcept {
  const auto& x = settings_.table_x;
  const auto& y = settings_.table_y;
  if (settings_.period > 0.0) value -= settings_.period * std::floor((value - x.front()) / settings_.period);
  // NaN fails this comparison.
  if (!(value > x.front())) return y.front();
  if (value >= x.back()) return y.back();
  const auto above = std::ranges::upper_bound(x, value);
  const auto i = static_cast<std::size_t>(above - x.begin());
  return y[i - 1] + (y[i] - y[i - 1]) * (value - x[i - 1]) / (x[i] - x[i - 1]);
}

double Shape::at(double value) const noexcept {
  if (settings_.form == Form::kLookup) return table(value);
  const double c = value - settings_.reference;
  const double turns = is_of_angle(settings_.form) ? c / settings_.period : 0.0;
  if (settings_.form == Form::kCosine) return std::cos(2.0 * std::numbers::pi * turns);
  if (settings_.form == Form::kSine) return std::sin(2.0 * std::numbers::pi * turns);
  if (settings_.form == Form::kDeadZone) return std::abs(c) < settings_.half_width ? c : 0.0;
  if (settings_.form == Form::kTransition) return std::tanh(c / settings_.half_width);
  return power(c, settings_.form);
}

double Shape::step(double value, double dt_s) noexcept { return step_over(value, 0.0, dt_s); }

double Shape::step_over(double value, double scatter, double dt_s) noexcept {
  if (!has_state_) return settings_.form == Form::kQuadratic ? at(value) + scatter : at(value);
  if (dt_s != dt_) {
    dt_ = dt_s;
    alpha_ = share(dt_s, settings_.time_constant_s);
    const bool second = settings_.form == Form::kSecondRate;
    const bool usual = settings_.form == Form::kBandPower && settings_.second_time_constant_s == 0.0;
    beta_ = share(dt_s, second  ? settings_.time_constant_s
                        : usual ? kPowerAverage_s
                                : settings_.second_time_constant_s);
  }
  const bool fresh = !started_;
  started_ = true;
  switch (settings_.form) {
    case Form::kWarmUp:
      elapsed_ = fresh ? settings_.elapsed_s : elapsed_ + dt_s;
      return std::exp(-elapsed_ / settings_.time_constant_s);
    case Form::kBias:
      return 1.0;
    case Form::kRateRamp:
      return elapsed_ = fresh ? 0.0 : elapsed_ + dt_s;
    case Form::kLookup: {
      const double angle = table(value);
      const double change = fresh || dt_s <= 0.0 ? 0.0 : (angle - first_) / dt_s;
      first_ = angle;
      return change;
    }
    default:
      break;
  }
  const double c = value - settings_.reference;
  if (fresh) {
    first_ = c;
    elapsed_ = 0.0;
    second_ = settings_.form == Form::kLagged ? c : 0.0;
  }
  elapsed_ += dt_s;
  const bool settling = settings_.form == Form::kBandPower && settings_.begins_at_mean && elapsed_ > 0.0;
  const double step1 = (settling ? std::max(alpha_, dt_s / elapsed_) : alpha_) * (c - first_);
  first_ += step1;
  switch (settings_.form) {
    case Form::kRate:
      return dt_s > 0.0 ? step1 / dt_s : 0.0;
    case Form::kSecondRate: {
      const double slope = dt_s > 0.0 ? step1 / dt_s : 0.0;
      const double step2 = beta_ * (slope - second_);
      second_ += step2;
      return dt_s > 0.0 ? step2 / dt_s : 0.0;
    }
    case Form::kLagged:
      second_ += beta_ * (first_ - second_);
      return second_;
    default: {  // band power: mean square of the high-passed channel
      const double high = c - first_;
      second_ += beta_ * (high * high + scatter - second_);
      return second_;
    }
  }
}

double Shape::slope(double value) const noexcept {
  if (power_ > 0) return power_ * std::pow(value - settings_.reference, static_cast<double>(power_ - 1));
  if (settings_.form == Form::kAbsolute) return std::copysign(1.0, value - settings_.reference);
  if (settings_.form == Form::kTransition) {
    const double level = at(value);
    return (1.0 - level * level) / settings_.half_width;
  }
  if (settings_.form != Form::kLookup || settings_.period > 0.0) return 0.0;
  const auto& x = settings_.table_x;
  const auto& y = settings_.table_y;
  const std::size_t n = x.size();
  const std::size_t i = value < 0.5 * (x.front() + x.back()) ? 1 : n - 1;
  return (y[i] - y[i - 1]) / (x[i] - x[i - 1]);
}

double Shape::at(const Reach& channel) const noexcept {
  if (is_of_angle(settings_.form)) return at(settings_.fringe ? channel.value : channel.edge);
  if (bounded_) return at(channel.value + channel.beyond);
  if (!goes_on() || !channel.outside()) return at(channel.edge);
  const double curved = followed(settings_, channel);
  return at(curved) + slope(curved) * (channel.value - curved);
}

double Shape::step(const Reach& channel, double dt_s) noexcept {
  if (bounded_) return at(channel);
  if (power_ > 1 && channel.outside()) return at(channel);
  return step(goes_on() ? channel.value : channel.edge, dt_s);
}

double Shape::left_behind(const Reach& channel) const noexcept {
  if (settings_.angle || !channel.outside()) return 0.0;
  if (settings_.form == Form::kDeadZone) return 0.0;
  if (bounded_) return std::abs(at(channel.value + channel.beyond) - at(channel.edge));
  const double past = channel.past_the_edge();
  if (!goes_on()) return std::abs(slope(channel.edge) * (past + channel.beyond));
  if (power_ > 0 || settings_.form == Form::kAbsolute) {
    return std::abs(at(channel.value) - at(channel)) +
           std::abs(slope(followed(settings_, channel)) * channel.beyond);
  }
  const double tau = std::max(settings_.time_constant_s, 1e-3);
  switch (settings_.form) {
    case Form::kRate:
      return std::abs(channel.beyond) / tau;
    case Form::kSecondRate:
      return std::abs(channel.beyond) / (tau * tau);
    case Form::kBandPower:
      return channel.beyond * channel.beyond;
    default:
      return std::abs(channel.beyond);
  }
}

double Shape::unseen_curvature(const Reach& channel) const noexcept {
  const double past = std::abs(channel.past_the_edge());
  if (past == 0.0 || !goes_on() || settings_.form == Form::kDeadZone) return 0.0;
  const bool straight = settings_.form == Form::kLagged || settings_.form == Form::kRateRamp;
  const double steepness = straight ? 1.0 : std::abs(slope(channel.edge));
  return std::sqrt(15.0) * steepness * (past + past * past / channel.span);
}

bool Shape::take_over(const Shape& previous) noexcept {
  const ShapeSettings& a = settings_;
  const ShapeSettings& b = previous.settings_;
  if (a.form != b.form || a.reference != b.reference || a.time_constant_s != b.time_constant_s ||
      a.second_time_constant_s != b.second_time_constant_s || a.period != b.period ||
      a.half_width != b.half_width || a.angle) {
    return false;
  }
  first_ = previous.first_;
  second_ = previous.second_;
  elapsed_ = previous.elapsed_;
  started_ = previous.started_;
  return true;
}

}  // namespace ifog
