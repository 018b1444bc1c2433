// SPDX-License-Identifier: Apache-2.0
// Powers above one are extrapolated by their tangent, or by the power itself if its curvature is well known.
// This parameter of the effect gives how far, in the channel's unit of that power; then the tangent continues
// as for other forms (reach.h).
#pragma once

#include <string_view>

namespace ifog {

inline constexpr std::string_view kCurveReach = "curve_reach";

}  // namespace ifog
