// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramp_comb.h"

#include <algorithm>
#include <bit>
#include <boost/math/tools/minima.hpp>
#include <complex>
#include <numbers>

#include "drivers/row_times/median.h"
#include "filters/diagnosis/record/fitted_part.h"
#include "filters/effects/compensate_series.h"
#include "filters/linear/fourier.h"

namespace ifog {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t kLeastSamples = 4096, kMostSamples = 131072;
constexpr std::size_t kMostBins = 1U << 20U;
// A coil of diameter D has D/(n lambda) cycles per radian (Lefevre, The Fiber-Optic Gyroscope, phase ramp):
// limits for 2.3 cm at 1.55 um and 70 cm at 0.8 um.
constexpr double kLeastCycles = 1e4, kMostCycles = 6e5;
constexpr double kLeastTurns = 20.0;
constexpr double kStandsOut = 20.0;  // power / surrounding noise, exceeded by chance in one of 10^3 records
constexpr std::size_t kPeaks = 8;    // number of peaks examined
// a peak may be up to this harmonic; also the number in the first score
constexpr std::size_t kHarmonics = 8;
constexpr std::size_t kRefined = 3;  // number of fundamentals refined

Complex carrier_of(double cycles) {
  return std::polar(1.0, 2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
}

Stretch longest_without_hole(const Record& record, double step_s) {
  Stretch longest{0, 0};
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= record.time_s.size(); ++i) {
    const bool missing = i == record.time_s.size() || !std::isfinite(record.error(i));
    const bool hole = i > begin && !missing && record.time_s[i] - record.time_s[i - 1] > 1.5 * step_s;
    if (!missing && !hole) continue;
    if (i - begin > longest.end - longest.begin) longest = {begin, i};
    begin = missing ? i + 1 : i;
  }
  return longest;
}

// Power over that of the neighbours for k = bin / length; length is twice the angle turned.
struct AngleSpectrum {
  std::vector<double> power;
  double length = 0.0;
};

void divide_by_floor(std::vector<double>& power) {
  constexpr std::size_t kBlock = 256;
  std::vector<double> floor;
  for (std::size_t from = 0; from < power.size(); from += kBlock) {
    const auto first = power.begin() + static_cast<std::ptrdiff_t>(from);
    const auto last = power.begin() + static_cast<std::ptrdiff_t>(std::min(from + kBlock, power.size()));
    floor.push_back(std::max(median({first, last}) / std::numbers::ln2, 1e-300));
  }
  for (std::size_t i = 0; i < power.size(); ++i) {
    const std::size_t block = i / kBlock;
    // The last block may be short; in steep noise the larger neighbour counts.
    power[i] /= std::max(floor[block], floor[std::min(block + 1, floor.size() - 1)]);
  }
}

// Transform over the angle: samples are averaged in angle bins, at least two per cycle of the highest k.
AngleSpectrum spectrum_over_angle(const UnbrokenPart& part) {
  const auto [low, high] = std::minmax_element(part.angle_rad.begin(), part.angle_rad.end());
  const double lowest = *low, most = 0.5 / std::abs(part.mean_turn_rad());
  AngleSpectrum out;
  out.length = 2.0 * (*high - lowest) * (1.0 + 1e-9);
  const auto wanted = static_cast<std::size_t>(2.0 * most * out.length);
  const std::size_t bins = std::min(kMostBins, std::bit_ceil(wanted + 16));
  std::vector<double> sums(bins, 0.0);
  each_phase_step(part.with_phase(0.0), [&](std::size_t i, const PhaseStep& step) {
    const double position = (part.angle_rad[i] - lowest) / out.length * static_cast<double>(bins);
    sums[std::min(static_cast<std::size_t>(position), bins - 1)] += step.error_radps;
  });
  out.power = power_spectrum(sums);
  out.power.resize(std::min(out.power.size(), static_cast<std::size_t>(most * out.length) + 1));
  divide_by_floor(out.power);
  return out;
}

// Gain minus cost of the harmonics of a fundamental at `bin`, for the best number of harmonics. A single
// strong line does not score as a comb.
double score_of(const std::vector<double>& power, double bin) {
  constexpr double kMostOfOne = 10.0;  // limit for one harmonic, in units of its cost
  const double cost = std::log(static_cast<double>(power.size()));
  double best = 0.0, sum = 0.0;
  for (std::size_t h = 1; h <= 2 * kHarmonics; ++h) {
    const auto at = static_cast<std::size_t>(std::lround(bin * static_cast<double>(h)));
    if (at + 1 >= power.size()) break;
    const double around = std::max({power[at - 1], power[at], power[at + 1]});
    sum += std::min(around, kMostOfOne * cost) - cost;
    best = std::max(best, sum);
  }
  return best;
}

// Detectable cycles per radian: from a fundamental above the removed slow part with at least 20 cycles to one
// below half the sample rate. Empty (least > most) near zero rate.
struct VisibleCycles {
  double least = 0.0, most = 0.0;
};

VisibleCycles visible_cycles(const UnbrokenPart& part) {
  const double turn = std::abs(part.mean_turn_rad());
  if (!(turn > 0.0)) return {1.0, 0.0};
  const double slowest = std::max(kLeastTurns / static_cast<double>(part.size()), 1.0 / kSlowSamples);
  return {std::max(kLeastCycles, slowest / turn), std::min(kMostCycles, 0.45 / turn)};
}

// Bins of possible fundamentals, best first.
std::vector<double> fundamentals(const AngleSpectrum& spectrum, const VisibleCycles& visible) {
  const std::vector<double>& power = spectrum.power;
  const double least = visible.least * spectrum.length;
  std::vector<std::size_t> peaks;
  for (std::size_t i = std::max<std::size_t>(1, static_cast<std::size_t>(least)); i + 1 < power.size(); ++i)
    if (power[i] > kStandsOut && power[i] >= power[i - 1] && power[i] > power[i + 1]) peaks.push_back(i);
  std::ranges::sort(peaks, [&](std::size_t a, std::size_t b) { return power[a] > power[b]; });
  if (peaks.size() > kPeaks) peaks.resize(kPeaks);
  std::vector<std::pair<double, double>> scored;
  for (const std::size_t peak : peaks)
    for (std::size_t multiple = 1; multiple <= kHarmonics; ++multiple) {
      const double bin = static_cast<double>(peak) / static_cast<double>(multiple);
      if (bin < std::max(least, 1.0)) break;
      scored.emplace_back(-score_of(power, bin), bin);
    }
  std::ranges::sort(scored);
  std::vector<double> bins;
  for (const auto& [score, bin] : scored) {
    const auto near = [at = bin](double other) { return std::abs(other - at) < 1.0; };
    if (bins.size() < kRefined && std::ranges::none_of(bins, near)) bins.push_back(bin);
  }
  return bins;
}

// Refines k to the value at which a table explains most: first with few steps, then with ever finer ones.
// span: angle turned.
double refined(const UnbrokenPart& part, double k, double span) {
  double reach = 1.0 / span, step = 0.0;
  for (const Eigen::Index steps : {8, 16, 32, 64, 128}) {
    step = 1.0 / (4.0 * static_cast<double>(steps) * span);
    double best = -1.0, at = k;
    for (double each = k - reach; each <= k + reach; each += step)
      if (const double now = explained_by_table({part.with_phase(each)}, steps); now > best)
        best = now, at = each;
    k = at;
    reach = 2.0 * step;
  }
  constexpr Eigen::Index kFinest = 128;
  constexpr int kBits = 8;  // resolution within a step
  std::uintmax_t most_evaluations = 20;
  const auto lacking = [&](double steps) {
    return -explained_by_table({part.with_phase(k + steps * step)}, kFinest);
  };
  return k + step * boost::math::tools::brent_find_minima(lacking, -1.0, 1.0, kBits, most_evaluations).first;
}

// True for a sensor that counts pulses. Its steps of a fixed angle make a comb over the angle but no ramp:
// its angle values are whole cycles apart.
bool counts_pulses(const UnbrokenPart& part, double cycles_per_rad) {
  constexpr double kStanding = 0.3;  // mean of the carrier; 0.05 after 20 cycles of uniform rotation
  for (std::size_t h = 1; h <= 2 * kHarmonics; ++h) {
    Complex mean = 0.0;
    for (const double angle : part.angle_rad)
      mean += carrier_of(cycles_per_rad * static_cast<double>(h) * angle) / static_cast<double>(part.size());
    if (std::abs(mean) > kStanding) return true;
  }
  return false;
}

// Share of the squared error that the table's first harmonic explains.
double explained_by_line(const UnbrokenPart& part, double cycles_per_rad) {
  Complex sum = 0.0;
  double square = 0.0;
  each_phase_step(part.with_phase(cycles_per_rad), [&](std::size_t, const PhaseStep& step) {
    const Complex rate = (carrier_of(step.now) - carrier_of(step.before)) / step.dt_s;
    sum += step.error_radps * std::conj(rate);
    square += std::norm(rate);
  });
  return square > 0.0 ? 2.0 * std::norm(sum) / square : 0.0;
}

}  // namespace

double UnbrokenPart::sample_s() const {
  return (record.time_s.back() - record.time_s.front()) / static_cast<double>(size() - 1);
}

double UnbrokenPart::mean_turn_rad() const {
  return size() < 2 ? 0.0 : (angle_rad.back() - angle_rad.front()) / static_cast<double>(size() - 1);
}

PhasedRecord UnbrokenPart::with_phase(double cycles_per_rad) const {
  return {&record, [this, cycles_per_rad](std::size_t i) { return cycles_per_rad * angle_rad[i]; }};
}

UnbrokenPart unbroken_part(const Record& record) {
  UnbrokenPart part;
  if (record.time_s.size() < kLeastSamples) return part;
  Stretch where = longest_without_hole(record, usual_step(record.time_s));
  where.end = std::min(where.end, where.begin + kMostSamples);
  if (where.end - where.begin < kLeastSamples) return part;
  part.record = part_of(record, {where.begin, where.end});
  double angle = 0.0;
  part.angle_rad.push_back(angle);
  for (std::size_t i = 1; i < part.record.time_s.size(); ++i) {
    angle += part.record.rate_radps[i] * (part.record.time_s[i] - part.record.time_s[i - 1]);
    part.angle_rad.push_back(angle);
  }
  return part;
}

UnbrokenPart evenly_turned(UnbrokenPart part) {
  const double turn = part.mean_turn_rad();
  for (std::size_t i = 0; i < part.size(); ++i) part.angle_rad[i] = turn * static_cast<double>(i);
  return part;
}

std::optional<RampComb> find_ramp_comb(const UnbrokenPart& part) {
  const VisibleCycles visible = visible_cycles(part);
  if (part.size() == 0 || !(visible.least < visible.most)) return std::nullopt;
  const AngleSpectrum spectrum = spectrum_over_angle(part);
  const double span = 0.5 * spectrum.length;
  std::optional<RampComb> best;
  for (const double bin : fundamentals(spectrum, visible)) {
    const double k = refined(part, bin / spectrum.length, span);
    if (k > visible.most || counts_pulses(part, k)) continue;
    std::optional<PhaseTable> table = fit_phase_table({part.with_phase(k)});
    if (!table || table->score() <= (best ? best->table.score() : 0.0)) continue;
    best = RampComb{k, std::move(*table), static_cast<double>(spectrum.power.size() * 2 * kHarmonics)};
  }
  if (!best) return best;
  const PhaseTable& table = best->table;
  const auto gained_over = [&](double explained) {
    return (table.explained - explained) * table.samples / table.left();
  };
  const UnbrokenPart even = evenly_turned(part);
  const double fixed = refined(even, best->cycles_per_rad, span);
  best->over_fixed = gained_over(explained_by_table({even.with_phase(fixed)}, table.angle_rad.size()));
  best->over_line = gained_over(explained_by_line(part, best->cycles_per_rad));
  return best;
}

}  // namespace ifog
