// SPDX-License-Identifier: Apache-2.0
#include "filters/population/robust.h"

#include <algorithm>
#include <cmath>

namespace ifog {
namespace {

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace

RobustSpread robust_spread(std::span<const double> values) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](double value) { return std::isfinite(value); });
  RobustSpread spread;
  spread.median = median_of(finite);
  for (double& value : finite) value = std::abs(value - spread.median);
  spread.sigma = 1.4826 * median_of(std::move(finite));
  return spread;
}

std::vector<double> robust_z(std::span<const double> values, std::span<const double> errors) {
  const RobustSpread spread = robust_spread(values);
  const double typical = robust_spread(errors).median;
  const double from_member_to_member = std::max(0.0, spread.sigma * spread.sigma - typical * typical);
  std::vector<double> z;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double own = errors.empty() || !std::isfinite(errors[i]) ? 0.0 : errors[i];
    const double sigma = std::max(spread.sigma, std::sqrt(from_member_to_member + own * own));
    z.push_back(!std::isfinite(values[i]) ? values[i]
                : spread.sigma > 0.0      ? (values[i] - spread.median) / sigma
                                          : 0.0);
  }
  return z;
}

}  // namespace ifog
