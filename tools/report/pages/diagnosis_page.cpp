// SPDX-License-Identifier: Apache-2.0
#include "tools/report/pages/diagnosis_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "drivers/system/shell_word.h"
#include "filters/model_file/form.h"
#include "filters/model_file/toml_text.h"
#include "filters/units/field_units.h"
#include "tools/report/coefficients.h"
#include "tools/report/pages/diagnosis_pictures.h"
#include "tools/report/pages/section.h"
#include "tools/report/pages/words.h"
#include "tools/report/text.h"

namespace ifog::report {
namespace {

std::string parameter_rows(const FoundEffect& found) {
  std::string out;
  for (const ModelParameter& p : shown_parameters(found)) {
    const FieldUnit unit = field_unit(p.unit);
    out += row(escaped(parameter_words(p.name)),
               {number_cell(with_error(p.value * unit.scale, p.std_error * unit.scale)), escaped(unit.unit)});
  }
  return out;
}

std::string effect_section(const PageAxis& axis, std::size_t index) {
  const FoundEffect& found = axis.diagnosis->effects[index];
  std::string out = "<h3>" + std::to_string(index + 1) + ". " + escaped(effect_words(found.effect)) +
                    "</h3>\n<p>" + escaped(sentence(found.effect.meaning)) +
                    " Chance of such a find in noise alone, after correction "
                    "for everything tried: " +
                    probability(found.p_value) + ". Share of the error's variance" +
                    (parts_overlap(*axis.diagnosis) ? ", alone, overlapping with other parts: " : ": ") +
                    number(100.0 * found.variance_explained, 3) + " %.</p>\n";
  out += table("Parameters, with their standard errors", {"parameter", number_cell("value"), "unit"},
               parameter_rows(found));
  return out + "<div class=\"pair\">\n" + traced_picture(axis, index) +
         contribution_picture(*axis.diagnosis, index) + "</div>\n";
}

std::string figures_table(const Diagnosis& d) {
  std::string rows;
  for (const std::string& key : in_reading_order(d.before)) {
    const double before = d.before.at(key);
    const auto at = d.after.find(key);
    const double after = at == d.after.end() ? std::nan("") : at->second;
    const Figure f = figure(key);
    const double change = 100.0 * (after / before - 1.0);
    const bool relative = key != "whiteness" && std::isfinite(change);
    const std::string shown =
        !relative ? "" : (std::abs(change) < 0.05 ? "0" : (change > 0 ? "+" : "") + number(change, 2)) + " %";
    rows += row(escaped(f.label),
                {number_cell(number(before * f.scale)), number_cell(number(after * f.scale)), f.unit,
                 Cell(shown, relative && change < -0.5 ? Cell::Kind::better : Cell::Kind::number)});
  }
  return table("The larger of full-data and held-out error",
               {"figure", number_cell("before"), number_cell("after"), "unit", number_cell("change")}, rows);
}

// The figure with the largest gain comes first.
std::string tiles(const Diagnosis& d) {
  std::string out;
  std::array keys{"residual_rms_radps", "rms_10s_radps", "adev_1s_radps", "heading_drift_rad"};
  const auto left = [&](const char* key) {
    const auto before = d.before.find(key), after = d.after.find(key);
    const bool known = before != d.before.end() && after != d.after.end() && before->second > 0.0;
    return known ? after->second / before->second : std::numeric_limits<double>::infinity();
  };
  std::ranges::stable_sort(keys, [&](const char* a, const char* b) { return left(a) < left(b); });
  for (const char* key : keys) {
    const auto before = d.before.find(key), after = d.after.find(key);
    if (before == d.before.end() || after == d.after.end() || !std::isfinite(before->second)) continue;
    const Figure f = figure(key);
    out += "<div class=\"tile\"><b>" + number(before->second * f.scale) + " → " +
           number(after->second * f.scale) + "\u00a0" + f.unit + "</b><span>" + escaped(f.label) +
           "</span></div>\n";
  }
  return out.empty() ? "" : "<div class=\"tiles\">\n" + out + "</div>\n";
}

std::string confusable_list(const Diagnosis& d) {
  if (d.effects.empty()) return "<p>Nothing was found, so there is nothing to tell apart.</p>\n";
  if (d.indistinguishable.empty())
    return "<p>Every effect named here differs from its rivals by more than this capture's noise.</p>\n";
  std::string out = "<ul>\n";
  for (const Indistinguishable& group : d.indistinguishable) {
    out += "<li>";
    for (std::size_t i = 0; i < group.effects.size(); ++i)
      out += (i == 0   ? "<strong>"
              : i == 1 ? " cannot be distinguished from <strong>"
                       : " or <strong>") +
             escaped(effect_words(group.effects[i])) + "</strong>";
    out += " here (correlation after whitening " + number(group.correlation) + "). " +
           (group.separate_by.empty() ? "" : "What would tell: " + escaped(sentence(group.separate_by))) +
           "</li>\n";
  }
  return out + "</ul>\n";
}

std::string noise_table(const NoiseTerms& noise) {
  std::string out;
  for (const NamedCoefficient& named : named_coefficients()) {
    const std::optional<double>& value = noise.*named.term;
    out += row(std::string(named.meaning) + " " + named.letter,
               {number_cell(value ? number(*value * named.factor) : "not seen"), value ? named.unit : ""});
  }
  return table("Noise after the effects (IEEE Std 952 terms)", {"term", number_cell("value"), "unit"}, out);
}

std::string heading_words(const HeadingPrediction& h) {
  if (h.after_s.empty()) return "";
  return "<p>With the bias averaged over the first " + duration(h.aligned_s) +
         " at rest and held, this sensor is expected "
         "to be " +
         number(h.sigma_rad.back() / kDegree, 2) + "° off (1 σ) after " + duration(h.after_s.back()) +
         ".</p>\n";
}

std::string remaining(const Diagnosis& d) {
  std::string out = "<p>" + account_of_rest(d) + "</p>\n";
  if (!d.remarks.empty()) {
    out += "<ul>\n";
    for (const std::string& remark : d.remarks) out += "<li>" + escaped(sentence(remark)) + "</li>\n";
    out += "</ul>\n";
  }
  return out + noise_table(d.noise) + heading_words(d.heading) + heading_picture(d.heading);
}

// Commands are quoted for a shell, the configuration's line for TOML.
std::string applying(const Page& page) {
  const std::string path = page.model_path.empty() ? "model.toml" : page.model_path;
  const std::string model = escaped(shell_file(path)), read_with = escaped(page.read_with);
  const std::string capture =
      escaped(shell_file(page.captures.empty() ? "capture.csv" : page.captures.front()));
  std::string out;
  if (page.model_path.empty())
    out += "<p>No model file was written in this run. To write one:</p>\n<pre>ifog diagnose " + capture +
           read_with + " --write-model " + model + "</pre>\n";
  return out + "<p>Offline, with the same causal code that the daemon runs:</p>\n<pre>ifog denoise " +
         capture + read_with + " --model " + model +
         " --output corrected.csv</pre>\n"
         "<p>In the daemon: name the file in the sensor's section of the configuration, check, and reload. "
         "No sample is lost.</p>\n<pre>[[sensor]]\nmodel = " +
         escaped(toml_quoted(path)) +
         "\n\nifogd --config /etc/ifogd/ifogd.toml --check\n"
         "systemctl reload ifogd</pre>\n"
         "<p>And when you have the next capture, ask whether the model still holds:</p>\n<pre>ifog diagnose "
         "next.csv" +
         read_with + " --model " + model + "</pre>\n";
}

// Information needed to check the page.
std::string origin(const Page& page) {
  std::string out;
  if (!page.command.empty()) out += "<p>Made by</p>\n<pre>" + escaped(page.command) + "</pre>\n";
  std::string rows;
  for (const Page::Input& input : page.inputs) {
    std::string said;
    constexpr std::size_t kMostComments = 4;
    for (std::size_t i = 0; i < std::min(kMostComments, input.comments.size()); ++i)
      said += (said.empty() ? "" : "<br>") + escaped(input.comments[i]);
    rows += row(escaped(input.name), {said, "<code>" + escaped(input.sha256) + "</code>"});
  }
  return out + table("Captures",
                     {"file", "what it says of itself (sensor, serial number)", "SHA-256, unpacked"}, rows,
                     "origin");
}

std::string axis_sections(const PageAxis& axis) {
  const Diagnosis& d = *axis.diagnosis;
  const std::string id = axis.axis.empty() ? "" : "-" + escaped(axis.axis);
  const std::string of = axis.axis.empty() ? "" : ", axis " + escaped(axis.axis);
  std::string out =
      section("account" + id, "In short" + of,
              "<div class=\"account\">" + account(d) + "</div>\n" + (d.effects.empty() ? "" : tiles(d)));
  out += section("residual" + id, d.effects.empty() ? "The error" + of : "The error before and after" + of,
                 time_picture(d) + allan_picture(d) + spectrum_picture(d));
  std::string effects;
  for (std::size_t i = 0; i < d.effects.size(); ++i) effects += effect_section(axis, i);
  const char* none = d.hysteresis
                         ? "<p>No effect that a correction could take away; see what remains.</p>\n"
                         : "<p>No effect passed. The error is what the noise below makes of it.</p>\n";
  out += section("effects" + id, "What was found" + of, effects.empty() ? none : effects);
  out += section("figures" + id, "Before and after in figures" + of, figures_table(d));
  out += section("confusable" + id, "What cannot be distinguished" + of, confusable_list(d));
  out += section("remaining" + id, "What remains" + of, remaining(d));
  return out;
}

std::string contents(const Page& page) {
  std::string out = "<nav aria-label=\"Contents\"><ul>\n";
  for (const PageAxis& axis : page.axes) {
    const std::string id = axis.axis.empty() ? "" : "-" + escaped(axis.axis);
    const std::string of = axis.axis.empty() ? "" : " " + escaped(axis.axis);
    for (const auto& [name, words] : {std::pair{"account", "In short"},
                                      {"residual", "The error"},
                                      {"effects", "What was found"},
                                      {"figures", "Figures"},
                                      {"confusable", "Indistinguishable"},
                                      {"remaining", "What remains"}})
      out += std::string("<li><a href=\"#") + name + id + "\">" + words + of + "</a></li>\n";
  }
  return out + std::string("<li><a href=\"#apply\">Applying it</a></li>\n") +
         (page.inputs.empty() && page.command.empty()
              ? ""
              : "<li><a href=\"#origin\">Where it comes from</a></li>\n") +
         "</ul></nav>\n";
}

}  // namespace

std::string diagnosis_page(const Page& page) {
  std::string names;
  for (const std::string& capture : page.captures) names += (names.empty() ? "" : ", ") + escaped(capture);
  std::string size;
  if (!page.axes.empty()) {
    const Diagnosis& d = *page.axes.front().diagnosis;
    size = std::to_string(d.samples) + " samples at " + number(d.sample_rate_hz, 4) + " Hz, " +
           duration(static_cast<double>(d.samples) / d.sample_rate_hz) + " in all";
  }
  std::string body = contents(page);
  for (const PageAxis& axis : page.axes) body += axis_sections(axis);
  body += section("apply", "Applying it", applying(page));
  body += section("origin", "Where it comes from", origin(page));
  return whole_page(
      "Diagnosis of " + escaped(page.sensor), names + " · " + size, body,
      "Made " + escaped(page.made) +
          ". Rates in °/h; the model file is in SI units. Standard errors are one sigma. Under the "
          "pointer a picture shows its values; draw over a stretch to look closer, twice on it "
          "for the whole; arrow keys, + and − do the same.");
}

}  // namespace ifog::report
