// SPDX-License-Identifier: Apache-2.0
// The names of a capture's columns, and the form of messages about them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

// The axis of a rate column: "rate_radps" is "", "rate_x_radps" is "x". False: not such a column.
bool axis_of(const std::string& name, std::string_view prefix, std::string& axis);

// A rate or its reference, of any axis.
bool is_rate_column(const std::string& name);

// A rate of the sensor that the user did not choose: other_rate_y_radps. Rest is judged on it too.
bool is_other_rate(const std::string& name);

// What `ifog denoise` writes: raw_radps, compensated_x_radps, denoised_x_radps.
bool is_signal_column(const std::string& name);

// "'a', 'b'", for a message.
std::string listed(const std::vector<std::string>& names);

// Shortest text that reads back the same.
std::string shortest(double value);

// Throws std::runtime_error: "PATH:LINE: WHAT"; without the line where it is 0, as of a file that has none.
[[noreturn]] void fail_at(const std::string& path, std::size_t line, const std::string& what);
// The complaint about a column that was chosen without a unit and whose own name says another than was wanted.
std::string unit_by_name(const std::string& header, const std::string& unit, const std::string& option);

}  // namespace ifog
