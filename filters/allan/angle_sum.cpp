// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/angle_sum.h"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "filters/allan/deviation.h"
#include "filters/allan/runs.h"
#include "filters/linear/exact_sum.h"

namespace ifog {
namespace {

// m σ²(m) at 1, 2, 4, … samples.
std::vector<double> levels_of(const AngleSum& sum, Deviation kind) {
  std::vector<std::size_t> m;
  for (std::size_t each = 1; each == 1 || 16 * each <= sum.longest(); each *= 2) m.push_back(each);
  std::vector<double> levels;
  for (const DeviationPoint& point : deviation(sum, m, kind))
    levels.push_back(static_cast<double>(point.m) * point.variance);
  return levels;
}

// Mean of as many samples as are lost on either side of the hole before `after`.
double mean_around(std::span<const double> rate, std::size_t end, const Stretch& after) {
  double sum = 0.0;
  for (std::size_t i = 0; i < after.lost; ++i) sum += rate[end - 1 - i] + rate[after.begin + i];
  return sum / (2.0 * static_cast<double>(after.lost));
}

// True if the levels on both sides of a hole differ by more than noise does, as after a gyro was switched off and on.
// hadamard: m σ²(m) at 1, 2, 4, … samples; the m with the least variance is used.
bool steps_over(std::span<const double> rate, const Stretch& before, const Stretch& after,
                std::span<const double> hadamard) {
  constexpr double kSure = 50.0;  // times that variance; the difference of two means of white noise has 2
  double least = std::numeric_limits<double>::infinity();
  std::size_t m = 1;
  for (std::size_t k = 0; k < hadamard.size() && std::size_t{1} << k <= std::min(before.size(), after.size());
       ++k)
    if (const double variance = std::ldexp(hadamard[k], -static_cast<int>(k)); variance < least)
      least = variance, m = std::size_t{1} << k;
  double step = 0.0;
  for (std::size_t i = 0; i < m; ++i) step += rate[after.begin + i] - rate[before.end - 1 - i];
  step /= static_cast<double>(m);
  return step * step > kSure * least;
}

// Of the white part of the noise.
double least_level(const AngleSum& sum) { return std::ranges::min(levels_of(sum, Deviation::kAllan)); }

}  // namespace

// Stretches without `lost` where the hole is not to be filled.
//
// The mean of h samples on either side replaces h samples. Its error e in their angle is half a third difference, of
// variance 3/2 h² times the Hadamard variance at h. It is in 2m of the n differences of averages over m, so one hole
// adds 2m e² / (2 m² n) to σ²(m), and all holes add the part Σe² / (n m σ²(m)): at most Σe² / n of the least m σ²(m).
// For white noise that is 1.5 times the share of filled samples; averages shorter than a hole lose at most that share.
std::vector<Stretch> AngleSum::negligible(std::span<const double> rate_radps,
                                          std::span<const Stretch> stretches) {
  constexpr double kMost = 0.02;  // of a variance; of the samples
  std::vector<Stretch> apart(stretches.begin(), stretches.end());
  std::vector<std::size_t> holes;  // the shortest first
  for (std::size_t i = 0; i < apart.size(); ++i)
    if (const std::size_t lost = std::exchange(apart[i].lost, 0);
        lost > 0 && lost <= std::min(apart[i - 1].size(), apart[i].size()))
      holes.push_back(i);
  if (holes.empty()) return apart;
  std::ranges::stable_sort(holes, {}, [&](std::size_t i) { return stretches[i].lost; });
  const AngleSum sum(rate_radps, apart, Holes::kFilled);
  const double most = kMost * static_cast<double>(sum.samples());
  // A line has no error where h is a multiple of its period; so the largest one up to h counts.
  std::vector<double> variance = levels_of(sum, Deviation::kHadamard);
  std::erase_if(holes,
                [&](std::size_t i) { return steps_over(rate_radps, apart[i - 1], apart[i], variance); });
  for (std::size_t k = 0; k < variance.size(); ++k)
    variance[k] =
        std::max(1.5 * static_cast<double>(std::size_t{1} << k) * variance[k], k > 0 ? variance[k - 1] : 0.0);
  for (double level = least_level(sum);;) {
    std::vector<Stretch> chosen = apart;
    double added = 0.0, filled = 0.0;
    for (const std::size_t i : holes) {
      const std::size_t lost = stretches[i].lost, octave = std::bit_width(lost - 1);
      if (octave >= variance.size()) break;
      added += variance[octave], filled += static_cast<double>(lost);
      if (!(added <= most * level && filled <= most)) break;
      chosen[i].lost = lost;
    }
    const double here = least_level(AngleSum(rate_radps, chosen, Holes::kFilled));
    if (!(here < level)) return chosen;
    level = here;  // longer averages show less noise
  }
}

AngleSum::AngleSum(std::span<const double> rate_radps, std::span<const Stretch> stretches, Holes holes) {
  std::vector<Stretch> chosen;
  if (holes == Holes::kFilledIfNegligible) stretches = chosen = negligible(rate_radps, stretches);
  double sum = 0.0;
  std::size_t total = 0;
  for (const Stretch& s : stretches) {
    sum +=
        Eigen::Map<const Eigen::ArrayXd>(s.of(rate_radps).data(), static_cast<Eigen::Index>(s.size())).sum();
    total += s.size();
  }
  mean_ = total > 0 ? sum / static_cast<double>(total) : 0.0;
  constexpr std::size_t kSome = 100'000;
  for (const Stretch& s : stretches.first(std::min<std::size_t>(1, stretches.size()))) {
    const Stretch some{s.begin, std::min(s.end, s.begin + kSome)};
    held_ = held_samples(rate_radps, {&some, 1});
  }
  for (const Stretch& s : stretches) total += 1 + s.lost;
  angle_.reserve(total);
  sum_up(rate_radps, stretches);
}

void AngleSum::sum_up(std::span<const double> rate_radps, std::span<const Stretch> stretches) {
  ExactSum sum;
  // The error of the rounded mean is a constant, which a second difference cancels.
  const auto add = [&](double rate) {
    sum.add(rate - mean_);
    angle_.push_back(sum.value());
  };
  for (const Stretch& s : stretches) {
    if (s.lost == 0) {
      parts_.push_back({angle_.size(), 1});
      sum = {};
      angle_.push_back(0.0);
    }
    const double fill = s.lost == 0 ? 0.0 : mean_around(rate_radps, (&s)[-1].end, s);
    for (std::size_t i = 0; i < s.lost; ++i) add(fill);
    for (const double rate : s.of(rate_radps)) add(rate);
    parts_.back().angles += s.lost + s.size();
    filled_ += s.lost;
  }
}

std::size_t AngleSum::longest() const {
  return parts_.empty() ? 0 : std::ranges::max(parts_, {}, &Part::angles).angles - 1;
}

}  // namespace ifog
