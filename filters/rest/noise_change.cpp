// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/noise_change.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "drivers/row_times/median.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kTimes = 64;
constexpr std::size_t kMostOctaves = 40;
// Coefficients a cell needs; below, cells are joined in pairs.
constexpr double kFewest = 16.0;
constexpr std::size_t kFewestTimes = 8;
// Departure in standard deviations that the noise of one octave reaches in fewer than one of 2000 records,
// over all stretches (simulated).
constexpr double kSurely = 5.2;
// Smaller changes of the deviation do not matter.
constexpr double kMaterial = 1.25;
// Departure at which a further octave of the found stretch counts as changed.
constexpr double kAlso = 3.0;
constexpr std::size_t kMostChanges = 3;
// A coefficient is limited to this multiple of its cell's median (2.7 standard deviations), so that a spike,
// which is in one or two coefficients of each octave, is no louder noise.
constexpr double kMostTimes = 4.0;
// Values closer than this, relatively, are equal except for rounding. Most neighbours of a coarse sensor are.
constexpr double kRoundedAway = 1e-13;
// Limit of the reported ratio; avoids a division by almost zero.
constexpr double kMostRatio = 1e6;

// Sums of coefficient magnitudes of one octave, by time cell. Squares would not converge for heavy-tailed
// noise; magnitudes cost an eighth of the information for normal noise.
struct Octave {
  std::array<double, kTimes> magnitudes{}, counts{};
  double beyond_rounding = 0.0;  // count of coefficients beyond rounding
};

// Wavelet filter bank: each scaling coefficient in; every second one yields a wavelet coefficient and a
// scaling coefficient of the next octave. Daubechies, "Ten Lectures on Wavelets" (1992), table 6.1, N = 2.
class Pyramid {
 public:
  explicit Pyramid(std::size_t samples) : samples_(samples) {}

  // Starts a new stretch.
  void begin() {
    for (Level& level : levels_) level.count = 0;
  }
  void take(double value, std::size_t at) {
    for (std::size_t k = 0; k < kMostOctaves; ++k) {
      Level& level = levels_[k];
      level.last = {level.last[1], level.last[2], level.last[3], value};
      if (++level.count < 4 || level.count % 2 == 1) return;
      const auto& x = level.last;
      add(k, at, kHigh[0] * x[0] + kHigh[1] * x[1] + kHigh[2] * x[2] + kHigh[3] * x[3],
          kRoundedAway * (std::abs(x[2]) + std::abs(x[3])));
      value = kHigh[3] * x[0] - kHigh[2] * x[1] + kHigh[1] * x[2] - kHigh[0] * x[3];
    }
  }
  // To be called once, after the last sample.
  [[nodiscard]] const std::vector<Octave>& octaves() {
    for (std::size_t k = 0; k < octaves_.size(); ++k) close(k);
    return octaves_;
  }

 private:
  struct Level {
    std::array<double, 4> last{};
    std::size_t count = 0;
    std::size_t cell = 0;            // of the last coefficient
    std::vector<double> magnitudes;  // of that cell, beyond rounding
  };
  // (1 - sqrt 3, sqrt 3 - 3, 3 + sqrt 3, -1 - sqrt 3) / (4 sqrt 2).
  static constexpr std::array<double, 4> kHigh{-0.12940952255126037, -0.22414386804201339,
                                               0.83651630373780790, -0.48296291314453414};

  void add(std::size_t octave, std::size_t at, double coefficient, double rounding) {
    if (octave >= octaves_.size()) octaves_.resize(octave + 1);
    // Centre of the filter, which spans three samples of its octave.
    const std::size_t place = at - std::min(at, std::size_t{3} << octave);
    const std::size_t cell = std::min(kTimes - 1, place * kTimes / samples_);
    if (cell != levels_[octave].cell) close(octave);
    levels_[octave].cell = cell;
    octaves_[octave].counts[cell] += 1.0;
    if (std::abs(coefficient) > rounding) levels_[octave].magnitudes.push_back(std::abs(coefficient));
  }
  // Adds the magnitudes of its present cell.
  void close(std::size_t octave) {
    std::vector<double>& all = levels_[octave].magnitudes;
    if (all.empty()) return;
    octaves_[octave].beyond_rounding += static_cast<double>(all.size());
    const double most = kMostTimes * median(all);
    for (const double each : all) octaves_[octave].magnitudes[levels_[octave].cell] += std::min(each, most);
    all.clear();
  }

  std::size_t samples_;
  std::array<Level, kMostOctaves> levels_{};
  std::vector<Octave> octaves_;
};

// Square roots of one octave's mean magnitudes by time cell, nearly normal.
struct NoiseLevel {
  std::vector<double> root;       // of the cells with enough coefficients
  std::vector<std::size_t> cell;  // index of the first cell, kTimes per record
  double deviation = 0.0;         // of one root while the level is constant
  std::size_t cells_each = 1;     // cells per root
};

double sum_of(const std::array<double, kTimes>& values, std::size_t begin, std::size_t end) {
  return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(begin),
                         values.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
}

// Scatter of means of `together` neighbouring roots, scaled to one root. Heavy tails scatter more than normal
// noise. A resonance with slow beats scatters several times more in means than in single roots.
double deviation_by(const std::vector<double>& root, std::size_t together) {
  if (root.size() < 8 * together) return 0.0;
  std::vector<double> sums{0.0}, steps;
  for (const double each : root) sums.push_back(sums.back() + each);
  for (std::size_t i = 0; i + 2 * together < sums.size(); ++i)
    steps.push_back(std::abs(sums[i + 2 * together] - 2.0 * sums[i + together] + sums[i]));
  constexpr double kNormal = 0.6745 * 1.4142;
  return median(steps) / kNormal / std::sqrt(static_cast<double>(together));
}

NoiseLevel noise_level_of(const Octave& octave) {
  const double count = octave.beyond_rounding, share = count / sum_of(octave.counts, 0, kTimes);
  // With a coarse sensor only a share of the differences is not zero. Their number varies, and they come in
  // pairs, as each change of the value is in two of them.
  const double wanted = kFewest * (1.0 + 3.0 * (1.0 - share));
  NoiseLevel out;
  std::size_t times = kTimes;
  while (times >= kFewestTimes && count < wanted * static_cast<double>(times)) times /= 2;
  if (times < kFewestTimes) return out;
  out.cells_each = kTimes / times;
  std::vector<double> counts;
  for (std::size_t cell = 0; cell < kTimes; cell += out.cells_each)
    if (const double here = sum_of(octave.counts, cell, cell + out.cells_each); here > 0.0)
      counts.push_back(here);
  // Usual count of values in a cell without missing samples.
  const double usual = median(counts);
  for (std::size_t cell = 0; cell < kTimes; cell += out.cells_each) {
    const double here = sum_of(octave.counts, cell, cell + out.cells_each);
    if (here < 0.5 * usual) continue;
    out.root.push_back(std::sqrt(sum_of(octave.magnitudes, cell, cell + out.cells_each) / here));
    out.cell.push_back(cell);
  }
  if (out.root.size() < kFewestTimes) return out = {};
  // The mean magnitude of n normal variables has relative variance (pi / 2 - 1) / n; its square root has a
  // quarter of that.
  const double each = 0.25 * (0.5708 + 2.0 * (1.0 - share)) / share;
  const double least = std::sqrt(each / usual) * median(out.root);
  if (!(least > 0.0)) return {};
  out.deviation = least;
  for (const std::size_t together : {1U, 2U, 4U})
    out.deviation = std::max(out.deviation, deviation_by(out.root, together));
  return out;
}

// Mean of roots begin … end - 1 minus the mean of all others, in standard deviations.
double departure(const NoiseLevel& of, std::size_t begin, std::size_t end, const std::vector<double>& sums) {
  const auto all = static_cast<double>(of.root.size()), here = static_cast<double>(end - begin);
  const double inside = sums[end] - sums[begin];
  return (inside / here - (sums.back() - inside) / (all - here)) /
         (of.deviation * std::sqrt(1.0 / here + 1.0 / (all - here)));
}

std::vector<double> sums_of(const NoiseLevel& of) {
  std::vector<double> sums{0.0};
  for (const double root : of.root) sums.push_back(sums.back() + root);
  return sums;
}

// Roots of an octave whose cells lie within [begin, end).
std::pair<std::size_t, std::size_t> times_within(const NoiseLevel& of, std::size_t begin, std::size_t end) {
  const auto first = std::ranges::lower_bound(of.cell, begin);
  const auto last = std::lower_bound(first, of.cell.end(), end);
  return {static_cast<std::size_t>(first - of.cell.begin()),
          static_cast<std::size_t>(last - of.cell.begin())};
}

// Ratio of the deviations inside and outside.
double level_ratio(const NoiseLevel& of, std::size_t begin, std::size_t end,
                   const std::vector<double>& sums) {
  const auto all = static_cast<double>(of.root.size()), here = static_cast<double>(end - begin);
  const double inside = (sums[end] - sums[begin]) / here;
  const double outside = (sums.back() - sums[end] + sums[begin]) / (all - here);
  return std::clamp(std::pow(inside / std::max(outside, 1e-300), 2.0), 1.0 / kMostRatio, kMostRatio);
}

bool material(double times) { return times > kMaterial || times < 1.0 / kMaterial; }

struct Found {
  std::size_t begin = 0, end = 0;  // cells
  std::size_t octave = 0;
  double departure = 0.0;
};

Found surest(const std::vector<NoiseLevel>& all) {
  Found best;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const NoiseLevel& of = all[k];
    const std::vector<double> sums = sums_of(of);
    for (std::size_t begin = 0; begin < of.root.size(); ++begin)
      for (std::size_t end = begin + 1; end <= of.root.size(); ++end) {
        // At most half, so the shorter part is the changed one; and not across missing samples.
        const bool hole = end - begin > 1 && of.cell[end - 1] != of.cell[end - 2] + of.cells_each;
        if (hole || 2 * (end - begin) > of.root.size()) break;
        const double here = std::abs(departure(of, begin, end, sums));
        if (here <= std::abs(best.departure) || !material(level_ratio(of, begin, end, sums))) continue;
        best = {of.cell[begin], of.cell[end - 1] + of.cells_each, k, here};
      }
  }
  return best;
}

NoiseChange described(const Found& found, const std::vector<NoiseLevel>& all, double period_s) {
  NoiseChange out;
  const auto changed = [&](std::size_t k) {
    // Neighbouring octaves contain part of the change.
    const auto [begin, end] = times_within(all[k], found.begin, found.end);
    if (begin == end || end - begin == all[k].root.size()) return 0.0;
    const std::vector<double> sums = sums_of(all[k]);
    const double times = level_ratio(all[k], begin, end, sums);
    return std::abs(departure(all[k], begin, end, sums)) > kAlso && material(times) ? times : 0.0;
  };
  out.times = changed(found.octave);
  std::size_t quickest = found.octave, slowest = found.octave;
  const bool higher = out.times > 1.0;
  const auto like = [&](std::size_t k) { return changed(k) > 0.0 && (changed(k) > 1.0) == higher; };
  while (quickest > 0 && like(quickest - 1)) --quickest;
  while (slowest + 1 < all.size() && like(slowest + 1)) ++slowest;
  for (std::size_t k = quickest; k <= slowest; ++k)
    out.times = higher ? std::max(out.times, changed(k)) : std::min(out.times, changed(k));
  const double nyquist = 0.5 / period_s;
  out.range_hz = {slowest + 1 < all.size() ? std::ldexp(nyquist, -static_cast<int>(slowest) - 1) : 0.0,
                  std::ldexp(nyquist, -static_cast<int>(quickest))};
  return out;
}

void leave_out(const Found& found, std::vector<NoiseLevel>& all) {
  for (NoiseLevel& of : all) {
    const auto [begin, end] = times_within(of, found.begin - std::min(found.begin, 2 * of.cells_each - 1),
                                           found.end + of.cells_each);
    of.root.erase(of.root.begin() + static_cast<std::ptrdiff_t>(begin),
                  of.root.begin() + static_cast<std::ptrdiff_t>(end));
    of.cell.erase(of.cell.begin() + static_cast<std::ptrdiff_t>(begin),
                  of.cell.begin() + static_cast<std::ptrdiff_t>(end));
    if (of.root.size() < kFewestTimes) of = {};
  }
}

}  // namespace

std::vector<NoiseChange> noise_changes(std::span<const double> rate_radps, std::span<const Stretch> parts,
                                       double period_s, const std::function<double(std::size_t)>& time_s) {
  Pyramid pyramid(std::max<std::size_t>(1, rate_radps.size()));
  for (const Stretch& part : parts) {
    pyramid.begin();
    for (std::size_t i = part.begin; i < part.end; ++i) pyramid.take(rate_radps[i], i);
  }
  std::vector<NoiseLevel> all;
  for (const Octave& octave : pyramid.octaves()) all.push_back(noise_level_of(octave));
  while (!all.empty() && all.back().root.empty()) all.pop_back();
  std::vector<NoiseChange> changes;
  while (changes.size() < kMostChanges) {
    const Found found = surest(all);
    if (found.departure < kSurely) break;
    changes.push_back(described(found, all, period_s));
    changes.back().from_s = time_s(found.begin * rate_radps.size() / kTimes);
    changes.back().to_s = time_s(std::min(rate_radps.size() - 1, found.end * rate_radps.size() / kTimes));
    leave_out(found, all);
  }
  std::ranges::sort(changes, {}, &NoiseChange::from_s);
  return changes;
}

std::string in_words(std::span<const NoiseChange> changes) {
  if (changes.empty()) return {};
  std::string words = "the noise is not the same along the record:";
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const NoiseChange& change = changes[i];
    const std::string from = told_time(change.from_s), to = told_time(change.to_s);
    words += i > 0 ? "," : "";
    words += formatted(" %.2g times the noise in ", change.times) + from + " … " + to + " s";
    words += change.range_hz.low > 0.0
                 ? formatted(" (%.2g to %.3g Hz)", change.range_hz.low, change.range_hz.high)
                 : formatted(" (below %.3g Hz)", change.range_hz.high);
  }
  return words + "; the figures are of the whole record, choose a part by --from and --to";
}

}  // namespace ifog
