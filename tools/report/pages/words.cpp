// SPDX-License-Identifier: Apache-2.0
#include "tools/report/pages/words.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "filters/effects/form.h"
#include "filters/units/field_units.h"
#include "tools/report/text.h"

namespace ifog::report {
namespace {

bool ends_with(const std::string& text, const std::string& end, std::string& head) {
  if (text.size() < end.size() || text.compare(text.size() - end.size(), end.size(), end) != 0) return false;
  head = text.substr(0, text.size() - end.size());
  return true;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string typeset_unit(std::string unit) {
  static constexpr std::array<std::pair<const char*, const char*>, 8> kUnits{{{"degC", "°C"},
                                                                              {"radps", "rad/s"},
                                                                              {"mps2", "m/s²"},
                                                                              {"uT", "µT"},
                                                                              {"percent", "%"},
                                                                              {"^2", "²"},
                                                                              {"^3", "³"},
                                                                              {"*", "·"}}};
  for (const auto& [from, to] : kUnits) unit = replaced(unit, from, to);
  return unit;
}

// Unit in the column's name, "mps2" in "accel_x_mps2".
std::string raw_unit(const std::string& column) {
  const auto at = column.rfind('_');
  return at == std::string::npos || at + 1 == column.size() ? "" : column.substr(at + 1);
}

}  // namespace

std::string channel_words(const std::string& column) {
  const ChannelNames names = names_in(column);
  if (!names.less.empty()) return channel_words(names.of) + " less " + channel_words(names.less);
  const std::string unit = raw_unit(column);
  std::string head = column;
  if (!unit.empty()) ends_with(column, "_" + unit, head);
  return replaced(head, "_", " ");
}

std::string channel_label(const std::string& column) {
  const std::string unit = raw_unit(column);
  return channel_words(column) + (unit.empty() ? "" : " (" + typeset_unit(unit) + ")");
}

std::string abscissa_label(const Effect& e) {
  const std::string words = channel_words(e.channel), unit = typeset_unit(raw_unit(e.channel));
  const Form form = form_named(e.form).value_or(Form::kLinear);
  std::string own = channel_label(e.channel);
  if (form == Form::kRate) own = "d/dt of " + words + " (" + unit + "/s)";
  if (form == Form::kSecondRate) own = "second derivative of " + words + " (" + unit + "/s²)";
  if (form == Form::kLagged) {
    const double lag = parameter(e, "time_constant_s");
    own = words + (lag > 0.0 ? ", lagged " + duration(lag) : ", lagged") +
          (unit.empty() ? "" : " (" + unit + ")");
  }
  if (form == Form::kAbsolute) own = "size of " + own;
  if (form == Form::kDeadZone) own = words + " in the dead zone (" + unit + ")";
  if (form == Form::kCosine || form == Form::kSine) own = e.form + " of " + words;
  if (form == Form::kBandPower) own = "mean square of " + words + " (" + unit + "²)";
  if (e.with_channel.empty()) return own;
  return words + " × " + e.with_form + " of " + channel_words(e.with_channel) + " (" + unit + " · " +
         typeset_unit(raw_unit(e.with_channel)) + ")";
}

std::string effect_words(const Effect& e) {
  if (e.form == "line") return "line at " + number(parameter(e, "frequency_hz"), 4) + " Hz";
  std::string out = replaced(e.form, "_", " ");
  if (!e.channel.empty()) out += " in " + channel_words(e.channel);
  if (e.form == "rate") out = "rate of change of " + channel_words(e.channel);
  if (e.form == "lagged") out = channel_words(e.channel) + ", lagged";
  if (e.form == "absolute") out = "size of " + channel_words(e.channel);
  if (e.form == "dead_zone") out = "dead zone of the rate";
  if (e.form == "cosine" || e.form == "sine") out = e.form + " of " + channel_words(e.channel);
  if (e.form == "lookup") out = "curve over " + channel_words(e.channel);
  if (!e.with_channel.empty())
    out = channel_words(e.channel) + " × " + (e.with_form == "linear" ? "" : e.with_form + " ") +
          channel_words(e.with_channel);
  return out;
}

std::vector<ModelParameter> shown_parameters(const FoundEffect& found) {
  std::vector<ModelParameter> out = found.effect.parameters;
  if (found.effect.form != "line" || out.size() < 2) return out;
  const double amplitude = std::hypot(out[0].value, out[1].value),
               both = std::hypot(out[0].std_error, out[1].std_error);
  const double along =
      found.likelihood_ratio > 0.0 ? amplitude / std::sqrt(found.likelihood_ratio) : out[0].std_error;
  const double across = std::sqrt(std::max(both * both - along * along, 0.0));
  const double phase_deg = std::atan2(out[1].value, out[0].value) / kDegree;
  out[0] = {"amplitude", amplitude, along, out[0].unit};
  out[1] = {"phase", phase_deg, amplitude > 0.0 ? std::min(180.0, across / amplitude / kDegree) : 180.0, "°"};
  return out;
}

Figure figure(const std::string& key) {
  std::string head;
  if (key == "residual_rms_radps") return {"RMS of single samples", "°/h", 1.0 / kDegreePerHour};
  if (key == "heading_drift_rad")
    return {"heading at the end, bias from the first tenth", "°", 1.0 / kDegree};
  if (key == "whiteness") return {"correlation of 1 s means (0: white noise)", "", 1.0};
  if (ends_with(key, "_radps", head) && head.rfind("rms_", 0) == 0)
    return {"RMS of " + replaced(head.substr(4), "s", " s") + " means", "°/h", 1.0 / kDegreePerHour};
  if (ends_with(key, "_radps", head) && head.rfind("adev_", 0) == 0)
    return {"Allan deviation at " + replaced(head.substr(5), "s", " s"), "°/h", 1.0 / kDegreePerHour};
  Figure f{replaced(key, "_", " "), "", 1.0};
  if (ends_with(key, "_rad2ps2", head))
    f = {replaced(head, "_", " "), "(°/h)²", 1.0 / (kDegreePerHour * kDegreePerHour)};
  if (ends_with(key, "_radps", head)) f = {replaced(head, "_", " "), "°/h", 1.0 / kDegreePerHour};
  if (ends_with(key, "_rad", head)) f = {replaced(head, "_", " "), "°", 1.0 / kDegree};
  return f;
}

FieldUnit field_unit(const std::string& si) {
  if (si == "rad/s^2") return {1.0 / kDegreePerHourPerHour, "°/h/h"};
  if (si.rfind("rad/s", 0) == 0) {
    const std::string rest = si.substr(5);
    // Errors proportional to the rate are given in ppm.
    if (rest.rfind("/(rad/s)", 0) == 0 && rest.find('^') == std::string::npos)
      return {1e6, "ppm" + typeset_unit(rest.substr(8))};
    return {1.0 / kDegreePerHour, "°/h" + typeset_unit(rest)};
  }
  if (si == "rad") return {1e6, "µrad"};
  return {1.0, typeset_unit(si)};
}

}  // namespace ifog::report
