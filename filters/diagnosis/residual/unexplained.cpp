// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/residual.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "drivers/row_times/median.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/distributions/chi_squared.h"
#include "filters/effects/meaning.h"
#include "filters/series/finite_sum.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Median of the known values; 0 if there is none.
double usual_of(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  return values.empty() ? 0.0 : median(std::move(values));
}

// Energy of differences in short pieces, which ignores slow changes. NaN for a piece with missing samples,
// whose energy would scatter more.
std::vector<double> energies(std::span<const double> left, std::size_t piece) {
  std::vector<double> found;
  for (std::size_t from = 0; from + piece <= left.size(); from += piece) {
    double square = 0.0, n = 0.0;
    for (std::size_t i = from + 1; i < from + piece; ++i) {
      const double d = left[i] - left[i - 1];
      if (std::isfinite(d)) square += d * d, n += 1.0;
    }
    found.push_back(3.0 * n >= 2.0 * static_cast<double>(piece - 1) ? square / n : kNaN);
  }
  return found;
}

// Level over the median that one piece exceeds in 1 % of records of white noise. The mean square of m
// differences is χ² distributed with 2/3 m degrees of freedom.
double burst_level(std::size_t piece, std::size_t pieces) {
  const double freedom = 2.0 / 3.0 * static_cast<double>(piece - 1);
  const double chance = 0.01 / static_cast<double>(pieces);
  return std::max(6.0, chi_squared_exceeded(chance, freedom) / chi_squared_quantile(0.5, freedom));
}

// Energy of each piece over the median of its minute, so that a shock is detected in changing traffic. 0 if
// nothing was measured; minutes with few values use no median of their own.
std::vector<double> over_usual(const std::vector<double>& energy, double piece_s) {
  const double of_all = usual_of(energy);
  const auto minute = std::max<std::size_t>(16, static_cast<std::size_t>(60.0 / piece_s));
  std::vector<double> over;
  for (std::size_t from = 0; from < energy.size(); from += minute) {
    const std::span<const double> mine(energy.data() + from, std::min(minute, energy.size() - from));
    const double usual = finite_sum(mine).count >= 16.0 ? usual_of({mine.begin(), mine.end()}) : of_all;
    for (const double each : mine) over.push_back(usual > 0.0 && std::isfinite(each) ? each / usual : 0.0);
  }
  return over;
}

struct SlowRest {
  double over_s = 0.0;  // length of the means that show it best; 0: none
  double share = 0.0;   // share of their variance that neighbours do not show
};

// Slow noise makes means scatter more than neighbouring means differ (von Neumann's ratio; its standard
// deviation for n means of white noise is 1 / sqrt n).
SlowRest slow_rest(std::span<const double> left, double period_s) {
  constexpr double kFewest = 16.0;
  SlowRest found;
  double most = 5.0;
  for (std::size_t count = 1; left.size() / count >= 16; count *= 4) {
    const Samples means = means_over(left, count);
    double steps = 0.0, n = 0.0, before = kNaN;
    for (const double mean : means) {
      const double step = mean - std::exchange(before, mean);
      if (std::isfinite(step)) steps += step * step, n += 1.0;
    }
    if (n < kFewest || !(steps > 0.0)) continue;
    const double neighbours = 0.5 * steps / n, all = variance_of(means);
    const double sigma = (all / neighbours - 1.0) * std::sqrt(n);
    if (sigma <= most) continue;
    most = sigma;
    found = {static_cast<double>(count) * period_s, 1.0 - neighbours / all};
  }
  return found;
}

void describe_peak(const SpectralLine& peak, Unexplained& found) {
  found.kind = "line";
  found.frequency_hz = peak.frequency_hz;
  found.hint = formatted(
      "a peak at %.4g Hz that is no line of one frequency and phase: a resonance of the mounting, or a line "
      "that moves. Log an accelerometer on the mounting and the loop's own signals.",
      peak.frequency_hz);
}

// energy: of pieces of `piece` samples. False if there are no bursts, or so many that they are the noise.
bool describe_bursts(const std::vector<double>& energy, std::size_t piece, double start_s, double period_s,
                     Unexplained& found) {
  const std::vector<double> over = over_usual(energy, static_cast<double>(piece) * period_s);
  const double measured = finite_sum(energy).count;
  const double level = burst_level(piece, energy.size());
  const auto bursts = std::ranges::count_if(over, [&](double each) { return each >= level; });
  const auto strongest = static_cast<std::size_t>(std::ranges::max_element(over) - over.begin());
  std::vector<double> times;
  const auto time_of = [&](std::size_t i) { return start_s + static_cast<double>(i * piece) * period_s; };
  for (std::size_t i = 0; i < over.size(); ++i)
    if (over[i] >= level && (times.empty() || time_of(i) - times.back() > 2.0)) times.push_back(time_of(i));
  if (bursts == 0 || 10.0 * static_cast<double>(bursts) >= measured) return false;
  found.kind = "bursts";
  found.hint = formatted(
      "%zu bursts, the first at %s s, the strongest at %s s: knocks, radio keying or supply dips. Log an "
      "accelerometer and the supply at the sensor's own rate.",
      times.size(), told_time(times.front()).c_str(), told_time(time_of(strongest)).c_str());
  if (times.size() > 50) times.resize(50);
  found.times_s = std::move(times);
  return true;
}

void describe_noise_change(const NoiseChange& change, Unexplained& found) {
  found.kind = "changing_variance";
  found.hint = formatted(
      "the noise is not the same all along the record (%.2g times in %s … %s s): vibration, light level or "
      "electronics. Log vibration, optical power and the supply.",
      change.times, told_time(change.from_s).c_str(), told_time(change.to_s).c_str());
}

std::string hint_of(const SlowRest& slow) {
  return formatted(
      "slow drift that follows none of the channels given: %.0f %% of what %.3g s means scatter. The "
      "sensor's own random walk or flicker, an effect of a form that is not known here (hysteresis), or an "
      "environment that was not logged. Log the temperature at the coil and at the electronics, and the "
      "supply.",
      100.0 * slow.share, slow.over_s);
}

void describe_slow_rest(const SlowRest& slow, Unexplained& found) {
  if (slow.over_s > 0.0) {
    found.kind = "slow";
    found.hint = hint_of(slow);
  } else if (found.fraction > 0.05) {
    found.kind = "uncorrelated";
    found.hint = "correlated with nothing that was logged, and with no pattern of its own";
  } else {
    found.kind = "nothing";
    found.hint = "nothing more is found in the rest";
  }
}

// Describes 1 s means, or block means if there are harmonics, which are part of the block means' noise; single
// samples if the rest is a peak that such means average out.
void describe_share(std::span<const double> error, std::span<const double> left, double period_s,
                    const NoiseFit& noise, const BlockGrid& grid, Unexplained& found) {
  const double usual_s = noise.shape.harmonics.empty() ? 1.0 : grid.block_s;
  const double seen_s = found.frequency_hz * usual_s > 0.5 ? period_s : usual_s;
  const auto count = std::max<std::size_t>(1, static_cast<std::size_t>(std::floor(seen_s / period_s + 0.5)));
  found.means_s = static_cast<double>(count) * period_s;
  const double before = variance_of(means_over(error, count)), after = variance_of(means_over(left, count));
  double known = noise.white_variance * grid.block_s / found.means_s;
  for (const DampedHarmonic& each : noise.shape.harmonics)
    known += noise.white_variance * each.seen_variance();
  found.fraction = before > 0.0 ? std::clamp((after - known) / before, 0.0, 1.0) : 0.0;
}

}  // namespace

Unexplained describe_rest(const std::vector<Record>& records, const std::vector<EvenError>& errors,
                          const std::vector<FoundEffect>& of_samples, const NoiseFit& noise,
                          const BlockGrid& grid, double significance,
                          const std::vector<NoiseChangeIn>& noise_changes) {
  const EvenError& longest =
      *std::ranges::max_element(errors, {}, [](const EvenError& error) { return error.before->size(); });
  const double period_s = grid.sample_s, start_s = longest.origin.in_s(longest.start_s);
  Unexplained found;
  std::vector<SpectralLine> peaks;
  if (!grid.dwells) peaks = find_lines(*longest.after, longest.start_s, period_s, significance);
  if (!peaks.empty()) describe_peak(peaks.front(), found);
  describe_share(*longest.before, *longest.after, period_s, noise, grid, found);
  const SlowRest slow = slow_rest(*longest.after, period_s);
  const double length_s = static_cast<double>(longest.after->size()) * period_s;
  const auto bin = [&](double hz) { return static_cast<std::size_t>(std::lround(hz * length_s)); };
  if (!peaks.empty()) {
    for (const FoundEffect& each : of_samples) {
      const double line_hz = parameter(each.effect, "frequency_hz");
      if (line_hz > 0.0 && are_one_peak(bin(found.frequency_hz), bin(line_hz)))
        found.hint =
            formatted("what is left of the line at %.4g Hz, whose size or frequency is not steady.", line_hz);
    }
    if (slow.over_s * found.frequency_hz > 0.5) found.hint += " Besides, " + hint_of(slow);
    return found;
  }
  const auto second = std::max<std::size_t>(1, static_cast<std::size_t>(std::floor(1.0 / period_s + 0.5)));
  const std::size_t piece = std::max<std::size_t>(8, second / 4);
  const std::vector<double> energy = energies(*longest.after, piece);
  if (energy.size() >= 16 && describe_bursts(energy, piece, start_s, period_s, found)) return found;
  const auto mine = static_cast<std::size_t>(&longest - errors.data());
  const auto change = std::ranges::find(noise_changes, records[mine].name, &NoiseChangeIn::capture);
  if (change == noise_changes.end())
    describe_slow_rest(slow, found);
  else
    describe_noise_change(change->change, found);
  return found;
}

void describe_hysteresis(const Hysteresis& loop, Unexplained& found) {
  const std::string unit = unit_of(loop.channel);
  found.kind = "hysteresis";
  found.frequency_hz = 0.0;
  found.times_s.clear();
  found.hint = formatted(
      "part of the bias depends on which way %s came: a loop %.3g %s wide and %.3g °/h high. No form of the "
      "model describes it and nothing of it is corrected. Let it run up and down between the same values, "
      "and look at the mounting of the coil and at its potting.",
      loop.channel.c_str(), 2.0 * loop.half_width, unit.c_str(),
      2.0 * loop.half_width * std::abs(loop.coefficient) / kDegreePerHour);
}

}  // namespace ifog
