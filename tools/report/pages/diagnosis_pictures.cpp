// SPDX-License-Identifier: Apache-2.0
#include "tools/report/pages/diagnosis_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "filters/units/field_units.h"
#include "tools/report/chart.h"
#include "tools/report/pages/account.h"
#include "tools/report/pages/section.h"
#include "tools/report/pages/traced.h"
#include "tools/report/pages/words.h"
#include "tools/report/text.h"
#include "tools/report/time_axis.h"

namespace ifog::report {
namespace {

using Series = std::vector<double>;

// Minus the mean, which is the switch-on bias.
Series centred(Series x, double scale) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const double value : x)
    if (std::isfinite(value)) sum += value, ++count;
  for (double& value : x)
    value = (value - sum / static_cast<double>(std::max<std::size_t>(count, 1))) * scale;
  return x;
}

// Times as in the captures' columns.
Series shown_times(const DiagnosisSeries& s) {
  Series shown = s.time_s;
  for (double& time : shown) time = s.origin.in_s(time);
  return shown;
}

// "in 1 s means": the series are block means, so that they can be drawn.
std::string block_words(const DiagnosisSeries& s) {
  if (s.time_s.size() < 2) return "";
  return duration(s.time_s[1] - s.time_s[0]) + " means";
}

}  // namespace

std::string time_picture(const Diagnosis& d) {
  const DiagnosisSeries& s = d.series;
  if (s.time_s.empty()) return "";
  const TimeAxis time(s.origin.in_s(s.time_s.front()), s.origin.in_s(s.time_s.back()));
  Chart chart("The error over time, before and after", account_of_change(d, "rms_10s_radps"),
              {time.label(), false, {}, {}}, {"error (°/h)", false, {}, {}});
  const Series t = time(shown_times(s));
  chart.line(Role::kBefore, "before", t, centred(s.before_radps, 1.0 / kDegreePerHour));
  if (!d.effects.empty()) chart.line(Role::kAfter, "after", t, centred(s.after_radps, 1.0 / kDegreePerHour));
  // Bursts are clustered; labels are drawn where there is space.
  double named = -1e300;
  for (const double burst : d.unexplained.times_s) {
    const bool room = burst - named > 0.1 * (s.time_s.back() - s.time_s.front());
    chart.mark_x(time(burst), room ? "burst" : "");
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
  return figure_html(chart.svg(), "Its spectrum. A line is a peak; slow noise rises to the left.");
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
                     "samples, without all other effects.");
}

std::string contribution_picture(const Diagnosis& d, std::size_t index) {
  const DiagnosisSeries& s = d.series;
  if (index >= s.contribution_radps.size() || s.contribution_radps[index].size() != s.time_s.size())
    return "";
  if (s.time_s.empty()) return "";
  const TimeAxis time(s.origin.in_s(s.time_s.front()), s.origin.in_s(s.time_s.back()));
  const Series t = time(shown_times(s));
  const Series& part = s.contribution_radps[index];
  const Series effect = centred(part, 1.0), after = centred(s.after_radps, 1.0);
  Series with(effect), drawn(effect);
  for (std::size_t k = 0; k < with.size(); ++k) {
    with[k] += after[k];
    if (std::isnan(with[k])) drawn[k] = with[k];  // no data in a gap of the error
  }
  std::size_t turns = 0;  // an effect faster than a pixel is only a filled band
  for (std::size_t k = 2; k < part.size(); ++k)
    if ((effect[k] - effect[k - 1]) * (effect[k - 1] - effect[k - 2]) < 0.0) ++turns;
  if (turns > 250 && turns > part.size() / 3) return "";
  Chart chart("The effect over time", "The error without the other effects, and this effect's part of it.",
              {time.label(), false, {}, {}}, {"error (°/h)", false, {}, {}});
  chart.line(Role::kBefore, "measured", t, scaled(with, 1.0 / kDegreePerHour));
  chart.line(Role::kFit, "fitted", t, scaled(drawn, 1.0 / kDegreePerHour));
  return figure_html(chart.svg(480, 320), "The same over time, " + block_words(s) + ".");
}

std::string heading_picture(const HeadingPrediction& h) {
  if (h.after_s.empty()) return "";
  const TimeUnit unit = time_unit(h.after_s.back());
  Chart chart("Predicted heading error of the next capture",
              "Standard deviation of the heading error over time.",
              {std::string("time since the alignment (") + unit.name + ")", false, 0.0, {}},
              {"heading error, 1 σ (°)", false, 0.0, {}});
  chart.line(Role::kAfter, "", scaled(h.after_s, 1.0 / unit.seconds), scaled(h.sigma_rad, 1.0 / kDegree));
  return figure_html(chart.svg(720, 260),
                     "Expected heading error of the next capture, one standard deviation.");
}

}  // namespace ifog::report
