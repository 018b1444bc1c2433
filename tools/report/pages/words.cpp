// SPDX-License-Identifier: Apache-2.0
#include "tools/report/pages/words.h"

#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <cctype>
#include <cmath>
#include <string_view>
#include <tuple>
#include <utility>

#include "filters/model_file/channel_names.h"
#include "filters/model_file/form.h"
#include "filters/units/field_units.h"
#include "tools/report/text.h"

namespace ifog::report {
namespace {

std::string typeset_unit(std::string unit) {
  static constexpr std::array<std::pair<const char*, const char*>, 8> kUnits{{{"degC", "°C"},
                                                                              {"radps", "rad/s"},
                                                                              {"mps2", "m/s²"},
                                                                              {"uT", "µT"},
                                                                              {"percent", "%"},
                                                                              {"^2", "²"},
                                                                              {"^3", "³"},
                                                                              {"*", "·"}}};
  for (const auto& [from, to] : kUnits) boost::replace_all(unit, from, to);
  return unit;
}

// Unit in the column's name, "mps2" in "accel_x_mps2".
std::string raw_unit(const std::string& column) {
  const auto at = column.rfind('_');
  return at == std::string::npos || at + 1 == column.size() ? "" : column.substr(at + 1);
}

double averaging_time(const std::string& key) {
  const auto at = key.find_first_of("0123456789");
  return at == std::string::npos ? 0.0 : std::strtod(key.c_str() + at, nullptr);
}

int family(const std::string& key) {
  if (key.starts_with("residual")) return 0;
  if (key.starts_with("rms")) return 1;
  if (key.starts_with("adev")) return 2;
  return 3;
}

// The averaging time with the largest improvement.
std::string most_improved(const Diagnosis& d) {
  std::string best;
  double least = 1.0;
  for (const auto& [key, before] : d.before) {
    const auto after = d.after.find(key);
    if (family(key) > 1 || after == d.after.end() || !(before > 0.0)) continue;
    if (after->second / before < least) {
      least = after->second / before;
      best = key;
    }
  }
  return best;
}

std::string count_words(std::size_t count) {
  static const char* kWords[] = {"No effect",     "One effect",   "Two effects",
                                 "Three effects", "Four effects", "Five effects"};
  return count < 6 ? kWords[count] : std::to_string(count) + " effects";
}

// One entry per effect, HTML; a comb of lines is one entry.
std::vector<std::string> effects_in_words(const Diagnosis& d) {
  std::string lines;
  std::size_t line_count = 0;
  for (const FoundEffect& found : d.effects)
    if (found.effect.form == "line") {
      lines += (line_count == 0 ? "" : ", ") + number(parameter(found.effect, "frequency_hz"), 4);
      ++line_count;
    }
  std::vector<std::string> each;
  for (const FoundEffect& found : d.effects) {
    if (found.effect.form == "line" && line_count > 2) continue;
    each.push_back(escaped(sentence(effect_words(found.effect) +
                                    (found.effect.meaning.empty() ? "" : " – " + found.effect.meaning))));
  }
  if (line_count > 2) each.push_back(std::to_string(line_count) + " lines, at " + lines + " Hz.");
  return each;
}

}  // namespace

std::string channel_words(const std::string& column) {
  const ChannelNames names = names_in(column);
  if (!names.less.empty()) return channel_words(names.of) + " less " + channel_words(names.less);
  const std::string unit = raw_unit(column);
  const std::string head = unit.empty() ? column : column.substr(0, column.size() - unit.size() - 1);
  return boost::replace_all_copy(head, "_", " ");
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
  std::string out = boost::replace_all_copy(e.form, "_", " ");
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

std::string parameter_words(std::string name) {
  for (const std::string_view unit : {"_hz", "_s"})
    if (name.ends_with(unit)) name.erase(name.size() - unit.size());
  return boost::replace_all_copy(name, "_", " ");
}

Figure figure(const std::string& key) {
  if (key == "residual_rms_radps") return {"RMS of single samples", "°/h", 1.0 / kDegreePerHour};
  if (key == "heading_drift_rad")
    return {"heading at the end, bias from the first tenth", "°", 1.0 / kDegree};
  if (key == "whiteness") return {"correlation of 1 s means (0: white noise)", "", 1.0};
  for (const auto& [ending, unit, scale] :
       {std::tuple{"_rad2ps2", "(°/h)²", 1.0 / (kDegreePerHour * kDegreePerHour)},
        std::tuple{"_radps", "°/h", 1.0 / kDegreePerHour}, std::tuple{"_rad", "°", 1.0 / kDegree}}) {
    if (!key.ends_with(ending)) continue;
    const std::string head = key.substr(0, key.rfind('_'));
    const auto time_after = [&](std::size_t begin) {
      return boost::replace_all_copy(head.substr(begin), "s", " s");
    };
    if (head.starts_with("rms_")) return {"RMS of " + time_after(4) + " means", unit, scale};
    if (head.starts_with("adev_")) return {"Allan deviation at " + time_after(5), unit, scale};
    return {boost::replace_all_copy(head, "_", " "), unit, scale};
  }
  return {boost::replace_all_copy(key, "_", " "), "", 1.0};
}

FieldUnit field_unit(const std::string& si) {
  if (si == "rad/s^2") return {1.0 / kDegreePerHourPerHour, "°/h/h"};
  if (si.starts_with("rad/s")) {
    const std::string rest = si.substr(5);
    // Errors proportional to the rate are given in ppm.
    if (rest.starts_with("/(rad/s)") && rest.find('^') == std::string::npos)
      return {1e6, "ppm" + typeset_unit(rest.substr(8))};
    return {1.0 / kDegreePerHour, "°/h" + typeset_unit(rest)};
  }
  if (si == "rad") return {1e6, "µrad"};
  return {1.0, typeset_unit(si)};
}

bool parts_overlap(const Diagnosis& diagnosis) {
  double sum = 0.0;
  for (const FoundEffect& found : diagnosis.effects) sum += found.variance_explained;
  return sum > 1.05;
}

std::string sentence(const std::string& text) {
  if (text.empty()) return "";
  std::string out = text;
  out[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(out[0])));
  if (out.back() != '.' && out.back() != '!' && out.back() != '?') out += '.';
  return out;
}

std::string probability(double p) { return p < 1e-6 ? "below one in a million" : number(p, 2); }

std::vector<std::string> in_reading_order(const std::map<std::string, double>& figures) {
  std::vector<std::string> keys;
  keys.reserve(figures.size());
  for (const auto& [key, value] : figures) keys.push_back(key);
  std::ranges::stable_sort(keys, [](const std::string& a, const std::string& b) {
    return family(a) != family(b) ? family(a) < family(b) : averaging_time(a) < averaging_time(b);
  });
  return keys;
}

std::string account_of_change(const Diagnosis& d, const std::string& key) {
  const auto before = d.before.find(key), after = d.after.find(key);
  if (before == d.before.end() || after == d.after.end()) return "";
  const Figure f = figure(key);
  const double change = after->second / before->second - 1.0;
  return "The " + f.label +
         (change < -0.005  ? " falls from "
          : change > 0.005 ? " rises from "
                           : " stays: from ") +
         number(before->second * f.scale) + " to " + number(after->second * f.scale) + " " + f.unit +
         (std::abs(change) > 0.005
              ? " (" + std::string(change > 0 ? "+" : "") + number(100.0 * change, 2) + " %)"
              : "") +
         ".";
}

std::string account(const Diagnosis& d) {
  if (d.effects.empty() && d.hysteresis) {
    return "<p><strong>Nothing was found that a correction could take away.</strong></p>\n<p>" +
           account_of_rest(d) + "</p>\n";
  }
  if (d.effects.empty()) {
    return "<p><strong>Nothing was found.</strong> No channel, and no pattern in time, explains more of this "
           "error than chance would. That is a result: a correction by them would only add to it.</p>\n<p>" +
           account_of_rest(d) + "</p>\n";
  }
  std::string out = "<p><strong>" + count_words(d.effects.size()) +
                    (d.effects.size() == 1 ? " was" : " were") + " found.</strong>";
  const std::vector<std::string> each = effects_in_words(d);
  if (each.size() == 1) {
    out += " " + each.front() + "</p>\n";
  } else {
    out += "</p>\n<ul>\n";
    for (const std::string& words : each) out += "<li>" + words + "</li>\n";
    out += "</ul>\n";
  }
  const std::string key = most_improved(d);
  if (!key.empty())
    out += "<p>The worse of full-data and held-out error: " + escaped(account_of_change(d, key)) + " " +
           (key == "residual_rms_radps" ? "" : escaped(account_of_change(d, "residual_rms_radps"))) +
           "</p>\n";
  if (!d.indistinguishable.empty())
    out += "<p>Not every name is certain: see <em>What cannot be distinguished</em>.</p>\n";
  return out + "<p>" + account_of_rest(d) + "</p>\n";
}

std::string account_of_rest(const Diagnosis& d) {
  const Unexplained& u = d.unexplained;
  if (u.kind.empty() || u.kind == "nothing") return "Nothing more is found in what remains.";
  std::string kind = u.kind;
  std::ranges::replace(kind, '_', ' ');
  return "Something remains unexplained: <strong>" + escaped(kind) + "</strong>, " +
         (u.fraction < 1e-3 ? "under 0.1" : number(100.0 * u.fraction, 2)) +
         " % of the variance that is neither white noise nor explained." +
         (u.hint.empty() ? "" : " " + escaped(sentence(u.hint)));
}

}  // namespace ifog::report
