// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/fractional_shift.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

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

}  // namespace

Samples shifted(std::span<const double> values, double steps) {
  const double whole = std::floor(steps);
  const double fraction = steps - whole;
  const Kernel kernel = kernel_at(fraction);
  const auto n = static_cast<std::ptrdiff_t>(values.size());
  const auto from = static_cast<std::ptrdiff_t>(whole);
  const auto at = [&](std::ptrdiff_t i) {
    return i >= 0 && i < n ? values[static_cast<std::size_t>(i)] : std::numeric_limits<double>::quiet_NaN();
  };
  Samples out(values.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t here = i + from;
    double sum = 0.0;
    if (here >= kHalf - 1 && here + kHalf < n) {
      const double* const first = values.data() + (here - kHalf + 1);
      for (std::size_t k = 0; k < kernel.size(); ++k) sum += kernel[k] * first[k];
    } else {
      sum = std::numeric_limits<double>::quiet_NaN();
    }
    if (std::isnan(sum))
      sum = fraction == 0.0 ? at(here) : (1.0 - fraction) * at(here) + fraction * at(here + 1);
    out[static_cast<std::size_t>(i)] = sum;
  }
  return out;
}

}  // namespace ifog
