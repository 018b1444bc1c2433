// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/diagnose/sensor_diagnosis.h"

#include <fmt/core.h>

#include "filters/effects/form.h"
#include "filters/effects/meaning.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"
#include "tools/report/coefficients.h"
#include "tools/report/pages/words.h"

namespace ifog::tools {
namespace {

std::string percent(double share) {
  return share >= 0.001 ? fmt::format("{:.3g} %", 100.0 * share) : "under 0.1 %";
}

// In the field's units, as on the report's page; a time as in the capture.
std::string value_of(const ModelParameter& parameter) {
  if (parameter.name == kTimeRange) return told_time(parameter.value) + " s";
  const report::FieldUnit field = report::field_unit(parameter.unit);
  return fmt::format("{:.4g} ± {:.2g} {}", parameter.value * field.scale, parameter.std_error * field.scale,
                     field.unit);
}

std::string effect_lines(const FoundEffect& found, std::size_t number, bool overlap) {
  const Effect& effect = found.effect;
  std::string lines = fmt::format("  {}. {}{}\n     {}\n", number, name_of(effect),
                                  effect.shown_only ? " (shown, not subtracted)" : "", effect.meaning);
  for (const ModelParameter& parameter : report::shown_parameters(found)) {
    std::string name = parameter.name;
    for (char& c : name) c = c == '_' ? ' ' : c;
    if (name.ends_with(" s")) name.resize(name.size() - 2);
    if (name.ends_with(" hz")) name.resize(name.size() - 3);
    lines += fmt::format("     {:<18} {}\n", name, value_of(parameter));
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
    report += fmt::format("\nUnexplained: {} of the variance of {:.3g} s means",
                          percent(diagnosis.unexplained.fraction), diagnosis.unexplained.means_s) +
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
