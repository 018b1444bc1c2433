// SPDX-License-Identifier: Apache-2.0
#include "filters/population/robust.h"

#include <algorithm>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <iterator>

namespace ifog {

RobustSpread robust_spread(std::span<const double> values) {
  using boost::math::statistics::median;
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite), [](double value) { return std::isfinite(value); });
  if (finite.empty()) return {};
  const double middle = median(finite);
  for (double& value : finite) value = std::abs(value - middle);
  return {middle, 1.4826 * median(finite)};
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
