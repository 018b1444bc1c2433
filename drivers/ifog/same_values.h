// SPDX-License-Identifier: Apache-2.0
// Whether a frame brings what another one brought: also of axes that are not usable, whose value is no
// number.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace ifog {

inline bool same_value(double a, double b) noexcept { return a == b || (std::isnan(a) && std::isnan(b)); }

inline bool same_values(std::span<const double> a, std::span<const double> b) noexcept {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_value);
}

}  // namespace ifog
