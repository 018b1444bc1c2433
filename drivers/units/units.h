// SPDX-License-Identifier: Apache-2.0
// Unit texts as DBC files, configurations and the headers of CSV files write them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ifog {

// rad (for a rate: rad/s) per unit; nothing for a text that is no such unit. `bare_rate` lets a bare angle
// unit stand for "per second". Read are the spellings that DBC files hold: upper or lower case; the degree
// sign in UTF-8, Latin-1, Shift-JIS, GBK and CP949; µ; "/", "per" and "s^-1"; one pair of brackets around.
//
// Refused because two meanings are about: "grad" (a degree in German, where it has a capital, else 1/400 of a
// turn: "gon"), "1/s", "Hz" and "rps" (turns or radians), "Mrad" (milli or mega).
std::optional<double> angle_unit(std::string_view text, bool rate, bool bare_rate);

// Seconds per unit.
std::optional<double> time_unit(std::string_view text);

// value in the wanted unit = value as given * scale + offset
struct UnitConversion {
  double scale = 1.0, offset = 0.0;
};

// Between units of a channel: temperature, acceleration, voltage, current, magnetic flux density, pressure,
// angular rate, time, spelled as above; any unit to itself. Nothing between those of two quantities, or
// unknown ones.
std::optional<UnitConversion> convert_unit(std::string_view from, std::string_view wanted);
// Units of the quantity that `wanted` is of, for a message: "degC, degF, K"; "" for none that is known.
std::string units_beside(std::string_view wanted);

}  // namespace ifog
