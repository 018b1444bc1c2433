// SPDX-License-Identifier: Apache-2.0
// Names of a capture's columns, and message format for columns.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

// Axis of a rate column: "" for "rate_radps", "x" for "rate_x_radps". False for other columns.
bool axis_of(const std::string& name, std::string_view prefix, std::string& axis);

// A rate or reference rate of any axis.
bool is_rate_column(const std::string& name);

// A rate of the sensor that the user did not choose: other_rate_y_radps. Used to detect rest.
bool is_other_rate(const std::string& name);

// Output of `ifog denoise`: raw_radps, compensated_x_radps, denoised_x_radps.
bool is_signal_column(const std::string& name);

// "'a', 'b'", for messages.
std::string listed(const std::vector<std::string>& names);
// Message for columns of which none is a rate.
std::string no_rate_among(const std::vector<std::string>& names);

// Shortest text that reads back exactly.
std::string shortest(double value);
void append_shortest(std::string& out, double value);

// Throws std::runtime_error "PATH:LINE: WHAT"; without LINE if it is 0.
[[noreturn]] void fail_at(const std::string& path, std::size_t line, const std::string& what);

}  // namespace ifog
