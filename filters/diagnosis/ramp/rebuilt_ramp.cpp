// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/rebuilt_ramp.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "filters/diagnosis/ramp/ramp_between_captures.h"
#include "filters/diagnosis/ramp/ramp_comb.h"
#include "filters/diagnosis/ramp/ramp_table.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/record_clock.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/compensate_series.h"
#include "filters/effects/meaning.h"
#include "filters/units/field_units.h"

namespace ifog {
namespace {

// What a comb that follows the angle has to gain beyond its harmonics at fixed frequencies, each at its best.
constexpr double kOverFixed = 30.0;
constexpr double kNearly = 0.01;  // of its frequency
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

// One line, or lines at multiples of one.
std::string lines_in_words(const RampComb& comb, double frequency_hz) {
  return comb.plain < 2
             ? "the line at " + rounded(frequency_hz, 4) + " Hz, or at a multiple of that, may be"
             : "lines at multiples of " + rounded(frequency_hz, 4) + " Hz belong together and may be";
}

double frequency_of(const RampComb& comb, const UnbrokenPart& part) {
  return comb.cycles_per_rad * std::abs(part.mean_turn_rad()) / part.sample_s;
}

// A single line of a slow sensor is anybody's.
bool worth_a_word(const RampComb& comb, const UnbrokenPart& part) {
  return comb.plain > 1 || part.sample_s * kQuickSensor_hz < 1.0;
}

std::string fixed_in_words(const RampComb& comb, const UnbrokenPart& part) {
  return lines_in_words(comb, frequency_of(comb, part)) +
         " a machine's. A feedback ramp (phase modulator, 2 pi reset) that was not logged would make such, "
         "with " +
         std::to_string(std::lround(comb.cycles_per_rad)) +
         " cycles for each radian turned: the rate changed too little to show whether they move with it. A "
         "capture at another rate would tell, and so would the feedback ramp, logged";
}

std::string lost_in_words(const RampComb& comb, const UnbrokenPart& part) {
  return lines_in_words(comb, frequency_of(comb, part)) +
         " a machine's. What is there moves as the rate does, as the lines of a feedback ramp (phase "
         "modulator, 2 pi reset) that was not logged would, with " +
         std::to_string(std::lround(comb.cycles_per_rad)) +
         " cycles for each radian turned; its phase could not be followed, so nothing is corrected. A "
         "capture at another rate would tell, and so would the feedback ramp, logged";
}

// there: the same comb as the other capture has it.
std::string moves_in_words(const RampComb& comb, const UnbrokenPart& part, const RampComb& there,
                           const UnbrokenPart& other) {
  return "lines stand at multiples of " + rounded(frequency_of(comb, part), 4) +
         " Hz in one capture and of " + rounded(frequency_of(there, other), 4) +
         " Hz in another, as the rates there are: a feedback ramp (phase modulator, 2 pi reset) of " +
         std::to_string(std::lround(comb.cycles_per_rad)) +
         " cycles for each radian turned. Its phase could not be followed, so nothing is corrected: log it";
}

std::string too_slow_in_words(const UnbrokenPart& part) {
  const double span_s = static_cast<double>(part.size()) * part.sample_s;
  const double needed = kSeenCycles / kUsualCycles / span_s;
  return "a feedback ramp (phase modulator, 2 pi reset) that was not logged would not show here, so near "
         "zero "
         "rate its line stands still: it would from " +
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

// One line that follows the angle, and at nearly its frequency one that does not and takes more: then what
// stands there wanders by itself, and of a hundred thousand ramps that were tried one goes a part of its way.
bool wanders_by_itself(const RampComb& comb, const std::optional<RampComb>& fixed, const UnbrokenPart& part) {
  if (!fixed || comb.harmonics > 1 || fixed->ratio < comb.ratio) return false;
  const double moving_hz = frequency_of(comb, part);
  return std::abs(frequency_of(*fixed, part) - moving_hz) < kNearly * moving_hz;
}

// With the ramp's table and what the tracker makes of it; nothing where it does not help.
std::optional<RampFit> fit_of(const std::vector<Record>& records, std::size_t at, const UnbrokenPart& part,
                              const RampComb& comb, double p_value, double most_walk) {
  const std::optional<RampTable> table = fit_ramp_table(part, comb);
  if (!table || rms(table->one_cycle()) < kCertain * table->angle_error) return std::nullopt;
  if (table->phase_walk > most_walk) return std::nullopt;
  RampFit fit;
  fit.effect = effect_of(*table);
  fit.ratio = comb.ratio;
  fit.p_value = p_value;
  correct_all(records, at, part, *table, fit);
  if (energy_taken(records, fit) <= 0.0) return std::nullopt;
  return fit;
}

double chance_of(const RampComb& comb) {
  return std::min(1.0, comb.tries * chi_squared_above(comb.ratio, 2.0 * static_cast<double>(comb.harmonics)));
}

// By two captures at different rates. That the lines follow the rate is proven by that, however the phase
// walks.
RebuiltRamp rebuild_between(const std::vector<Record>& records, const std::vector<UnbrokenPart>& parts,
                            const std::vector<std::optional<RampComb>>& combs, double significance) {
  constexpr double kAnyWalk = 1.0;
  RebuiltRamp out;
  for (std::size_t r = 0; r < records.size(); ++r) {
    if (!combs[r]) continue;
    const double p_value = chance_of(*combs[r]);
    if (p_value > significance) continue;
    for (std::size_t s = 0; s < records.size(); ++s) {
      if (s == r || parts[s].size() == 0) continue;
      const RampBetween between = follow_comb(parts[r], *combs[r], parts[s]);
      if (!between.moves) continue;
      RampComb there = *combs[r];
      there.cycles_per_rad = between.cycles_per_rad;
      out.fit = fit_of(records, r, parts[r], *combs[r], p_value, kAnyWalk);
      if (!out.fit) out.remark = moves_in_words(*combs[r], parts[r], there, parts[s]);
      return out;
    }
  }
  return out;
}

}  // namespace

RebuiltRamp rebuild_ramp(const std::vector<Record>& records, double significance) {
  RebuiltRamp out;
  std::vector<UnbrokenPart> parts;
  std::vector<std::optional<RampComb>> combs(records.size());
  for (std::size_t r = 0; r < records.size(); ++r) {
    const UnbrokenPart& part = parts.emplace_back(unbroken_part(records[r]));
    if (part.size() == 0) continue;
    if (kUsualCycles * std::abs(part.mean_turn_rad()) * static_cast<double>(part.size()) < kSeenCycles) {
      if (records[r].reference_radps.empty() && part.sample_s * kQuickSensor_hz < 1.0 && out.remark.empty())
        out.remark = too_slow_in_words(part);
      continue;
    }
    combs[r] = find_ramp_comb(part);
    const bool weak = !combs[r] || combs[r]->over_fixed < kOverFixed;
    const std::optional<RampComb> fixed =
        weak || combs[r]->harmonics == 1 ? find_fixed_comb(part) : std::nullopt;
    if (weak || wanders_by_itself(*combs[r], fixed, part)) {
      if (fixed && (!combs[r] || combs[r]->ratio < fixed->ratio)) combs[r] = fixed;
      if (fixed && worth_a_word(*fixed, part) && out.remark.empty())
        out.remark = fixed_in_words(*fixed, part);
      continue;
    }
    const double p_value = chance_of(*combs[r]);
    if (p_value > significance) continue;
    if (auto fit = fit_of(records, r, part, *combs[r], p_value, kMostWalk)) return {std::move(fit), ""};
    if (worth_a_word(*combs[r], part) && out.remark.empty()) out.remark = lost_in_words(*combs[r], part);
  }
  RebuiltRamp between = rebuild_between(records, parts, combs, significance);
  return between.fit || !between.remark.empty() ? between : out;
}

}  // namespace ifog
