// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramp.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/ramp/phase_table.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/meaning.h"

namespace ifog {
namespace {

Effect table_effect(const std::string& channel, double period, const PhaseTable& table) {
  const auto steps = static_cast<double>(table.angle_rad.size());
  Effect effect;
  effect.form = "lookup";
  effect.channel = channel;
  effect.period = period;
  effect.angle = true;
  // A constant angle has no rate. The table is stored minus its mean, so that a model change causes a small
  // jump.
  const double mean = table.angle_rad.sum() / (steps + 1.0);
  double square = 0.0;
  for (double k = 0.0; k <= steps; ++k) {
    const double angle = angle_at(table.angle_rad, k / steps) - mean;
    effect.table_x.push_back(period * k / steps);
    effect.table_y.push_back(angle);
    square += angle * angle / (steps + 1.0);
  }
  effect.parameters = {{"angle_rms", std::sqrt(square), table.angle_error, "rad"}};
  effect.meaning = meaning_of(effect);
  return effect;
}

}  // namespace

double wrap_period(std::span<const double> values) {
  constexpr double kSmallestCounter = 16.0;  // counts; a smaller one may be a state
  double low = 1e300, high = -1e300;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    if (values[i] < 0.0) return 0.0;  // not a counter
    low = std::min(low, values[i]);
    high = std::max(high, values[i]);
  }
  if (!(high > kSmallestCounter)) return 0.0;
  const double period = std::exp2(std::ceil(std::log2(high + 0.5)));
  if (high < 0.9 * period || low > 0.1 * period) return 0.0;
  std::size_t jumps = 0;
  double raw = 0.0, wrapped = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double d = values[i] - values[i - 1];
    if (!std::isfinite(d)) continue;
    const double w = d - period * std::round(d / period);
    jumps += std::abs(d) > 0.5 * period;
    raw += d * d;
    wrapped += w * w;
  }
  return jumps >= 3 && wrapped < 0.9 * raw ? period : 0.0;
}

std::optional<RampFit> fit_ramp(const std::vector<Record>& records, const std::string& channel,
                                double significance) {
  double period = 0.0;
  for (const Record& record : records) period = std::max(period, wrap_period(values_of(record, channel)));
  if (!(period > 0.0)) return std::nullopt;
  std::vector<PhasedRecord> phased;
  phased.reserve(records.size());
  for (const Record& record : records)
    phased.push_back({&record, [counts = values_of(record, channel), period](std::size_t i) {
                        return counts[i] / period;
                      }});
  const std::optional<PhaseTable> table = fit_phase_table(phased);
  if (!table || table->score() <= 0.0) return std::nullopt;
  RampFit fit;
  fit.found.likelihood_ratio = table->ratio();
  fit.found.p_value =
      chi_squared_above(std::max(0.0, table->ratio()), static_cast<double>(table->angle_rad.size()));
  if (fit.found.p_value > significance) return std::nullopt;
  fit.found.effect = table_effect(channel, period, *table);
  for (const PhasedRecord& record : phased) {
    Samples& correction = fit.correction.emplace_back(record.record->time_s.size(), 0.0);
    each_phase_step(record, [&](std::size_t i, const PhaseStep& step) {
      correction[i] = ramp_rate(table->angle_rad, step);
    });
  }
  return fit;
}

}  // namespace ifog
