// SPDX-License-Identifier: Apache-2.0
// Whether a frame brings what another one brought: also of axes that are not usable, whose value is no
// number.
#pragma once

#include <cmath>

namespace ifog {

inline bool same_value(double a, double b) noexcept { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace ifog
