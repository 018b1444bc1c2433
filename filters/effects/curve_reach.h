// SPDX-License-Identifier: Apache-2.0
// A power above one is extrapolated by its tangent. Where a fit saw the curvature well, the form
// itself is the better guess: a parameter of the effect says how far it is followed, in the unit of the
// channel of that power. From there on the tangent is extrapolated as far as any other form (see reach.h).
#pragma once

#include <string_view>

namespace ifog {

inline constexpr std::string_view kCurveReach = "curve_reach";

}  // namespace ifog
