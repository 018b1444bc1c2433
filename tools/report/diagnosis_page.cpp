// SPDX-License-Identifier: Apache-2.0
#include "tools/report/diagnosis_page.h"

#include <algorithm>
#include <cmath>

#include "filters/effects/form.h"
#include "filters/units/field_units.h"
#include "tools/report/account.h"
#include "tools/report/chart.h"
#include "tools/report/interaction.h"
#include "tools/report/style.h"
#include "tools/report/text.h"
#include "tools/report/traced.h"
#include "tools/report/words.h"

namespace ifog::report {
namespace {

using Series = std::vector<double>;

// About its mean, which is the switch-on bias.
Series centred(Series x, double scale) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const double value : x)
    if (std::isfinite(value)) sum += value, ++count;
  for (double& value : x)
    value = (value - sum / static_cast<double>(std::max<std::size_t>(count, 1))) * scale;
  return x;
}

std::string figure_html(const std::string& svg, const std::string& caption) {
  if (svg.empty()) return "";
  return "<figure>\n" + svg + "<figcaption>" + caption + "</figcaption>\n</figure>\n";
}

std::string section(const std::string& id, const std::string& heading, const std::string& body) {
  if (body.empty()) return "";
  return "<section aria-labelledby=\"" + id + "\">\n<h2 id=\"" + id + "\">" + heading + "</h2>\n" + body +
         "</section>\n";
}

// From the record's first moment: seconds since 1970 would leave a picture no digits.
Series since_start(const Series& time_s, const TimeUnit& unit) {
  Series out;
  for (const double t : time_s) out.push_back((t - time_s.front()) / unit.seconds);
  return out;
}

// "in 1 s means": the series are block means of whatever length kept them drawable.
std::string block_words(const DiagnosisSeries& s) {
  if (s.time_s.size() < 2) return "";
  return duration(s.time_s[1] - s.time_s[0]) + " means";
}

std::string time_picture(const Diagnosis& d) {
  const DiagnosisSeries& s = d.series;
  if (s.time_s.empty()) return "";
  const TimeUnit unit = time_unit(s.time_s.back() - s.time_s.front());
  Chart chart("The error over time, before and after", account_of_change(d, "rms_10s_radps"),
              {std::string("time (") + unit.name + ")", false, {}, {}}, {"error (°/h)", false, {}, {}});
  const Series t = since_start(s.time_s, unit);
  chart.line(Role::kBefore, "before", t, centred(s.before_radps, 1.0 / kDegreePerHour));
  if (!d.effects.empty()) chart.line(Role::kAfter, "after", t, centred(s.after_radps, 1.0 / kDegreePerHour));
  // Bursts come in clusters: a word where there is room for one.
  double named = -1e300;
  for (const double burst : d.unexplained.times_s) {
    const bool room = burst - named > 0.1 * (s.time_s.back() - s.time_s.front());
    chart.mark_x((burst - s.time_s.front()) / unit.seconds, room ? "burst" : "");
    if (room) named = burst;
  }
  return figure_html(chart.svg(), "The error, " + block_words(s) + ", about its mean.");
}

std::string spectrum_picture(const Diagnosis& d) {
  const DiagnosisSeries& s = d.series;
  Chart chart("Spectrum of the error, before and after",
              "Amplitude spectral density over frequency, both on logarithmic axes.",
              {"frequency (Hz)", true, {}, {}}, {"density (°/h/√Hz)", true, {}, {}});
  chart.line(Role::kBefore, "before", s.frequency_hz, scaled(s.before_radps_rthz, 1.0 / kDegreePerHour));
  if (!d.effects.empty())
    chart.line(Role::kAfter, "after", s.frequency_hz, scaled(s.after_radps_rthz, 1.0 / kDegreePerHour));
  if (d.unexplained.frequency_hz > 0.0)
    chart.mark_x(d.unexplained.frequency_hz, number(d.unexplained.frequency_hz, 3) + " Hz");
  return figure_html(chart.svg(), "Its spectrum. A line stands up; slow wander rises to the left.");
}

std::string allan_picture(const Diagnosis& d) {
  const DiagnosisSeries& s = d.series;
  Chart chart("Allan deviation, before and after",
              "Allan deviation over averaging time tau, both on logarithmic axes.",
              {"averaging time τ (s)", true, {}, {}}, {"Allan deviation (°/h)", true, {}, {}});
  chart.line(Role::kBefore, "before", s.tau_s, scaled(s.before_adev_radps, 1.0 / kDegreePerHour));
  if (!d.effects.empty())
    chart.line(Role::kAfter, "after", s.tau_s, scaled(s.after_adev_radps, 1.0 / kDegreePerHour));
  if (s.after_adev_low_radps.size() == s.tau_s.size() && s.after_adev_high_radps.size() == s.tau_s.size())
    chart.band(Role::kAfter, s.tau_s, scaled(s.after_adev_low_radps, 1.0 / kDegreePerHour),
               scaled(s.after_adev_high_radps, 1.0 / kDegreePerHour));
  return figure_html(chart.svg(),
                     "Allan deviation, with the interval that holds the true one in 68 % of cases: what is "
                     "left when the rate is averaged over τ. White noise falls by half a decade "
                     "a decade; a slope that ends or a hump is an error the averaging does not remove.");
}

std::string traced_picture(const PageAxis& axis, std::size_t index) {
  const Diagnosis& d = *axis.diagnosis;
  const Effect& effect = d.effects[index].effect;
  const Traced t = trace(axis.records, d, index);
  if (t.x.empty()) return "";
  const double scale = t.angle ? 1e6 : 1.0 / kDegreePerHour;
  Chart chart(
      "The error against " + channel_words(effect.channel) + ", with the fitted effect",
      "Means of the error without the other effects, over " + t.x_label + ", and the effect that was fitted.",
      {t.x_label, false, {}, {}}, {t.y_label, false, {}, {}});
  chart.points(Role::kBefore, "measured", t.x, scaled(t.y, scale));
  chart.line(Role::kFit, "fitted", t.curve_x, scaled(t.curve_y, scale));
  return figure_html(chart.svg(480, 320),
                     "Against what it was traced to: each dot the mean of a ninetieth of the "
                     "samples, all other effects taken away.");
}

std::string contribution_picture(const Diagnosis& d, std::size_t index) {
  const DiagnosisSeries& s = d.series;
  if (index >= s.contribution_radps.size() || s.contribution_radps[index].size() != s.time_s.size())
    return "";
  if (s.time_s.empty()) return "";
  const TimeUnit unit = time_unit(s.time_s.back() - s.time_s.front());
  const Series t = since_start(s.time_s, unit);
  const Series& part = s.contribution_radps[index];
  const Series effect = centred(part, 1.0), after = centred(s.after_radps, 1.0);
  Series with(effect);
  for (std::size_t k = 0; k < with.size(); ++k) with[k] += after[k];
  std::size_t turns = 0;  // an effect faster than a pixel is only a bar of ink
  for (std::size_t k = 2; k < part.size(); ++k)
    if ((effect[k] - effect[k - 1]) * (effect[k - 1] - effect[k - 2]) < 0.0) ++turns;
  if (turns > 250 && turns > part.size() / 3) return "";
  Chart chart("The effect over time", "The error without the other effects, and this effect's part of it.",
              {std::string("time (") + unit.name + ")", false, {}, {}}, {"error (°/h)", false, {}, {}});
  chart.line(Role::kBefore, "measured", t, scaled(with, 1.0 / kDegreePerHour));
  chart.line(Role::kFit, "fitted", t, scaled(effect, 1.0 / kDegreePerHour));
  return figure_html(chart.svg(480, 320), "The same over time, " + block_words(s) + ".");
}

std::string parameter_rows(const Effect& e) {
  std::string out;
  for (const ModelParameter& p : e.parameters) {
    const FieldUnit unit = field_unit(p.unit);
    std::string name = p.name;
    for (const std::string_view suffix : {"_hz", "_s"}) {  // the unit has a column of its own
      if (name.ends_with(suffix)) name.resize(name.size() - suffix.size());
    }
    std::replace(name.begin(), name.end(), '_', ' ');
    out += "<tr><th scope=\"row\">" + escaped(name) + "</th><td class=\"n\">" +
           with_error(p.value * unit.scale, p.std_error * unit.scale) + "</td><td>" + escaped(unit.unit) +
           "</td></tr>\n";
  }
  return out;
}

std::string effect_section(const PageAxis& axis, std::size_t index) {
  const FoundEffect& found = axis.diagnosis->effects[index];
  std::string out =
      "<h3>" + std::to_string(index + 1) + ". " + escaped(effect_words(found.effect)) + "</h3>\n<p>" +
      escaped(sentence(found.effect.meaning)) +
      " Chance of such a find in noise alone, after correction "
      "for everything tried: " +
      probability(found.p_value) + ". Share of the error's variance" +
      (parts_overlap(*axis.diagnosis) ? ", taken alone, beside other parts that overlap with it: " : ": ") +
      number(100.0 * found.variance_explained, 3) + " %.</p>\n";
  out +=
      "<div class=\"scroll\"><table><caption>Parameters, with their standard errors</caption><thead><tr><th "
      "scope=\"col\">parameter</th><th scope=\"col\" class=\"n\">value</th><th "
      "scope=\"col\">unit</th></tr></thead>"
      "<tbody>\n" +
      parameter_rows(found.effect) + "</tbody></table></div>\n";
  return out + "<div class=\"pair\">\n" + traced_picture(axis, index) +
         contribution_picture(*axis.diagnosis, index) + "</div>\n";
}

std::string figures_table(const Diagnosis& d) {
  std::string out =
      "<div class=\"scroll\"><table><caption>By the model as written, or on data held out of the fit: the "
      "larger</caption><thead><tr><th "
      "scope=\"col\">figure</th>"
      "<th scope=\"col\" class=\"n\">before</th><th scope=\"col\" class=\"n\">after</th><th "
      "scope=\"col\">unit</th>"
      "<th scope=\"col\" class=\"n\">change</th></tr></thead><tbody>\n";
  for (const std::string& key : in_reading_order(d.before)) {
    const double before = d.before.at(key);
    const auto at = d.after.find(key);
    const double after = at == d.after.end() ? std::nan("") : at->second;
    const Figure f = figure(key);
    const double change = 100.0 * (after / before - 1.0);
    const bool relative = key != "whiteness" && std::isfinite(change);
    out += "<tr><th scope=\"row\">" + escaped(f.label) + "</th><td class=\"n\">" + number(before * f.scale) +
           "</td><td class=\"n\">" + number(after * f.scale) + "</td><td>" + f.unit + "</td><td class=\"n" +
           (relative && change < -0.5 ? " better" : "") + "\">" +
           (relative ? (std::abs(change) < 0.05 ? "0" : (change > 0 ? "+" : "") + number(change, 2)) + " %"
                     : "") +
           "</td></tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string tiles(const Diagnosis& d) {
  std::string out;
  for (const char* key : {"residual_rms_radps", "rms_10s_radps", "adev_1s_radps", "heading_drift_rad"}) {
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
              : i == 1 ? " cannot be told from <strong>"
                       : " or <strong>") +
             escaped(effect_words(group.effects[i])) + "</strong>";
    out += " here (correlation after whitening " + number(group.correlation) + "). " +
           (group.separate_by.empty() ? "" : "What would tell: " + escaped(sentence(group.separate_by))) +
           "</li>\n";
  }
  return out + "</ul>\n";
}

std::string noise_table(const NoiseTerms& noise) {
  struct Row {
    const char* name;
    std::optional<double> value;
    double scale;
    const char* unit;
  };
  const Row rows[] = {{"quantisation Q", noise.Q, 1e6, "µrad"},
                      {"angle random walk N", noise.N, 1.0 / kDegreePerRootHour, "°/√h"},
                      {"bias instability B", noise.B, 1.0 / kDegreePerHour, "°/h"},
                      {"rate random walk K", noise.K, 1.0 / kDegreePerHourPerRootHour, "°/h/√h"},
                      {"rate ramp R", noise.R, 1.0 / kDegreePerHourPerHour, "°/h/h"}};
  std::string out =
      "<div class=\"scroll\"><table><caption>Noise after the effects (IEEE Std 952 "
      "terms)</caption><thead><tr><th "
      "scope=\"col\">term</th><th scope=\"col\" class=\"n\">value</th><th "
      "scope=\"col\">unit</th></tr></thead><tbody>\n";
  for (const Row& row : rows)
    out += std::string("<tr><th scope=\"row\">") + row.name + "</th><td class=\"n\">" +
           (row.value ? number(*row.value * row.scale) : "not seen") + "</td><td>" +
           (row.value ? row.unit : "") + "</td></tr>\n";
  return out + "</tbody></table></div>\n";
}

std::string heading_picture(const HeadingPrediction& h) {
  if (h.after_s.empty()) return "";
  const TimeUnit unit = time_unit(h.after_s.back());
  Chart chart("Predicted heading error of the next capture",
              "Standard deviation of the heading error over time.",
              {std::string("time since the alignment (") + unit.name + ")", false, 0.0, {}},
              {"heading error, 1 σ (°)", false, 0.0, {}});
  chart.line(Role::kAfter, "", scaled(h.after_s, 1.0 / unit.seconds), scaled(h.sigma_rad, 1.0 / kDegree));
  return "<p>With the bias taken over the first " + duration(h.aligned_s) +
         " at rest and held, this sensor is expected "
         "to be " +
         number(h.sigma_rad.back() / kDegree, 2) + "° off (1 σ) after " + duration(h.after_s.back()) +
         ".</p>\n" +
         figure_html(chart.svg(720, 260),
                     "Expected heading error of the next capture, one standard deviation.");
}

std::string remaining(const Diagnosis& d) {
  std::string out = "<p>" + account_of_rest(d) + "</p>\n";
  if (!d.remarks.empty()) {
    out += "<ul>\n";
    for (const std::string& remark : d.remarks) out += "<li>" + escaped(sentence(remark)) + "</li>\n";
    out += "</ul>\n";
  }
  return out + noise_table(d.noise) + heading_picture(d.heading);
}

std::string applying(const Page& page) {
  const std::string model = page.model_path.empty() ? "model.toml" : page.model_path;
  std::string capture = page.captures.empty() ? "capture.csv" : page.captures.front();
  std::string out;
  if (page.model_path.empty())
    out += "<p>No model file was written in this run. To write one:</p>\n<pre>ifog diagnose " +
           escaped(capture) + " --write-model " + model + "</pre>\n";
  out += "<p>Offline, with the same causal code that the daemon runs:</p>\n<pre>ifog denoise " +
         escaped(capture) + " --model " + escaped(model) +
         " --output corrected.csv</pre>\n"
         "<p>In the daemon: name the file in the sensor's section of the configuration, check, and reload. "
         "No sample is "
         "lost.</p>\n<pre>[[sensor]]\nmodel = \"" +
         escaped(model) +
         "\"\n\nifogd --config /etc/ifogd/ifogd.toml --check\n"
         "systemctl reload ifogd</pre>\n"
         "<p>And when the next capture is there, ask whether the model still holds:</p>\n<pre>ifog diagnose "
         "next.csv --model " +
         escaped(model) + "</pre>\n";
  return out;
}

// What would be asked for first if somebody doubted the page.
std::string origin(const Page& page) {
  std::string out;
  if (!page.command.empty()) out += "<p>Made by</p>\n<pre>" + escaped(page.command) + "</pre>\n";
  std::string rows;
  for (const Page::Input& input : page.inputs) {
    std::string said;
    constexpr std::size_t kMostComments = 4;
    for (std::size_t i = 0; i < std::min(kMostComments, input.comments.size()); ++i)
      said += (said.empty() ? "" : "<br>") + escaped(input.comments[i]);
    rows += "<tr><th scope=\"row\">" + escaped(input.name) + "</th><td>" + said + "</td><td><code>" +
            escaped(input.sha256) + "</code></td></tr>\n";
  }
  if (rows.empty()) return out;
  return out +
         "<div class=\"scroll\"><table class=\"origin\"><caption>Captures</caption><thead><tr><th "
         "scope=\"col\">file</th><th scope=\"col\">what it says of itself (sensor, serial number)</th><th "
         "scope=\"col\">SHA-256, unpacked</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n";
}

std::string axis_sections(const Page& page, const PageAxis& axis) {
  const Diagnosis& d = *axis.diagnosis;
  const std::string id = axis.axis.empty() ? "" : "-" + axis.axis;
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
  out += section("confusable" + id, "What cannot be told apart" + of, confusable_list(d));
  out += section("remaining" + id, "What remains" + of, remaining(d));
  (void)page;
  return out;
}

std::string contents(const Page& page) {
  std::string out = "<nav aria-label=\"Contents\"><ul>\n";
  for (const PageAxis& axis : page.axes) {
    const std::string id = axis.axis.empty() ? "" : "-" + axis.axis;
    const std::string of = axis.axis.empty() ? "" : " " + escaped(axis.axis);
    for (const auto& [name, words] : {std::pair{"account", "In short"},
                                      {"residual", "The error"},
                                      {"effects", "What was found"},
                                      {"figures", "Figures"},
                                      {"confusable", "Not told apart"},
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
  const std::string title = "Diagnosis of " + escaped(page.sensor);
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light "
      "dark\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>" +
      title + "</title>\n<style>" + page_style() + "</style>\n</head>\n<body>\n<main>\n<h1>" + title +
      "</h1>\n<p class=\"sub\">" + names + " · " + size + "</p>\n" + contents(page);
  for (const PageAxis& axis : page.axes) out += axis_sections(page, axis);
  out += section("apply", "Applying it", applying(page));
  out += section("origin", "Where it comes from", origin(page));
  out +=
      "<footer>Made " + escaped(page.made) +
      ". Rates in °/h; the model file is in SI units. Standard errors are one "
      "sigma. Under the pointer a picture shows its values; draw over a stretch to look closer, twice on it "
      "for the whole; arrow keys, + and − do the same.</footer>\n</main>\n<script>" +
      page_script() + "</script>\n</body>\n</html>\n";
  return out;
}

}  // namespace ifog::report
