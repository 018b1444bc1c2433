// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramps_out.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/diagnosis/ramp/ramp_comb.h"
#include "filters/diagnosis/record/compensated_error.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/meaning.h"
#include "filters/effects/ramp_tracker.h"
#include "filters/units/told_time.h"

namespace ifog {

WithoutRamps take_out_ramps(const std::vector<Record>& records, double significance) {
  WithoutRamps parts;
  parts.records = records;
  if (records.empty()) return parts;
  std::vector<RampFit> fits;
  for (const RecordChannel& channel : records.front().channels) {
    const auto wraps = [&](const Record& record) {
      return wrap_period(values_of(record, channel.name)) > 0.0;
    };
    if (!std::ranges::any_of(records, wraps)) continue;
    for (Record& record : parts.records) {
      std::erase_if(record.channels, [&](const RecordChannel& other) { return other.name == channel.name; });
    }
    if (auto ramp = fit_ramp(records, channel.name, significance)) fits.push_back(std::move(*ramp));
  }
  if (fits.empty()) {
    RebuiltRamp rebuilt = rebuild_ramp(parts.records, significance);
    if (rebuilt.fit) fits.push_back(std::move(*rebuilt.fit));
    parts.remark = std::move(rebuilt.remark);
  }
  if (fits.empty()) return parts;
  double total = 0.0;
  for (const Record& record : records) total += variance_of(error_of(record));
  for (RampFit& fit : fits) {
    double explained = 0.0;
    for (const Samples& each : fit.correction) explained += variance_of(each);
    fit.found.variance_explained = std::min(1.0, explained / total);
    parts.ramps.push_back(std::move(fit.found));
  }
  for (std::size_t r = 0; r < records.size(); ++r) {
    Samples rate(records[r].rate_radps);
    for (const RampFit& fit : fits)
      for (std::size_t i = 0; i < rate.size(); ++i) rate[i] -= fit.correction[r][i];
    parts.rates.push_back(std::move(rate));
  }
  for (std::size_t r = 0; r < records.size(); ++r) parts.records[r].rate_radps = parts.rates[r];
  return parts;
}

namespace {

// Required gain of twice the log-likelihood over fixed frequencies and over a single line.
constexpr double kOverOthers = 30.0;
// A ramp is not detectable in slower sensors.
constexpr double kQuickSensor_hz = 20.0;

// Remark about the lines of a comb that is not corrected.
std::string lines_in_words(const RampComb& comb, const UnbrokenPart& part) {
  const double hz = comb.cycles_per_rad * std::abs(part.mean_turn_rad()) / part.sample_s();
  return "lines at " + formatted("%.4g", hz) +
         " Hz or multiples of it may be a machine's. A feedback ramp (phase modulator, 2 pi reset) that was "
         "not logged would make such, with " +
         std::to_string(std::lround(comb.cycles_per_rad)) +
         " cycles for each radian turned; whether they follow the angle is not certain, so nothing is "
         "corrected. A capture at another rate would tell, and so would the feedback ramp, logged";
}

// Standard error of k: from the shift of the table's phase over the angle, to first order.
double cycles_error_of(const UnbrokenPart& part, const RampComb& comb) {
  const Eigen::VectorXd& angle = comb.table.angle_rad;
  const double middle = 0.5 * (part.angle_rad.back() + part.angle_rad.front());
  const double aside = 0.25 / static_cast<double>(angle.size());  // cycles
  const auto moved = [](double cycles) { return cycles - std::floor(cycles); };
  double information = 0.0;
  each_phase_step(part.with_phase(comb.cycles_per_rad), [&](std::size_t i, const PhaseStep& step) {
    const auto shifted = [&](double off) {
      return ramp_rate(angle, {moved(step.before + off), moved(step.now + off), step.dt_s, 0.0});
    };
    const double slope = (shifted(aside) - shifted(-aside)) / (2.0 * aside);
    information += std::pow(slope * (part.angle_rad[i] - middle), 2);
  });
  return std::sqrt(comb.table.left() / comb.table.samples / std::max(information, 1e-300));
}

// Random walk of the phase, cycles/sqrt(s), that the table does not show: over the record it spreads the phase as
// much as one step of the table does.
double unseen_walk(const UnbrokenPart& part, const RampComb& comb) {
  const double span_s = static_cast<double>(part.size()) * part.sample_s();
  return 1.0 / (static_cast<double>(comb.table.angle_rad.size()) * std::sqrt(12.0 * span_s));
}

// One cycle minus its mean, at twice the table's resolution and halfway between its steps, where linear
// interpolation has the least noise.
std::vector<double> cycle_of(const Eigen::VectorXd& angle_rad) {
  const Eigen::Index values = 2 * angle_rad.size();
  Eigen::VectorXd cycle(values);
  for (Eigen::Index i = 0; i < values; ++i)
    cycle[i] = angle_at(angle_rad, (static_cast<double>(i) + 0.5) / static_cast<double>(values));
  cycle.array() -= cycle.mean();
  return {cycle.begin(), cycle.end()};
}

double rms(const std::vector<double>& angle) {
  double square = 0.0;
  for (const double value : angle) square += value * value;
  return std::sqrt(square / static_cast<double>(angle.size()));
}

// Correction of a record by the daemon's code, by sample.
Samples correction_by(const Effect& effect, const Record& record) {
  Model model;
  model.effects = {effect};
  Samples correction = error_of(record);
  const Samples left = compensated_error(record, model);
  for (std::size_t i = 0; i < correction.size(); ++i) correction[i] -= left[i];
  return correction;
}

Effect effect_of(const UnbrokenPart& part, const RampComb& comb, const RampSettings& settings) {
  Effect effect;
  effect.form = "rebuilt_ramp";
  effect.period = 1.0;
  effect.angle = true;
  const std::vector<double>& angle = settings.angle_rad;
  for (std::size_t i = 0; i <= angle.size(); ++i) {
    effect.table_x.push_back(static_cast<double>(i) / static_cast<double>(angle.size()));
    effect.table_y.push_back(angle[i % angle.size()]);
  }
  const double density_error = settings.noise_density / std::sqrt(2.0 * comb.table.samples);
  effect.parameters = {{"angle_rms", rms(angle), comb.table.angle_error, "rad"},
                       {"cycles_per_rad", settings.cycles_per_rad, cycles_error_of(part, comb), "1/rad"},
                       {"noise_density", settings.noise_density, density_error, "rad/s/sqrt(Hz)"},
                       {"phase_walk", settings.phase_walk, 0.0, "cycles/sqrt(s)"}};
  effect.meaning = meaning_of(effect);
  return effect;
}

// True if the daemon's correction achieves half of what the table explains. Lines of a structure or machine do not
// keep the angle's phase for so long.
bool keeps_its_promise(const std::vector<Record>& records, const RampFit& fit, const PhaseTable& table) {
  constexpr double kAchieved = 0.5;
  double gained = 0.0, samples = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    Samples error = error_of(records[r]);
    const auto n = static_cast<double>(error.size());
    const double before = variance_of(error);
    for (std::size_t i = 0; i < error.size(); ++i) error[i] -= fit.correction[r][i];
    gained += n * (before - variance_of(error));
    samples += n;
  }
  return gained / samples > kAchieved * table.explained / table.samples;
}

double chance_of(const RampComb& comb) {
  const PhaseTable& table = comb.table;
  return std::min(1.0,
                  comb.tries * chi_squared_above(table.ratio(), static_cast<double>(table.angle_rad.size())));
}

// With table and correction; nullopt if the correction does not achieve what the table explains.
std::optional<RampFit> fit_of(const std::vector<Record>& records, const UnbrokenPart& part,
                              const RampComb& comb) {
  const PhaseTable& table = comb.table;
  if (comb.over_fixed < kOverOthers || comb.over_line < kOverOthers) return std::nullopt;
  const RampSettings settings{comb.cycles_per_rad, cycle_of(table.angle_rad),
                              std::sqrt(table.left() / table.samples * part.sample_s()),
                              unseen_walk(part, comb)};
  RampFit fit;
  fit.found = {effect_of(part, comb, settings), chance_of(comb), 0.0, table.ratio()};
  for (const Record& record : records) fit.correction.push_back(correction_by(fit.found.effect, record));
  return keeps_its_promise(records, fit, table) ? std::optional(std::move(fit)) : std::nullopt;
}

}  // namespace

RebuiltRamp rebuild_ramp(const std::vector<Record>& records, double significance) {
  RebuiltRamp out;
  const auto comb_of = [&](const UnbrokenPart& turned) {
    std::optional<RampComb> found = find_ramp_comb(turned);
    return found && chance_of(*found) <= significance ? found : std::nullopt;
  };
  for (const Record& record : records) {
    const UnbrokenPart part = unbroken_part(record);
    std::optional<RampComb> comb = comb_of(part);
    if (comb)
      if (auto fit = fit_of(records, part, *comb)) return {std::move(fit), ""};
    if (!comb) comb = comb_of(evenly_turned(part));
    if (!comb || !out.remark.empty()) continue;
    if (part.sample_s() * kQuickSensor_hz < 1.0 || comb->over_line > kOverOthers)
      out.remark = lines_in_words(*comb, part);
  }
  return out;
}

}  // namespace ifog
