// SPDX-License-Identifier: Apache-2.0
#include "tools/report/pages/traced.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "filters/diagnosis/record/compensated_error.h"
#include "filters/effects/meaning.h"
#include "filters/effects/shape.h"
#include "tools/report/pages/words.h"

namespace ifog::report {
namespace {

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
  double sum = 0.0;
  std::size_t count = 0;
  for (const double value : error) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  for (double& value : error) value -= sum / static_cast<double>(std::max<std::size_t>(count, 1));
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
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
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

double mean(std::span<const double> x) {
  return x.empty() ? 0.0 : std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

}  // namespace

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
    const double level = mean(out.curve_y);
    for (double& value : out.curve_y) value -= level;
    const double middle = mean(out.y);
    for (double& value : out.y) value -= middle;
    return out;
  }
  const double size = parameter(effect, "coefficient");
  const bool over_channel = effect.with_channel.empty() && power_of(*form) > 0;
  const Shape shape(over_channel ? shape_settings(effect) : ShapeSettings{});
  for (int i = 0; i <= 200; ++i) {
    const double x = out.x.front() + (out.x.back() - out.x.front()) * i / 200.0;
    out.curve_x.push_back(x);
    out.curve_y.push_back(size * (over_channel ? shape.at(x) : x));
  }
  // The offset is the switch-on bias: the curve is moved to the points.
  double offset = 0.0;
  for (std::size_t i = 0; i < out.x.size(); ++i)
    offset += (out.y[i] - size * (over_channel ? shape.at(out.x[i]) : out.x[i])) /
              static_cast<double>(out.x.size());
  for (double& value : out.curve_y) value += offset;
  return out;
}

}  // namespace ifog::report
