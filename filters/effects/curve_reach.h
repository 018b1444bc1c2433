// SPDX-License-Identifier: Apache-2.0
// A power above one goes on beyond its range by its tangent. Where a fit saw the curvature well, the form
// itself is the better guess: a parameter of the effect says how far it is followed, in the unit of the
// channel of that power. From there on the tangent goes on as far as any other form does (see reach.h).
#pragma once

#include <string_view>

namespace ifog {

inline constexpr std::string_view kCurveReach = "curve_reach";

}  // namespace ifog
