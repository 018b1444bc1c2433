// Unit texts as DBC files and configurations write them.
#pragma once

#include <optional>
#include <string_view>

namespace ifog::dbc {

// rad (for a rate: rad/s) per unit. A rate needs "/s", "/min" or "/h" behind the angle, unless `bare_rate`
// lets a bare angle unit stand for "per second". Nothing for a text that is no such unit.
std::optional<double> angle_unit(std::string_view text, bool rate, bool bare_rate);

// Seconds per unit.
std::optional<double> time_unit(std::string_view text);

}  // namespace ifog::dbc
