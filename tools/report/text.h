// SPDX-License-Identifier: Apache-2.0
// Numbers and text for people: HTML escaping, significant digits, the field's units.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "filters/units/field_units.h"

namespace ifog::report {

// UTF-8 characters, not bytes.
inline std::size_t characters_in(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

// Escapes any text for HTML and XML.
std::string escaped(std::string_view text);

// `digits` significant digits, without exponent where readable: "0.0108", "440", "3.1 × 10⁻⁷".
std::string number(double value, int digits = 3);

// "1.20 × 10⁶": with `decimals` decimals and the given power of ten, which is omitted if 0.
std::string at_power(double value, int decimals, int power);

// value ± its standard error, both to the error's second digit: "−79.20 ± 0.15".
std::string with_error(double value, double std_error);

std::vector<double> scaled(std::vector<double> values, double scale);

// "2.1 h", "35 min", "12 s".
std::string duration(double seconds);

// Best scale and unit for a time axis of this length.
struct TimeUnit {
  double seconds;
  const char* name;
};
TimeUnit time_unit(double span_s);

}  // namespace ifog::report
