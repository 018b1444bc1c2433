// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramps_out.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "filters/diagnosis/ramp/ramp_comb.h"
#include "filters/diagnosis/ramp/ramp_table.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/known_columns.h"
#include "filters/diagnosis/record/record_clock.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/compensate_series.h"
#include "filters/effects/meaning.h"
#include "filters/units/field_units.h"

namespace ifog {

WithoutRamps take_out_ramps(const std::vector<Record>& records, double significance) {
  WithoutRamps parts;
  parts.records = records;
  if (records.empty()) return parts;
  for (const RecordChannel& channel : records.front().channels) {
    const auto wraps = [&](const Record& record) {
      const std::span<const double> values = values_of(record, channel.name);
      return *known_or(record.known.get(), {"wraps", values}, [&] { return wrap_period(values) > 0.0; });
    };
    if (!std::any_of(records.begin(), records.end(), wraps)) continue;
    for (Record& record : parts.records) {
      std::erase_if(record.channels, [&](const RecordChannel& other) { return other.name == channel.name; });
    }
    if (auto ramp = fit_ramp(records, channel.name, significance)) parts.ramps.push_back(std::move(*ramp));
  }
  if (parts.ramps.empty()) {
    RebuiltRamp rebuilt = rebuild_ramp(parts.records, significance);
    if (rebuilt.fit) parts.ramps.push_back(std::move(*rebuilt.fit));
    parts.remark = std::move(rebuilt.remark);
  }
  if (parts.ramps.empty()) return parts;
  for (std::size_t r = 0; r < records.size(); ++r) {
    Samples rate(records[r].rate_radps.begin(), records[r].rate_radps.end());
    for (const RampFit& ramp : parts.ramps) {
      for (std::size_t i = 0; i < rate.size(); ++i) rate[i] -= ramp.correction[r][i];
    }
    parts.rates.push_back(std::move(rate));
  }
  for (std::size_t r = 0; r < records.size(); ++r) parts.records[r].rate_radps = parts.rates[r];
  return parts;
}

namespace {

// What a comb that follows the angle has to gain beyond its harmonics at fixed frequencies, each at its best.
constexpr double kOverFixed = 30.0;
// Slower sensors cannot show a ramp, and nothing is said of it.
constexpr double kQuickSensor_hz = 20.0;
constexpr double kUsualCycles = 1e5;  // a coil of 10 cm at 1.55 um has 7e4
constexpr double kSeenCycles = 20.0;
constexpr double kCertain = 3.0;  // standard errors of the table
// The ramp's phase is the angle's, and stays it: a tenth of a cycle in 40 min is more than the one that was
// measured walks. A line that walks more, of a swaying structure or a machine, follows itself.
constexpr double kMostWalk = 0.002;  // cycles/sqrt(s)

double rms(const std::vector<double>& angle) {
  double square = 0.0;
  for (const double value : angle) square += value * value;
  return std::sqrt(square / static_cast<double>(angle.size()));
}

std::string rounded(double value, int digits) {
  std::ostringstream out;
  out.precision(digits);
  out << value;
  return out.str();
}

double frequency_of(const RampComb& comb, const UnbrokenPart& part) {
  return comb.cycles_per_rad * std::abs(part.mean_turn_rad()) / part.sample_s;
}

// Of a comb that is not corrected.
std::string lines_in_words(const RampComb& comb, const UnbrokenPart& part) {
  return "lines at " + rounded(frequency_of(comb, part), 4) +
         " Hz or multiples of it may be a machine's. A feedback ramp (phase modulator, 2 pi reset) that was "
         "not logged would make such, with " +
         std::to_string(std::lround(comb.cycles_per_rad)) +
         " cycles for each radian turned; whether they follow the angle is not certain, so nothing is "
         "corrected. A capture at another rate would tell, and so would the feedback ramp, logged";
}

std::string too_slow_in_words(const UnbrokenPart& part) {
  const double span_s = static_cast<double>(part.size()) * part.sample_s;
  const double needed = kSeenCycles / kUsualCycles / span_s;
  return "a feedback ramp (phase modulator, 2 pi reset) that was not logged would not show here, so near "
         "zero rate its line stands still: it would from " +
         rounded(needed / kDegreePerHour, 2) + " degrees an hour on";
}

// Runs the tracker over the records as the daemon would. use(record, sample, correction).
template <class Use>
void run_over(const std::vector<Record>& records, const RampSettings& settings, Use&& use) {
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Record& record = records[r];
    RampTracker tracker(settings);
    const double usual_s = usual_step_of(record);
    for (std::size_t i = 0; i < record.time_s.size(); ++i) {
      const double dt = i == 0 ? usual_s : record.time_s[i] - record.time_s[i - 1];
      double error = record.rate_radps[i];
      if (!record.reference_radps.empty()) error -= record.reference_radps[i];
      use(r, i,
          tracker.step({.measured_radps = record.rate_radps[i],
                        .rest_radps = error,
                        .dt_s = dt,
                        .missed_s = dt > 1.5 * usual_s ? dt - usual_s : 0.0}));
    }
  }
}

Effect effect_of(const RampTable& table) {
  Effect effect;
  effect.form = "rebuilt_ramp";
  effect.period = 1.0;
  effect.angle = true;
  const std::vector<double> angle = table.one_cycle();
  for (std::size_t i = 0; i <= angle.size(); ++i) {
    effect.table_x.push_back(static_cast<double>(i) / static_cast<double>(angle.size()));
    effect.table_y.push_back(angle[i % angle.size()]);
  }
  effect.parameters = {{"angle_rms", rms(angle), table.angle_error, "rad"},
                       {"cycles_per_rad", table.cycles_per_rad, table.cycles_error, "1/rad"},
                       {"noise_density", table.noise_density, table.noise_error, "rad/s/sqrt(Hz)"},
                       {"phase_walk", table.phase_walk, table.walk_error, "cycles/sqrt(s)"}};
  effect.meaning = meaning_of(effect);
  return effect;
}

void correct_all(const std::vector<Record>& records, std::size_t fitted, const UnbrokenPart& part,
                 const RampTable& table, RampFit& fit) {
  for (const Record& record : records) fit.correction.emplace_back(record.time_s.size(), 0.0);
  fit.held_out = fit.correction;
  run_over(records, table.settings(), [&](std::size_t r, std::size_t i, double ramp) {
    fit.correction[r][i] = fit.held_out[r][i] = ramp;
  });
  for (std::size_t p = 0; p < kRampParts; ++p) {
    run_over({records[fitted]}, table.without(p).settings(), [&](std::size_t, std::size_t i, double ramp) {
      if (i < part.first || i >= part.first + part.size()) return;
      if (ramp_part(i - part.first, part.size()) == p) fit.held_out[fitted][i] = ramp;
    });
  }
}

double energy_taken(const std::vector<Record>& records, const RampFit& fit) {
  double taken = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Samples error = error_of(records[r]);
    double mean = 0.0;
    double n = 0.0;
    for (const double e : error) {
      if (!std::isfinite(e)) continue;
      mean += e;
      n += 1.0;
    }
    mean /= std::max(n, 1.0);
    for (std::size_t i = 0; i < error.size(); ++i) {
      const double ramp = fit.held_out[r][i];
      if (std::isfinite(error[i])) taken += ramp * (2.0 * (error[i] - mean) - ramp);
    }
  }
  return taken;
}

double chance_of(const RampComb& comb) {
  return std::min(1.0, comb.tries * chi_squared_above(comb.ratio, 2.0 * static_cast<double>(comb.harmonics)));
}

// With the ramp's table and what the tracker makes of it; nothing where it does not help.
std::optional<RampFit> fit_of(const std::vector<Record>& records, std::size_t at, const UnbrokenPart& part,
                              const RampComb& comb) {
  const std::optional<RampTable> table = fit_ramp_table(part, comb);
  if (!table || rms(table->one_cycle()) < kCertain * table->angle_error) return std::nullopt;
  if (table->phase_walk > kMostWalk) return std::nullopt;
  RampFit fit;
  fit.effect = effect_of(*table);
  fit.ratio = comb.ratio;
  fit.p_value = chance_of(comb);
  correct_all(records, at, part, *table, fit);
  if (energy_taken(records, fit) <= 0.0) return std::nullopt;
  return fit;
}

}  // namespace

RebuiltRamp rebuild_ramp(const std::vector<Record>& records, double significance) {
  RebuiltRamp out;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const UnbrokenPart part = unbroken_part(records[r]);
    if (part.size() == 0) continue;
    const bool quick = part.sample_s * kQuickSensor_hz < 1.0;
    if (kUsualCycles * std::abs(part.mean_turn_rad()) * static_cast<double>(part.size()) < kSeenCycles) {
      if (records[r].reference_radps.empty() && quick && out.remark.empty())
        out.remark = too_slow_in_words(part);
      continue;
    }
    const auto comb_of = [&](const UnbrokenPart& turned) {
      std::optional<RampComb> comb = find_ramp_comb(turned);
      return comb && chance_of(*comb) <= significance ? comb : std::nullopt;
    };
    std::optional<RampComb> comb = comb_of(part);
    // One line that wanders, of a structure or a machine, goes a part of the way of one of the hundred
    // thousand combs that were tried.
    if (comb && comb->over_fixed > kOverFixed && comb->harmonics > 1)
      if (auto fit = fit_of(records, r, part, *comb)) return {std::move(fit), ""};
    if (!comb) comb = comb_of(evenly_turned(part));
    if (comb && out.remark.empty() && (quick || comb->harmonics > 1))
      out.remark = lines_in_words(*comb, part);
  }
  return out;
}

}  // namespace ifog
