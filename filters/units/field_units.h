// SPDX-License-Identifier: Apache-2.0
// Units of the field in SI: users see degrees and °/h, internally all is rad and rad/s. Divide to show,
// multiply to read: kDegreePerHour is 1 °/h in rad/s.
#pragma once

#include <numbers>

namespace ifog {

inline constexpr double kHour = 3600.0;                            // s
inline constexpr double kRootHour = 60.0;                          // √s
inline constexpr double kDegree = std::numbers::pi / 180.0;        // rad
inline constexpr double kArcsecond = kDegree / 3600.0;             // rad
inline constexpr double kDegreePerHour = kDegree / kHour;          // rad/s; bias, bias instability B
inline constexpr double kDegreePerRootHour = kDegree / kRootHour;  // rad/√s; angle random walk N
inline constexpr double kDegreePerHourPerRootHour =
    kDegreePerHour / kRootHour;                                          // rad/s/√s; rate random walk K
inline constexpr double kDegreePerHourPerHour = kDegreePerHour / kHour;  // rad/s²; rate ramp R

}  // namespace ifog
