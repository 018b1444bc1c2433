// SPDX-License-Identifier: Apache-2.0
// Numbers and words for people: HTML escaping, significant digits, the field's units.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "filters/units/field_units.h"

namespace ifog::report {

// Of UTF-8, not bytes: ° takes two.
inline std::size_t characters_in(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

// With blanks behind it, to this many characters.
inline std::string padded(std::string text, std::size_t width) {
  if (const std::size_t characters = characters_in(text); characters < width)
    text.append(width - characters, ' ');
  return text;
}

// For HTML and XML, whatever the text holds.
std::string escaped(std::string_view text);

// `digits` significant digits, no exponent where it reads well without: "0.0108", "440", "3.1 × 10⁻⁷".
std::string number(double value, int digits = 3);

// "1.20 × 10⁶": so many decimals, and a power of ten that is given; without it where that is 0.
std::string at_power(double value, int decimals, int power);

// value ± its standard error, both to the error's second digit: "−79.20 ± 0.15".
std::string with_error(double value, double std_error);

// Every value times `scale`: a column in the unit that it is shown in.
std::vector<double> scaled(std::vector<double> values, double scale);

// "2.1 h", "35 min", "12 s".
std::string duration(double seconds);

// The scale and name a time axis of this length is best read in.
struct TimeUnit {
  double seconds;
  const char* name;
};
TimeUnit time_unit(double span_s);

}  // namespace ifog::report
