// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "filters/effects/meaning.h"
#include "filters/model_file/channel_names.h"
#include "filters/model_file/form.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"
#include "tools/ifog/diagnose/sensor_diagnosis.h"
#include "tools/report/coefficients.h"
#include "tools/report/pages/words.h"

namespace ifog::tools {
namespace {

using Json = nlohmann::ordered_json;

Json name_json(const Effect& effect) {
  Json json;
  json["form"] = effect.form;
  const ChannelNames names = names_in(effect.channel);
  json["channel"] = names.of.empty() ? Json(nullptr) : Json(names.of);
  if (!names.less.empty()) json["minus_channel"] = names.less;
  if (!effect.with_form.empty()) {
    const ChannelNames with = names_in(effect.with_channel);
    json["with"] = {{"form", effect.with_form}, {"channel", with.of}};
    if (!with.less.empty()) json["with"]["minus_channel"] = with.less;
  }
  return json;
}

Json noise_terms_json(const NoiseTerms& noise) {
  Json json = Json::object();
  const char* const names[] = {"Q_rad", "N_radps_rthz", "B_radps", "K_radps2_rthz", "R_radps2"};
  for (std::size_t i = 0; i < kNoiseTerms.size(); ++i)
    if (const std::optional<double>& value = noise.*kNoiseTerms[i].second) json[names[i]] = *value;
  return json;
}

Json effect_json(const FoundEffect& found) {
  Json json = name_json(found.effect);
  json["meaning"] = found.effect.meaning;
  if (found.effect.shown_only) json["subtracted"] = false;
  Json parameters = Json::object();
  for (const ModelParameter& parameter : found.effect.parameters) {
    parameters[parameter.name] = {
        {"value", parameter.value}, {"std_error", parameter.std_error}, {"unit", parameter.unit}};
  }
  json["parameters"] = parameters;
  if (has_channel(form_named(found.effect.form).value_or(Form::kLine))) {
    json["reference"] = found.effect.reference;
    if (!found.effect.with_form.empty()) json["with"]["reference"] = found.effect.with_reference;
  }
  if (found.effect.table_x.empty() && found.effect.period > 0.0) json["period"] = found.effect.period;
  if (!found.effect.table_x.empty()) {
    json["table"] = {{"x", found.effect.table_x},
                     {"y", found.effect.table_y},
                     {"period", found.effect.period},
                     {"kind", found.effect.angle ? "angle_rad" : "rate_radps"}};
  }
  json["p_value"] = found.p_value;
  json["variance_explained"] = found.variance_explained;
  json["likelihood_ratio"] = found.likelihood_ratio;
  return json;
}

Json alternative_json(const Indistinguishable& each) {
  Json json;
  json["effects"] = Json::array();
  for (const Effect& effect : each.effects) json["effects"].push_back(name_json(effect));
  json["correlation"] = each.correlation;
  json["separate_by"] = each.separate_by;
  return json;
}

Json unexplained_json(const Diagnosis& diagnosis) {
  const Unexplained& unexplained = diagnosis.unexplained;
  Json json = {{"fraction", unexplained.fraction},
               {"means_s", unexplained.means_s},
               {"kind", unexplained.kind},
               {"hint", unexplained.hint}};
  if (unexplained.frequency_hz > 0.0) json["frequency_hz"] = unexplained.frequency_hz;
  if (!unexplained.times_s.empty()) json["times_s"] = unexplained.times_s;
  if (diagnosis.hysteresis) {
    json["channel"] = diagnosis.hysteresis->channel;
    json["half_width"] = diagnosis.hysteresis->half_width;
    json["coefficient"] = diagnosis.hysteresis->coefficient;
  }
  return json;
}

Json delays_json(const std::vector<ReferenceDelay>& delays) {
  Json json = Json::array();
  for (const ReferenceDelay& each : delays) {
    json.push_back({{"capture", each.record}, {"delay_s", each.delay_s}, {"std_error_s", each.std_error_s}});
  }
  return json;
}

std::string percent(double share) {
  return share >= 0.001 ? fmt::format("{:.3g} %", 100.0 * share) : "under 0.1 %";
}

// In the field's units, as on the report's page; a time as in the capture.
std::string value_of(const ModelParameter& parameter) {
  if (parameter.name == kTimeRange) return told_time(parameter.value) + " s";
  const report::FieldUnit field = report::field_unit(parameter.unit);
  const std::string error =
      parameter.std_error > 0.0 ? fmt::format(" ± {:.2g}", parameter.std_error * field.scale) : "";
  return fmt::format("{:.4g}{} {}", parameter.value * field.scale, error, field.unit);
}

std::string effect_lines(const FoundEffect& found, std::size_t number, bool overlap) {
  const Effect& effect = found.effect;
  std::string lines = fmt::format("  {}. {}{}\n     {}\n", number, name_of(effect),
                                  effect.shown_only ? " (shown, not subtracted)" : "", effect.meaning);
  for (const ModelParameter& parameter : report::shown_parameters(found)) {
    lines += fmt::format("     {:<18} {}\n", report::parameter_words(parameter.name), value_of(parameter));
  }
  if (!effect.table_x.empty()) lines += fmt::format("     a table of {} knots\n", effect.table_x.size());
  lines += fmt::format("     {} {} of the {} variance; by chance: {}\n",
                       overlap ? "alone, overlapping with other parts," : "explains",
                       percent(found.variance_explained), effect.shown_only ? "rate's" : "error's",
                       report::probability(found.p_value));
  return lines;
}

// A record may have many lines, and they are not corrected.
std::string line_in_words(const FoundEffect& found, std::size_t number) {
  std::string words = fmt::format("  {}. line, not corrected:", number);
  for (const ModelParameter& parameter : report::shown_parameters(found))
    if (parameter.name != "phase") words += " " + value_of(parameter) + ",";
  return words + fmt::format(" {} of the error's variance\n", percent(found.variance_explained));
}

std::string figure_lines(const Diagnosis& diagnosis) {
  std::string lines = fmt::format("  {:<46} {:>12} {:>12}\n", "", "before", "after");
  for (const std::string& key : report::in_reading_order(diagnosis.before)) {
    const auto after = diagnosis.after.find(key);
    if (after == diagnosis.after.end()) continue;
    const report::Figure figure = report::figure(key);
    lines += fmt::format("  {:<46} {:12.4g} {:12.4g} {}\n", figure.label,
                         diagnosis.before.at(key) * figure.scale, after->second * figure.scale, figure.unit);
  }
  return lines;
}

std::string noise_line(const NoiseTerms& noise, const NoiseTerms& error) {
  std::string line;
  for (const report::NamedCoefficient& named : report::named_coefficients()) {
    const std::optional<double>&value = noise.*named.term, &sigma = error.*named.term;
    if (!value) continue;
    line +=
        std::string(line.empty() ? "" : ", ") + named.meaning + fmt::format(" {:.3g}", *value * named.factor);
    if (sigma) line += fmt::format(" ± {:.2g}", *sigma * named.factor);
    line += std::string(" ") + named.unit;
  }
  if (line.empty()) return "Noise: no terms that this record shows\n";
  if (!noise.B && !noise.K) line += ", no bias instability or random walk that this record shows";
  return "Noise: " + line + "\n";
}

}  // namespace

Json diagnosis_json(const std::vector<AxisDiagnosis>& axes) {
  const Diagnosis& first = axes.front().diagnosis;
  Json json;
  json["schema"] = "ifog.diagnosis/1";
  json["samples"] = first.samples;
  json["sample_rate_hz"] = first.sample_rate_hz;
  const auto put = [&](const char* key, auto&& make) {
    if (axes.size() == 1) {
      json[key] = make(first);
      return;
    }
    json[key] = Json::object();
    for (const AxisDiagnosis& each : axes) json[key][each.axis] = make(each.diagnosis);
  };
  // All axes in one list; with several axes each entry has its axis.
  const auto list = [&](const char* key, auto items, auto&& make) {
    json[key] = Json::array();
    for (const AxisDiagnosis& each : axes)
      for (const auto& item : each.diagnosis.*items) {
        json[key].push_back(make(item));
        if (!each.axis.empty()) json[key].back()["axis"] = each.axis;
      }
  };
  put("noise", [](const Diagnosis& d) {
    Json noise = noise_terms_json(d.noise);
    noise["std_error"] = noise_terms_json(d.noise_error);
    noise["gauss_markov"] = report::markov_json(d.markov);
    return noise;
  });
  list("noise_changes", &Diagnosis::noise_changes, [](const NoiseChangeIn& found) {
    Json change = report::noise_changes_json({&found.change, 1})[0];
    change["capture"] = found.capture;
    return change;
  });
  list("effects", &Diagnosis::effects, [](const FoundEffect& found) { return effect_json(found); });
  put("bias", [](const Diagnosis& d) {
    return d.bias ? Json{{"value", d.bias->value}, {"std_error", d.bias->std_error}, {"unit", "rad/s"}}
                  : Json(nullptr);
  });
  put("before", [](const Diagnosis& d) { return Json(d.before); });
  put("after", [](const Diagnosis& d) { return Json(d.after); });
  list("indistinguishable", &Diagnosis::indistinguishable,
       [](const Indistinguishable& pair) { return alternative_json(pair); });
  put("unexplained", [](const Diagnosis& d) { return unexplained_json(d); });
  put("heading_prediction", [](const Diagnosis& d) {
    return Json{{"aligned_s", d.heading.aligned_s},
                {"after_s", d.heading.after_s},
                {"sigma_rad", d.heading.sigma_rad}};
  });
  put("reference_delay", [](const Diagnosis& d) { return delays_json(d.reference_delays); });
  put("channel_delays", [](const Diagnosis&) { return Json::array(); });  // a key that was promised
  json["remarks"] = Json::array();
  for (const AxisDiagnosis& each : axes)
    for (const std::string& remark : each.diagnosis.remarks)
      json["remarks"].push_back(each.axis.empty() ? remark : each.axis + ": " + remark);
  return json;
}

std::string diagnosis_text(const AxisDiagnosis& axis) {
  const Diagnosis& diagnosis = axis.diagnosis;
  std::string report;
  if (!axis.axis.empty()) report += "Axis " + axis.axis + "\n";
  report += fmt::format("{} samples at {:.4g} Hz\n", diagnosis.samples, diagnosis.sample_rate_hz);
  report += noise_line(diagnosis.noise, diagnosis.noise_error);
  if (diagnosis.effects.empty() && diagnosis.hysteresis) {
    report += "\nFound: nothing that a correction could take away; see what stays unexplained.\n";
  } else if (diagnosis.effects.empty()) {
    report += "\nFound: nothing. No channel, line or jump explains more of this error than noise would.\n";
  } else {
    report += "\nFound:\n";
    for (std::size_t i = 0; i < diagnosis.effects.size(); ++i) {
      const FoundEffect& found = diagnosis.effects[i];
      report += found.effect.form == "line" ? line_in_words(found, i + 1)
                                            : effect_lines(found, i + 1, report::parts_overlap(diagnosis));
    }
  }
  if (diagnosis.bias)
    report += fmt::format("\nBias against the reference: {:.4g} ± {:.2g} °/h, corrected by the model\n",
                          diagnosis.bias->value / kDegreePerHour, diagnosis.bias->std_error / kDegreePerHour);
  report += "\nError, the worse of full-data and held-out error:\n" + figure_lines(diagnosis);
  if (!diagnosis.indistinguishable.empty()) report += "\nCannot be distinguished on this data:\n";
  for (const Indistinguishable& pair : diagnosis.indistinguishable) {
    for (std::size_t i = 0; i < pair.effects.size(); ++i)
      report += (i ? "  or  " : "  ") + name_of(pair.effects[i]);
    report += fmt::format("\n     correlation {:.3f}; would tell: {}\n", pair.correlation, pair.separate_by);
  }
  if (diagnosis.unexplained.kind == "nothing")
    report += "\nNothing more is found in the rest.\n";
  else
    report += fmt::format("\nUnexplained: {} of the variance of {}", percent(diagnosis.unexplained.fraction),
                          diagnosis.unexplained.means_s * diagnosis.sample_rate_hz < 1.5
                              ? "single samples"
                              : fmt::format("{:.3g} s means", diagnosis.unexplained.means_s)) +
              " (" + diagnosis.unexplained.kind + ")\n  " + diagnosis.unexplained.hint + "\n";
  if (!diagnosis.heading.after_s.empty()) {
    report += fmt::format("\nNext capture, bias averaged over {:.3g} s at rest: heading error ({})",
                          diagnosis.heading.aligned_s,
                          diagnosis.heading.at_most
                              ? "at most: with a random walk that this record does not exclude"
                              : "1 sigma");
    for (std::size_t i = 0; i < diagnosis.heading.after_s.size(); ++i) {
      report += fmt::format("{} {:.3g}° after {:.4g} s", i ? "," : "",
                            diagnosis.heading.sigma_rad[i] / kDegree, diagnosis.heading.after_s[i]);
    }
    report += "\n";
  }
  for (const std::string& remark : diagnosis.remarks) report += "Note: " + remark + "\n";
  return report;
}

}  // namespace ifog::tools
