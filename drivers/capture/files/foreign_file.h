// SPDX-License-Identifier: Apache-2.0
// Files of other programs that hold a gyro's data and are no text, and who makes one that can be read of them.
#pragma once

#include <string>
#include <string_view>

namespace ifog {

// What makes a candump log of a CAN log of another program, "" for what is none.
[[nodiscard]] std::string foreign_can_log(std::string_view head);

// What makes columns of a container of another program (a spreadsheet, MATLAB before 7.3, ROS, PX4, ArduPilot, NumPy),
// by its first bytes; "" for what is none.
[[nodiscard]] std::string foreign_container(std::string_view head);

}  // namespace ifog
