// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/abrupt_reference.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace ifog {
namespace {

// A jump has six times itself as its fourth difference, white noise 8.4 times its deviation.
constexpr double kJumpOfFourth = 50.0;  // deviations of the noise: a jump of eight
constexpr std::size_t kRings = 12;      // samples on either side: half the width of the interpolation
constexpr double kMostOfJumps = 0.25;
// Of what is smooth against the samples the fourth difference is a small part of the second; of a jump or a
// kink it is twice to six times that.
constexpr double kRough = 1.0;
constexpr std::size_t kEnough = 50000;  // steps, to tell the noise by

// Of one sample, from neighbours: the median of what they differ by.
double noise_beside_reference(const Samples& reference, std::span<const double> rate) {
  std::vector<double> steps;
  const std::size_t stride = std::max<std::size_t>(1, rate.size() / kEnough);
  for (std::size_t i = 1; i < rate.size(); i += stride) {
    const double step = (rate[i] - reference[i]) - (rate[i - 1] - reference[i - 1]);
    if (std::isfinite(step)) steps.push_back(std::abs(step));
  }
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle / (0.6745 * std::sqrt(2.0));
}

}  // namespace

std::size_t leave_out_jumps(Samples& reference, std::span<const double> rate) {
  const std::size_t n = reference.size();
  const double noise = noise_beside_reference(reference, rate);
  if (n < 5 || !(noise > 0.0)) return 0;
  std::vector<std::uint8_t> out(n, 0);
  const Samples& x = reference;
  for (std::size_t i = 2; i + 2 < n; ++i) {
    const double fourth = std::abs(x[i - 2] - 4.0 * x[i - 1] + 6.0 * x[i] - 4.0 * x[i + 1] + x[i + 2]);
    if (!(fourth > kJumpOfFourth * noise)) continue;
    double second = 0.0;
    for (std::size_t k = i - 1; k <= i + 1; ++k)
      second = std::max(second, std::abs(x[k - 1] - 2.0 * x[k] + x[k + 1]));
    if (fourth < kRough * second) continue;
    std::fill(out.begin() + static_cast<std::ptrdiff_t>(i < kRings ? 0 : i - kRings),
              out.begin() + static_cast<std::ptrdiff_t>(std::min(n, i + kRings + 1)), std::uint8_t{1});
  }
  const auto count = static_cast<std::size_t>(std::count(out.begin(), out.end(), std::uint8_t{1}));
  if (static_cast<double>(count) > kMostOfJumps * static_cast<double>(n)) return 0;
  for (std::size_t i = 0; i < n; ++i)
    if (out[i]) reference[i] = std::nan("");
  return count;
}

}  // namespace ifog
