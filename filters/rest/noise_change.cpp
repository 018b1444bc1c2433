// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/noise_change.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "filters/distributions/median.h"
#include "filters/rest/held.h"
#include "filters/rest/runs.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kTimes = 64;
// Parts of a time whose middle ones count: an outlier spoils one or two.
constexpr std::size_t kFine = 4;
constexpr std::size_t kCells = kTimes * kFine;
constexpr std::size_t kMostOctaves = 40;
// Coefficients in a time at least; with fewer times of twice the length an octave is looked at in those.
constexpr double kFewest = 8.0;
constexpr std::size_t kFewestTimes = 8;
// From so many coefficients on a time is parted, else an outlier in it is one of few and counts.
constexpr double kParted = 32.0;
// A departure, over its standard deviation, that the noise of one octave has in any of the two thousand
// stretches in fewer than one record of two thousand: as simulated, tests/bench/allan.
constexpr double kSurely = 5.2;
// Change of the deviation. Less is of no consequence.
constexpr double kMaterial = 1.25;
// Those octaves of a stretch that was found count as changed, too, in which it departs by this.
constexpr double kAlso = 3.0;
constexpr std::size_t kMostChanges = 3;
// A coefficient counts for so many times the usual one at most, of normal noise's one in fifteen thousand;
// the usual one is the mean of so many.
constexpr double kMostTimes = 5.0;
constexpr double kUsual = 128.0;
// Relative difference below which two values are the same: their rounding. Most neighbours of a coarse sensor are
// the same; what is usual is said by those that are not.
constexpr double kRoundedAway = 1e-13;
// Beyond, what is loud or quiet stands against next to nothing.
constexpr double kMostLoud = 1e6;
// A step of so many usual ones is a spike if it is back within so many samples.
constexpr double kSpike = 10.0;
constexpr int kMostReplaced = 3;

// Sums of the magnitudes of one octave's coefficients by the time they are at. Not of their squares, which
// noise with long tails has no mean of that would settle; for normal noise that costs an eighth of what they
// say.
struct Octave {
  std::array<double, kCells> magnitudes{}, counts{};
  double beyond_rounding = 0.0;  // so many of them all
};

// Scaling coefficients go in one by one, every second one brings a wavelet coefficient and a scaling
// coefficient of the next octave. Daubechies, "Ten Lectures on Wavelets" (1992), table 6.1, N = 2.
class Pyramid {
 public:
  explicit Pyramid(std::size_t samples) : samples_(samples) {}

  // A new stretch begins.
  void begin() {
    levels_ = {};
    replaced_ = 0;
  }
  void take(double rate, std::size_t at) {
    double value = despiked(rate);
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
  [[nodiscard]] const std::vector<Octave>& octaves() const { return octaves_; }

 private:
  // A few samples far beyond what neighbours differ by are the one before them: in slow octaves, of which a
  // time has few coefficients, a spike would be loud noise.
  double despiked(double rate) {
    const double step = std::abs(rate - accepted_);
    const bool first = levels_[0].count == 0;
    if (!first && steps_ >= kParted && step > kSpike * usual_step_ && replaced_ < kMostReplaced) {
      ++replaced_;
      return accepted_;
    }
    replaced_ = 0;
    accepted_ = rate;
    if (first || step <= kRoundedAway * std::abs(rate)) return rate;
    steps_ = std::min(steps_ + 1.0, kUsual);
    usual_step_ +=
        over(std::min(step, kSpike * std::max(usual_step_, over(step, steps_))) - usual_step_, steps_);
    return rate;
  }

  // value / count, of which there are kUsual nearly always: a power of two, by which the product is the
  // quotient to the bit.
  static double over(double value, double count) {
    constexpr double kPart = 1.0 / kUsual;
    return count == kUsual ? value * kPart : value / count;
  }

  struct Level {
    std::array<double, 4> last{};
    std::size_t count = 0;
    std::size_t cell = 0, cell_end = 0;  // of the last coefficient; where the next one begins, 0 at first
    double usual = 0.0, met = 0.0;       // mean magnitude of its coefficients beyond rounding, over so many
  };
  // (1 - sqrt 3, sqrt 3 - 3, 3 + sqrt 3, -1 - sqrt 3) / (4 sqrt 2).
  static constexpr std::array<double, 4> kHigh{-0.12940952255126037, -0.22414386804201339,
                                               0.83651630373780790, -0.48296291314453414};

  void add(std::size_t octave, std::size_t at, double coefficient, double rounding) {
    if (octave >= octaves_.size()) octaves_.resize(octave + 1);
    // It reaches back over three of its octave's lengths: half of that.
    const std::size_t place = at - std::min(at, std::size_t{3} << octave);
    Level& level = levels_[octave];
    if (place >= level.cell_end) {
      level.cell = std::min(kCells - 1, place * kCells / samples_);
      level.cell_end = (level.cell + 1) * samples_ / kCells + ((level.cell + 1) * samples_ % kCells != 0);
    }
    const std::size_t cell = level.cell;
    octaves_[octave].counts[cell] += 1.0;
    if (std::abs(coefficient) <= rounding) return;
    octaves_[octave].beyond_rounding += 1.0;
    // An outlier counts for no more than what is rare; what stays loud soon is the usual.
    level.met = std::min(level.met + 1.0, kUsual);
    const double magnitude = level.met < kFewest ? std::abs(coefficient)
                                                 : std::min(std::abs(coefficient), kMostTimes * level.usual);
    level.usual += over(magnitude - level.usual, level.met);
    octaves_[octave].magnitudes[cell] += magnitude;
  }

  std::size_t samples_;
  double accepted_ = 0.0, usual_step_ = 0.0, steps_ = 0.0;
  int replaced_ = 0;
  std::array<Level, kMostOctaves> levels_{};
  std::vector<Octave> octaves_;
};

// Square roots of the mean magnitudes of one octave by time, nearly normal.
struct Loudness {
  std::vector<double> root;        // of the times that have coefficients enough
  std::vector<std::size_t> cell;   // where each begins, kCells a record
  double deviation = 0.0;          // of one of them while the noise is the same
  std::size_t cells_each = kFine;  // of a time
};

double count_of(const Octave& octave, std::size_t begin, std::size_t end) {
  double count = 0.0;
  for (std::size_t i = begin; i < end; ++i) count += octave.counts[i];
  return count;
}

double mean_magnitude(const Octave& octave, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = begin; i < end; ++i) sum += octave.magnitudes[i];
  const double count = count_of(octave, begin, end);
  return count > 0.0 ? sum / count : 0.0;
}

// Mean of the middle two of the four quarters.
double middle_magnitude(const Octave& octave, std::size_t begin, std::size_t end) {
  std::array<double, kFine> quarters{};
  const std::size_t length = (end - begin) / kFine;
  for (std::size_t q = 0; q < kFine; ++q)
    if (!(count_of(octave, begin + q * length, begin + (q + 1) * length) > 0.0))
      return mean_magnitude(octave, begin, end);
  for (std::size_t q = 0; q < kFine; ++q)
    quarters[q] = mean_magnitude(octave, begin + q * length, begin + (q + 1) * length);
  std::sort(quarters.begin(), quarters.end());
  return 0.5 * (quarters[1] + quarters[2]);
}

// By what means of so many neighbouring times differ from the next ones, relative to one time, of which a change is a
// few: noise with long tails has more than normal noise, and a resonance that swells and fades over several
// times more in their means than in one.
double deviation_by(const std::vector<double>& root, std::size_t together) {
  if (root.size() < 8 * together) return 0.0;
  std::vector<double> sums{0.0}, steps;
  for (const double each : root) sums.push_back(sums.back() + each);
  for (std::size_t i = 0; i + 2 * together < sums.size(); ++i)
    steps.push_back(std::abs(sums[i + 2 * together] - 2.0 * sums[i + together] + sums[i]));
  constexpr double kNormal = 0.6745 * 1.4142;
  return median(steps) / kNormal / std::sqrt(static_cast<double>(together));
}

Loudness loudness_of(const Octave& octave) {
  const double count = octave.beyond_rounding, share = count / count_of(octave, 0, kCells);
  // Only a share of a coarse sensor's differences is not zero; how many varies, too, and they come in pairs: one
  // change of the value is in two of them.
  const double wanted = kFewest * (1.0 + 3.0 * (1.0 - share));
  Loudness out;
  std::size_t times = kTimes;
  while (times >= kFewestTimes && count < wanted * static_cast<double>(times)) times /= 2;
  if (times < kFewestTimes) return out;
  out.cells_each = kCells / times;
  std::vector<double> counts;
  for (std::size_t t = 0; t < times; ++t)
    if (const double here = count_of(octave, t * out.cells_each, (t + 1) * out.cells_each); here > 0.0)
      counts.push_back(here);
  // The usual number of values at a time without a hole.
  const double usual = median(counts);
  for (std::size_t t = 0; t < times; ++t) {
    const std::size_t begin = t * out.cells_each, end = begin + out.cells_each;
    if (count_of(octave, begin, end) < 0.5 * usual) continue;
    out.root.push_back(std::sqrt(usual < kParted ? mean_magnitude(octave, begin, end)
                                                 : middle_magnitude(octave, begin, end)));
    out.cell.push_back(begin);
  }
  if (out.root.size() < kFewestTimes) return out = {};
  constexpr double kOfMiddle = 1.3;  // variance of the mean of the middle two of four over that of all four
  // The mean magnitude of n normal variables has the relative variance (pi / 2 - 1) / n, its root a
  // quarter.
  const double each = 0.25 * (0.5708 + 2.0 * (1.0 - share)) / share;
  const double least = std::sqrt(each / usual * (usual < kParted ? 1.0 : kOfMiddle)) * median(out.root);
  if (!(least > 0.0)) return {};
  out.deviation = least;
  for (const std::size_t together : {1U, 2U, 4U})
    out.deviation = std::max(out.deviation, deviation_by(out.root, together));
  return out;
}

// Over its standard deviation: mean of the times begin … end - 1 less that of all others.
double departure(const Loudness& of, std::size_t begin, std::size_t end, const std::vector<double>& sums) {
  const auto all = static_cast<double>(of.root.size()), here = static_cast<double>(end - begin);
  const double inside = sums[end] - sums[begin];
  return (inside / here - (sums.back() - inside) / (all - here)) /
         (of.deviation * std::sqrt(1.0 / here + 1.0 / (all - here)));
}

std::vector<double> sums_of(const Loudness& of) {
  std::vector<double> sums{0.0};
  for (const double root : of.root) sums.push_back(sums.back() + root);
  return sums;
}

// The times of an octave whose cells lie within [begin, end).
std::pair<std::size_t, std::size_t> times_within(const Loudness& of, std::size_t begin, std::size_t end) {
  const auto first = std::lower_bound(of.cell.begin(), of.cell.end(), begin);
  const auto last = std::lower_bound(first, of.cell.end(), end);
  return {static_cast<std::size_t>(first - of.cell.begin()),
          static_cast<std::size_t>(last - of.cell.begin())};
}

// Deviation inside over outside.
double times_as_loud(const Loudness& of, std::size_t begin, std::size_t end,
                     const std::vector<double>& sums) {
  const auto all = static_cast<double>(of.root.size()), here = static_cast<double>(end - begin);
  const double inside = (sums[end] - sums[begin]) / here;
  const double outside = (sums.back() - sums[end] + sums[begin]) / (all - here);
  return std::clamp(std::pow(inside / std::max(outside, 1e-300), 2.0), 1.0 / kMostLoud, kMostLoud);
}

bool material(double times) { return times > kMaterial || times < 1.0 / kMaterial; }

struct Found {
  std::size_t begin = 0, end = 0;  // cells
  std::size_t octave = 0;
  double departure = 0.0;
};

Found surest(const std::vector<Loudness>& all) {
  Found best;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Loudness& of = all[k];
    const std::vector<double> sums = sums_of(of);
    for (std::size_t begin = 0; begin < of.root.size(); ++begin)
      for (std::size_t end = begin + 1; end <= of.root.size(); ++end) {
        // Half of them at most: of two parts the shorter one is distinguished from the rest. Not across a
        // hole.
        const bool hole = end - begin > 1 && of.cell[end - 1] != of.cell[end - 2] + of.cells_each;
        if (hole || 2 * (end - begin) > of.root.size()) break;
        const double here = std::abs(departure(of, begin, end, sums));
        if (here <= std::abs(best.departure) || !material(times_as_loud(of, begin, end, sums))) continue;
        best = {of.cell[begin], of.cell[end - 1] + of.cells_each, k, here};
      }
  }
  return best;
}

NoiseChange described(const Found& found, const std::vector<Loudness>& all, double period_s) {
  NoiseChange out;
  const auto changed = [&](std::size_t k) {
    // The neighbours have a part of it.
    const auto [begin, end] = times_within(all[k], found.begin, found.end);
    if (begin == end || end - begin == all[k].root.size()) return 0.0;
    const std::vector<double> sums = sums_of(all[k]);
    const double times = times_as_loud(all[k], begin, end, sums);
    return std::abs(departure(all[k], begin, end, sums)) > kAlso && material(times) ? times : 0.0;
  };
  out.times = changed(found.octave);
  std::size_t quickest = found.octave, slowest = found.octave;
  const bool louder = out.times > 1.0;
  const auto like = [&](std::size_t k) { return changed(k) > 0.0 && (changed(k) > 1.0) == louder; };
  while (quickest > 0 && like(quickest - 1)) --quickest;
  while (slowest + 1 < all.size() && like(slowest + 1)) ++slowest;
  for (std::size_t k = quickest; k <= slowest; ++k)
    out.times = louder ? std::max(out.times, changed(k)) : std::min(out.times, changed(k));
  const double nyquist = 0.5 / period_s;
  out.range_hz = {slowest + 1 < all.size() ? std::ldexp(nyquist, -static_cast<int>(slowest) - 1) : 0.0,
                  std::ldexp(nyquist, -static_cast<int>(quickest))};
  return out;
}

void leave_out(const Found& found, std::vector<Loudness>& all) {
  for (Loudness& of : all) {
    const auto [begin, end] = times_within(of, found.begin - std::min(found.begin, 2 * of.cells_each - 1),
                                           found.end + of.cells_each);
    of.root.erase(of.root.begin() + static_cast<std::ptrdiff_t>(begin),
                  of.root.begin() + static_cast<std::ptrdiff_t>(end));
    of.cell.erase(of.cell.begin() + static_cast<std::ptrdiff_t>(begin),
                  of.cell.begin() + static_cast<std::ptrdiff_t>(end));
    if (of.root.size() < kFewestTimes) of = {};
  }
}

// The longest of the held stretches that are no shorter than a time is.
std::vector<NoiseChange> stands_still(std::vector<Stretch> held, std::size_t samples, double period_s,
                                      const std::function<double(std::size_t)>& time_s) {
  std::erase_if(held, [&](const Stretch& each) { return each.size() * kTimes < samples; });
  std::sort(held.begin(), held.end(), [](const Stretch& a, const Stretch& b) { return a.size() > b.size(); });
  held.resize(std::min(held.size(), kMostChanges));
  std::vector<NoiseChange> out;
  out.reserve(held.size());
  for (const Stretch& each : held)
    out.push_back({time_s(each.begin), time_s(each.end - 1), 0.0, {0.0, 0.5 / period_s}});
  return out;
}

}  // namespace

std::vector<NoiseChange> noise_changes(const SeriesView& rate_radps, std::span<const Stretch> parts,
                                       double period_s, const std::function<double(std::size_t)>& time_s) {
  const HeldApart apart = apart_from_held(rate_radps, {parts.begin(), parts.end()});
  Pyramid pyramid(std::max<std::size_t>(1, rate_radps.size()));
  for (const Stretch& part : apart.moving) {
    pyramid.begin();
    for_each_piece(rate_radps, part.begin, part.end, [&](std::span<const double> values, std::size_t first) {
      for (std::size_t i = 0; i < values.size(); ++i) pyramid.take(values[i], first + i);
    });
  }
  std::vector<Loudness> all;
  for (const Octave& octave : pyramid.octaves()) all.push_back(loudness_of(octave));
  while (!all.empty() && all.back().root.empty()) all.pop_back();
  std::vector<NoiseChange> changes = stands_still(apart.held, rate_radps.size(), period_s, time_s);
  while (changes.size() < kMostChanges) {
    const Found found = surest(all);
    if (found.departure < kSurely) break;
    changes.push_back(described(found, all, period_s));
    changes.back().from_s = time_s(found.begin * rate_radps.size() / kCells);
    changes.back().to_s = time_s(std::min(rate_radps.size() - 1, found.end * rate_radps.size() / kCells));
    leave_out(found, all);
  }
  std::sort(changes.begin(), changes.end(),
            [](const NoiseChange& a, const NoiseChange& b) { return a.from_s < b.from_s; });
  return changes;
}

std::string in_words(std::span<const NoiseChange> changes) {
  if (changes.empty()) return {};
  std::string words = "the noise is not the same along the record:";
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const NoiseChange& change = changes[i];
    const std::string from = told_time(change.from_s), to = told_time(change.to_s);
    words += i > 0 ? "," : "";
    if (!(change.times > 0.0)) {
      words += " it stands still in " + from + " … " + to + " s";
      continue;
    }
    words += formatted(" %.2g times the noise in ", change.times) + from + " … " + to + " s";
    words += change.range_hz.low > 0.0
                 ? formatted(" (%.2g to %.3g Hz)", change.range_hz.low, change.range_hz.high)
                 : formatted(" (below %.3g Hz)", change.range_hz.high);
  }
  return words + "; the figures are of the whole record, choose a part by --from and --to";
}

}  // namespace ifog
