// SPDX-License-Identifier: Apache-2.0
// Units in DBC files, configurations and CSV headers.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ifog {

// rad (for a rate: rad/s) per unit; nullopt for other texts. bare_rate: a bare angle unit means "per second".
// Accepts the spellings of DBC files: any case; the degree sign in UTF-8, Latin-1, Shift-JIS, GBK and CP949;
// µ; "/", "per" and "s^-1"; one pair of brackets.
//
// Rejected as ambiguous: "grad" (degree in German if capitalised, else 1/400 turn: "gon"), "1/s", "Hz" and
// "rps" (turns or radians), "Mrad" (milli or mega).
std::optional<double> angle_unit(std::string_view text, bool rate, bool bare_rate);

// Seconds per unit.
std::optional<double> time_unit(std::string_view text);

// "runs 1000 times too slow (perhaps in us, expected ns)". runs: time by a clock in ns per true time; `right` for
// what a clock may err.
std::string clock_speed(double runs, const char* right = "");
// Of a clock that is refused at the right speed.
inline constexpr const char* kRightButJumps = "is right on average but jumps with nearly every sample";

// value in the wanted unit = value * scale + offset
struct UnitConversion {
  double scale = 1.0, offset = 0.0;
};

// Conversion between units of a channel: temperature, acceleration, voltage, current, magnetic flux density,
// pressure, angular rate, time, spelled as above; identity for any unit. nullopt for different quantities or
// unknown units.
std::optional<UnitConversion> convert_unit(std::string_view from, std::string_view wanted);
// From a stated unit to the one in which a column's name ends; identity, with a line in `remark`, if that is not
// known.
UnitConversion convert_to_column(std::string_view stated, std::string_view column, std::string& remark);
// Units of the quantity of `wanted`, for messages: "degC, degF, K"; "" if unknown.
std::string other_units(std::string_view wanted);

}  // namespace ifog
