// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/fractional_shift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace ifog {
namespace {

constexpr int kHalf = 12;
using Kernel = std::array<double, 2 * kHalf>;  // of the steps -kHalf + 1 … kHalf

Kernel kernel_at(double fraction) {
  Kernel kernel{};
  double sum = 0.0;
  for (int k = 0; k < 2 * kHalf; ++k) {
    const double x = fraction - static_cast<double>(k - kHalf + 1);
    const double angle = std::numbers::pi * x;
    const double sinc = std::abs(x) < 1e-12 ? 1.0 : std::sin(angle) / angle;
    const double window = std::abs(x) < kHalf ? 0.5 + 0.5 * std::cos(angle / kHalf) : 0.0;
    kernel[static_cast<std::size_t>(k)] = sinc * window;
    sum += kernel[static_cast<std::size_t>(k)];
  }
  for (double& weight : kernel) weight /= sum;  // what stands still stays where it is
  return kernel;
}

double value_at(std::span<const double> values, std::ptrdiff_t i) {
  return i >= 0 && i < static_cast<std::ptrdiff_t>(values.size()) ? values[static_cast<std::size_t>(i)]
                                                                  : std::numeric_limits<double>::quiet_NaN();
}

double between(std::span<const double> values, std::ptrdiff_t here, double fraction, const Kernel& kernel) {
  double sum = std::numeric_limits<double>::quiet_NaN();
  if (here >= kHalf - 1 && here + kHalf < static_cast<std::ptrdiff_t>(values.size())) {
    const double* const first = values.data() + (here - kHalf + 1);
    sum = 0.0;
    for (std::size_t k = 0; k < kernel.size(); ++k) sum += kernel[k] * first[k];
  }
  if (!std::isnan(sum)) return sum;
  if (fraction == 0.0) return value_at(values, here);
  return (1.0 - fraction) * value_at(values, here) + fraction * value_at(values, here + 1);
}

}  // namespace

Samples shifted(std::span<const double> values, double steps) {
  const double whole = std::floor(steps);
  const double fraction = steps - whole;
  const Kernel kernel = kernel_at(fraction);
  Samples out(values.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = between(values, static_cast<std::ptrdiff_t>(i) + static_cast<std::ptrdiff_t>(whole), fraction,
                     kernel);
  return out;
}

}  // namespace ifog
