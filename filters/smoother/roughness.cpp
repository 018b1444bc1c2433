// SPDX-License-Identifier: Apache-2.0
#include "filters/smoother/roughness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "filters/smoother/third_difference.h"

namespace ifog {
namespace {

// Third differences: whose median says something, of how many, and the samples that one may go over.
constexpr std::size_t kLeastThirds = 12, kShareOfThirds = 16, kMostSpan = 64;
// Median of the square of a standard normal.
constexpr double kMedianSquare = 0.4549364;

// Variance from the median square; where half of the differences are zero (coarse quantisation), from the
// mean of the lower nine tenths instead.
double robust_variance(std::vector<double>& squares) {
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  if (*middle > 0.0) return *middle / kMedianSquare;
  const auto kept = static_cast<std::ptrdiff_t>(squares.size() * 9 / 10);
  std::nth_element(squares.begin(), squares.begin() + kept, squares.end());
  double sum = 0.0;
  for (auto it = squares.begin(); it != squares.begin() + kept; ++it) sum += *it;
  return sum / static_cast<double>(kept);
}

}  // namespace

double roughness(std::span<const double> rate, std::span<const double> steps) {
  std::array<std::vector<double>, kMostSpan + 1> by_span;
  std::array<double, 4> rates{};
  std::array<double, 3> apart{};
  double since = 0.0;
  std::size_t known = 0, all = 0;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    since += steps.empty() ? 1.0 : std::max(1.0, std::round(steps[i]));
    if (!std::isfinite(rate[i])) continue;
    rates = {rates[1], rates[2], rates[3], rate[i]};
    apart = {apart[1], apart[2], std::exchange(since, 0.0)};
    const double span = apart[0] + apart[1] + apart[2];
    if (++known < rates.size() || span > kMostSpan) continue;
    ++all;
    by_span[static_cast<std::size_t>(span)].push_back(third_difference_square(rates, apart));
  }
  std::vector<double> squares;
  for (const std::vector<double>& more : by_span) {
    squares.insert(squares.end(), more.begin(), more.end());
    if (squares.size() >= std::max<std::size_t>(kLeastThirds, all / kShareOfThirds))
      return robust_variance(squares);
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace ifog
