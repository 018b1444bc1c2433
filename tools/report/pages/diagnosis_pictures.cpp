// SPDX-License-Identifier: Apache-2.0
#include "tools/report/pages/diagnosis_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "filters/diagnosis/record/compensated_error.h"
#include "filters/effects/meaning.h"
#include "filters/effects/shape.h"
#include "filters/units/field_units.h"
#include "tools/report/chart.h"
#include "tools/report/pages/section.h"
#include "tools/report/pages/words.h"
#include "tools/report/scale.h"
#include "tools/report/text.h"

namespace ifog::report {
namespace {

using Series = std::vector<double>;

// Subtracts the mean, which is the switch-on bias.
template <typename Values>
void centre(Values& x) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const double value : x)
    if (std::isfinite(value)) sum += value, ++count;
  for (double& value : x) value -= sum / static_cast<double>(std::max<std::size_t>(count, 1));
}

Series centred(Series x, double scale) {
  centre(x);
  return scaled(std::move(x), scale);
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

using Trace = Samples;

std::span<const double> column(const Record& record, const std::string& name) {
  if (is_reference_rate(name)) return record.reference_radps;
  for (const RecordChannel& c : record.channels)
    if (c.name == name) return c.values;
  return {};
}

// Time step before a sample; the first one has that of its neighbour.
double step_s(const Record& r, std::size_t k) {
  return r.time_s[std::max<std::size_t>(k, 1)] - r.time_s[std::max<std::size_t>(k, 1) - 1];
}

// The error minus all effects except one, minus its mean.
Trace error_without(const Record& record, const Diagnosis& diagnosis, std::size_t kept) {
  Model others;
  for (std::size_t i = 0; i < diagnosis.effects.size(); ++i)
    if (i != kept) others.effects.push_back(diagnosis.effects[i].effect);
  for (Effect& e : others.effects) e.axis.clear();
  Trace error = compensated_error(record, others);
  centre(error);
  return error;
}

// The shape's value at each sample, per unit of its coefficient; for a table the channel itself.
Trace abscissa(const Record& record, const Effect& effect) {
  const bool table = form_named(effect.form) == Form::kLookup;
  const std::span<const double> x = column(record, effect.channel),
                                with = column(record, effect.with_channel);
  Trace out(record.rate_radps.size(), std::nan(""));
  if (x.size() != out.size() || (!effect.with_channel.empty() && with.size() != out.size())) return out;
  // A polynomial without a partner is drawn over the channel, so that its curve is visible.
  const bool plain = table || (effect.with_channel.empty() && power_of(*form_named(effect.form)) > 0);
  Shape shape(plain ? ShapeSettings{} : shape_settings(effect));
  Shape partner(effect.with_channel.empty() ? ShapeSettings{} : with_shape_settings(effect));
  double held = std::nan(""), held_with = std::nan("");
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (std::isfinite(x[k])) held = x[k];
    if (plain) {
      out[k] = held;
      continue;
    }
    if (!std::isfinite(held)) continue;
    out[k] = shape.step(held, step_s(record, k));
    if (effect.with_channel.empty()) continue;
    if (std::isfinite(with[k])) held_with = with[k];
    if (std::isfinite(held_with)) out[k] *= partner.step(held_with, step_s(record, k));
  }
  return out;
}

// Angle errors drift with the integrated noise, but little within a few wraps of the channel.
Trace integrated(const Record& record, const Trace& error, const Trace& x, double period) {
  Trace angle(error.size());
  double sum = 0.0;
  for (std::size_t k = 0; k < error.size(); ++k)
    angle[k] = sum += std::isfinite(error[k]) ? error[k] * step_s(record, k) : 0.0;
  std::size_t wraps = 1;
  for (std::size_t k = 1; k < x.size(); ++k)
    if (std::abs(x[k] - x[k - 1]) > 0.5 * period) ++wraps;
  const std::size_t half = std::clamp<std::size_t>(2 * x.size() / wraps, 32, 10000);
  Trace cumulative(angle.size() + 1, 0.0);
  std::partial_sum(angle.begin(), angle.end(), cumulative.begin() + 1);
  Trace out(angle.size());
  for (std::size_t k = 0; k < angle.size(); ++k) {
    const std::size_t from = k > half ? k - half : 0, to = std::min(k + half + 1, angle.size());
    out[k] = angle[k] - (cumulative[to] - cumulative[from]) / static_cast<double>(to - from);
  }
  return out;
}

// Means of x and y in bins of x.
void bin(const Trace& x, const Trace& y, std::size_t bins, Traced& out) {
  Column<std::size_t> order;
  for (std::size_t k = 0; k < x.size(); ++k)
    if (std::isfinite(x[k]) && std::isfinite(y[k])) order.push_back(k);
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  for (std::size_t b = 0; b < std::min(bins, order.size()); ++b) {
    const std::size_t from = b * order.size() / bins, to = std::max(from + 1, (b + 1) * order.size() / bins);
    if (to > order.size()) break;
    double sx = 0.0, sy = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      sx += x[order[i]];
      sy += y[order[i]];
    }
    out.x.push_back(sx / static_cast<double>(to - from));
    out.y.push_back(sy / static_cast<double>(to - from));
  }
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

Traced trace(const std::vector<Record>& records, const Diagnosis& diagnosis, std::size_t index,
             std::size_t bins) {
  Traced out;
  const Effect& effect = diagnosis.effects[index].effect;
  const std::optional<Form> form = form_named(effect.form);
  if (!form || !has_channel(*form) || describes_noise(*form) || effect.channel.empty()) return out;
  out.angle = *form == Form::kLookup && effect.angle;
  Trace all_x, all_y;
  for (const Record& record : records) {
    const Trace x = abscissa(record, effect);
    Trace y = error_without(record, diagnosis, index);
    if (out.angle) y = integrated(record, y, x, effect.period);
    all_x.append(x);
    all_y.append(y);
  }
  bin(all_x, all_y, bins, out);
  if (out.x.size() < 2 || out.x.back() - out.x.front() <= 0.0) return {};
  out.x_label = abscissa_label(effect);
  out.y_label = out.angle ? "angle error (µrad)" : "error (°/h)";

  if (*form == Form::kLookup) {
    out.curve_x = effect.table_x;
    out.curve_y = effect.table_y;
    centre(out.curve_y);
    centre(out.y);
    return out;
  }
  const double size = parameter(effect, "coefficient");
  const bool over_channel = effect.with_channel.empty() && power_of(*form) > 0;
  const Shape shape(over_channel ? shape_settings(effect) : ShapeSettings{});
  const auto fitted = [&](double x) { return size * (over_channel ? shape.at(x) : x); };
  for (int i = 0; i <= 200; ++i) {
    const double x = out.x.front() + (out.x.back() - out.x.front()) * i / 200.0;
    out.curve_x.push_back(x);
    out.curve_y.push_back(fitted(x));
  }
  // The offset is the switch-on bias: the curve is moved to the points.
  double offset = 0.0;
  for (std::size_t i = 0; i < out.x.size(); ++i)
    offset += (out.y[i] - fitted(out.x[i])) / static_cast<double>(out.x.size());
  for (double& value : out.curve_y) value += offset;
  return out;
}

}  // namespace ifog::report
