// SPDX-License-Identifier: Apache-2.0
#include "filters/effects/meaning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "filters/model_file/channel_names.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

bool has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

std::string power_unit(const std::string& unit, int power) {
  return power == 1 ? unit : unit + "^" + std::to_string(power);
}

// Unit of a form's value for a channel's unit.
std::string form_unit(Form form, const std::string& unit) {
  switch (form) {
    case Form::kRate:
      return "(" + unit + "/s)";
    case Form::kSecondRate:
      return "(" + unit + "/s^2)";
    case Form::kBandPower:
      return unit + "^2";
    case Form::kLagged:
    case Form::kAbsolute:
    case Form::kDeadZone:
      return unit;
    default:
      return power_unit(unit, std::max(1, power_of(form)));
  }
}

std::string order_of(Form form) {
  constexpr std::array<const char*, 8> kByPower{
      "", "", "quadratic ", "cubic ", "", "fifth-order ", "", "seventh-order "};
  return kByPower[static_cast<std::size_t>(power_of(form))];
}

std::string of_gradient(Form form) {
  if (form == Form::kRate)
    return "Shupe effect: bias follows the rate of change of the gradient between two thermometers";
  return "Shupe effect: " + order_of(form) +
         "dependence of the bias on the gradient between two thermometers" +
         (form == Form::kLagged ? ", with a lag" : "");
}

std::string of_other_axis(const std::string& name, Form form) {
  const std::string axis = axis_of_rate(name);
  if (form == Form::kLinear) return "misalignment: the axis sees a part of the rotation about " + axis;
  return order_of(form) + "dependence on the rotation about " + axis;
}

std::string of_angle(const Effect& effect) {
  const long times = std::lround(turn_by_unit(effect.channel) / std::max(effect.period, 1e-300));
  return (times == 1   ? "once"
          : times == 2 ? "twice"
                       : std::to_string(times) + " times") +
         std::string(
             " a turn: what the sensor meets in a direction of the room, as a magnetic field or the "
             "Earth's rate, or a part of it that runs out of true");
}

std::string of_fringe(const Effect& effect) {
  return formatted("fringe: light of a second path interferes, and the bias swings once for every %.3g %s",
                   effect.period, unit_of(effect.channel).c_str());
}

std::string of_temperature(Form form) {
  switch (form) {
    case Form::kLinear:
      return "bias follows the temperature";
    case Form::kRate:
      return "Shupe effect: bias follows the rate of change of the temperature";
    case Form::kSecondRate:
      return "bias follows the second time derivative of the temperature (temperature gradient across the "
             "coil settling)";
    case Form::kLagged:
      return "bias follows the temperature with a lag: the sensing coil is warmer or cooler than the "
             "thermometer";
    case Form::kLookup:
      return "bias is a curve in temperature";
    case Form::kTransition:
      return "the bias goes from one level to another over the temperature, as where the polarisation of the "
             "coil turns over";
    default:
      return order_of(form) + "temperature dependence of the bias";
  }
}

std::string of_acceleration(Form form) {
  switch (form) {
    case Form::kLinear:
      return "g-sensitivity: bias follows the specific force";
    case Form::kEarthRate:
      return "the Earth's rate turning into the axis as the sensor tilts";
    case Form::kQuadratic:
      return "g-squared sensitivity";
    case Form::kBandPower:
      return "vibration rectification: bias follows the mean square of the vibration";
    default:
      return order_of(form) + "dependence on the specific force";
  }
}

std::string of_reference(Form form) {
  if (form == Form::kLinear) return "scale factor error";
  if (form == Form::kAbsolute) return "scale factor asymmetry: another one backwards";
  if (form == Form::kDeadZone)
    return "dead zone: slow rotation is not seen, as where a closed loop locks in (2 pi reset, coupling of "
           "its electronics); what was not seen cannot be given back";
  if (power_of(form) % 2 == 1) return "scale factor nonlinearity, " + order_of(form) + "in the rate";
  return "scale factor asymmetry between the directions, " + order_of(form) + "in the rate";
}

std::string of_channel(ChannelKind kind, Form form, const std::string& name) {
  if (kind == ChannelKind::kTemperature && !names_in(name).less.empty()) return of_gradient(form);
  switch (kind) {
    case ChannelKind::kTemperature:
      return of_temperature(form);
    case ChannelKind::kOtherAxis:
      return of_other_axis(name, form);
    case ChannelKind::kAcceleration:
      return of_acceleration(form);
    case ChannelKind::kReferenceRate:
      return of_reference(form);
    case ChannelKind::kMagneticField:
      if (form == Form::kLinear)
        return "Faraday effect: bias follows the magnetic field along the coil's axis";
      break;
    case ChannelKind::kRamp:
      if (form == Form::kLookup)
        return "nonlinearity of the closed loop's feedback ramp (phase modulator, 2 pi reset)";
      break;
    case ChannelKind::kSupply:
      if (form == Form::kLinear) return "bias follows the supply";
      break;
    default:
      break;
  }
  switch (form) {
    case Form::kLinear:
      return "bias follows " + name;
    case Form::kRate:
      return "bias follows the rate of change of " + name;
    case Form::kSecondRate:
      return "bias follows the second derivative of " + name;
    case Form::kLagged:
      return "bias follows " + name + " with a lag";
    case Form::kAbsolute:
      return "bias follows the size of " + name + ", whatever its sign";
    case Form::kLookup:
      return "bias is a curve in " + name;
    case Form::kBandPower:
      return "bias follows the mean square of the fast part of " + name;
    default:
      return order_of(form) + "dependence of the bias on " + name;
  }
}

std::string of_product(const Effect& effect, Form with_form) {
  const bool first = is_reference_rate(effect.channel);
  const bool second = is_reference_rate(effect.with_channel);
  if (first || second) {
    const std::string& other = first ? effect.with_channel : effect.channel;
    const Form order = second ? with_form : Form::kLinear;
    const std::string what =
        order == Form::kLinear ? "scale factor" : order_of(order) + "scale factor nonlinearity";
    const std::string how = first ? order_of(with_form) : "";
    if (kind_of(other) == ChannelKind::kTemperature && first && with_form == Form::kLagged)
      return what + " changes with the coil's temperature, which follows the thermometer with a lag";
    if (kind_of(other) == ChannelKind::kTemperature)
      return what + " changes with temperature (" + how + "product with the rate)";
    return what + " changes with " + other;
  }
  return "product of " + effect.channel + " and " + effect.with_channel;
}

// k is coil diameter / (wavelength × refractive index), since the ramp resets by 2 pi per wavelength: 1.55 um
// and 1.45.
std::string of_rebuilt_ramp(const Effect& effect) {
  const double k = std::abs(parameter(effect, "cycles_per_rad"));
  return formatted(
      "nonlinearity of the closed loop's feedback ramp (phase modulator, 2 pi reset), which was not "
      "logged: its phase is rebuilt from the angle turned, %ld cycles a radian, as a coil of %.2g cm at 1.55 "
      "um has",
      std::lround(k), 100.0 * k * 1.55e-6 * 1.45);
}

}  // namespace

double turn_by_unit(std::string_view channel) {
  const std::string unit = unit_of(channel);
  if (unit == "rad") return 2.0 * std::numbers::pi;
  if (unit == "deg") return 360.0;
  return unit == "turns" ? 1.0 : 0.0;
}

Motion motion_of(std::string_view channel) {
  const auto any = [&](std::initializer_list<std::string_view> words) {
    const std::string whole = "_" + std::string(channel) + "_";
    return std::ranges::any_of(words,
                               [&](std::string_view word) { return has(whole, "_" + std::string(word)); });
  };
  const auto in = [&](std::initializer_list<std::string_view> units) {
    return std::ranges::any_of(units, [&](std::string_view unit) { return channel.ends_with(unit); });
  };
  const ChannelKind kind = kind_of(channel);
  if (kind == ChannelKind::kReferenceRate || kind == ChannelKind::kTemperature) return Motion::kNone;
  if (kind == ChannelKind::kOtherAxis) return Motion::kRate;
  if (any({"seis", "geophone"}) && !in({"_m", "_mm", "_um", "_nm", "_mps2"})) return Motion::kVelocity;
  if (kind == ChannelKind::kAcceleration || in({"_mg", "_ug"})) return Motion::kAcceleration;
  // What runs or flows near a sensor at rest.
  const bool near_by = any({"fan", "pump", "cool", "chiller", "compressor", "blower", "flow"});
  // What turns the sensor, its vehicle or its tower, whatever the unit: %, A, V, hPa, commands.
  const bool machine =
      !near_by &&
      (any({"motor",  "wheel",  "servo", "gimbal",  "mount",    "axle",     "shaft", "winch",    "steer",
            "thrust", "rudder", "helm",  "aileron", "elevator", "actuator", "sail",  "throttle", "engine",
            "propel", "brake",  "pedal", "force",   "towing",   "torque",   "wind_", "gust"}) ||
       in({"_rpm", "_N", "_kN", "_Nm", "_kNm"}));
  if (kind == ChannelKind::kSupply || kind == ChannelKind::kPressure)
    return machine ? Motion::kRate : Motion::kNone;
  if (kind != ChannelKind::kOther) return Motion::kNone;
  if (in({"_radps", "_degps", "_dps"})) return Motion::kRate;
  if (in({"_mps", "_kmh", "_kmph", "_mph", "_knots", "_kn", "_mmps", "_umps", "_nmps"}))
    return near_by ? Motion::kNone : Motion::kVelocity;
  if (in({"_rad", "_deg", "_turns", "_mrad", "_urad", "_nrad", "_arcsec"}))
    return any({"phase"}) ? Motion::kNone : Motion::kAngle;
  if (in({"_m", "_mm", "_um", "_nm"}))
    return any({"wave", "lambda", "level", "fibre", "fiber"}) ? Motion::kNone : Motion::kPosition;
  if (any({"tilt", "inclin", "heading", "yaw", "pitch", "encoder"})) return Motion::kAngle;
  if (any({"curvature", "odometer", "position"})) return Motion::kPosition;
  return machine ? Motion::kRate : Motion::kNone;
}

ChannelKind kind_of(std::string_view channel) {
  if (is_reference_rate(channel)) return ChannelKind::kReferenceRate;
  if (!axis_of_rate(channel).empty()) return ChannelKind::kOtherAxis;
  if (has(channel, "ramp")) return ChannelKind::kRamp;
  if (has(channel, "temp") || channel.ends_with("_degC") || channel.ends_with("_K"))
    return ChannelKind::kTemperature;
  if (has(channel, "accel") || channel.ends_with("_mps2") || channel.ends_with("_g"))
    return ChannelKind::kAcceleration;
  if (has(channel, "mag") || channel.ends_with("_T") || channel.ends_with("_uT") || channel.ends_with("_G")) {
    return ChannelKind::kMagneticField;
  }
  if (has(channel, "supply") || channel.ends_with("_V")) return ChannelKind::kSupply;
  if (has(channel, "pressure") || channel.ends_with("_Pa") || channel.ends_with("_hPa"))
    return ChannelKind::kPressure;
  return ChannelKind::kOther;
}

double reference_of(std::string_view channel) {
  if (!names_in(channel).less.empty()) return 0.0;
  if (channel.ends_with("_degC")) return 25.0;
  if (channel.ends_with("_V")) return 12.0;
  return 0.0;
}

std::string unit_of(std::string_view channel) {
  const auto at = channel.rfind('_');
  if (at == std::string_view::npos || at + 1 == channel.size()) return "";
  const std::string_view unit = channel.substr(at + 1);
  if (unit == "mps2") return "(m/s^2)";
  if (unit == "radps") return "(rad/s)";
  return std::string(unit);
}

std::string name_of(const Effect& effect) {
  return effect.form + (effect.channel.empty() ? "" : " of " + effect.channel) +
         (effect.with_form.empty() ? "" : " with " + effect.with_form + " of " + effect.with_channel);
}

std::string meaning_of(const Effect& effect) {
  const auto form = form_named(effect.form);
  if (!form) return "";
  switch (*form) {
    case Form::kProduct:
      return of_product(effect, form_named(effect.with_form).value_or(Form::kLinear));
    case Form::kLine:
      return "a line, not corrected: vibration, mains, a structure's own frequency, or a beat in the sensor";
    case Form::kStep:
      return "the bias jumped once; not corrected, for another record has no such jump";
    case Form::kRateRamp:
      return "the bias drifts steadily with time";
    case Form::kBias:
      return "constant bias: what the rate reads beyond the reference";
    case Form::kWarmUp:
      return "warm-up: the bias settles exponentially after power-up, which is the start of the record "
             "unless a recording or --since-power-up says otherwise";
    case Form::kRebuiltRamp:
      return of_rebuilt_ramp(effect);
    case Form::kGaussMarkov:
      return "slow noise with a correlation time";
    case Form::kOutliers:
      return "single samples far outside the noise";
    case Form::kNoiseChange:
      return "the noise level changed during the record";
    case Form::kQuantisation:
      return "the rate comes in steps";
    case Form::kCosine:
    case Form::kSine:
      return turn_by_unit(effect.channel) > 0.0 ? of_angle(effect) : of_fringe(effect);
    default:
      return of_channel(kind_of(effect.channel), *form, effect.channel);
  }
}

std::string meaning_of_earth_rate(const Effect& effect) {
  const Form form = form_named(effect.form).value_or(Form::kEarthRate);
  if (form == Form::kCosine || form == Form::kSine)
    return "the Earth's rate turning into the axis as the sensor is turned to other headings";
  const bool first = power_of(form) == 1;
  return std::string("the Earth's rate turning into the axis as the sensor tilts") +
         (first ? "" : ", what its straight line leaves");
}

std::string coefficient_unit(const Effect& effect) {
  const auto form = form_named(effect.form);
  if (!form) return "rad/s";
  if (*form == Form::kProduct) {
    const Form with = form_named(effect.with_form).value_or(Form::kLinear);
    return "rad/s/" + form_unit(Form::kLinear, unit_of(effect.channel)) + "/" +
           form_unit(with, unit_of(effect.with_channel));
  }
  if (*form == Form::kRateRamp) return "rad/s^2";
  if (!has_channel(*form) || *form == Form::kLookup || *form == Form::kCosine || *form == Form::kSine ||
      *form == Form::kTransition)
    return "rad/s";
  if (*form == Form::kLinear && kind_of(effect.channel) == ChannelKind::kOtherAxis) return "rad";
  const std::string unit = unit_of(effect.channel);
  return "rad/s/" + form_unit(*form, unit.empty() ? "unit" : unit);
}

}  // namespace ifog
