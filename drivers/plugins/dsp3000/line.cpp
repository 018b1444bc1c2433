// SPDX-License-Identifier: Apache-2.0
#include "drivers/plugins/dsp3000/line.h"

#include <cstdio>
#include <cstdlib>

namespace ifog::dsp3000 {

std::optional<Reading> parse_line(std::string_view line) noexcept {
  constexpr std::size_t kWholeDigits = 3, kDecimals = 6;
  const auto skip_blanks = [&] {
    while (line.starts_with(' ')) line.remove_prefix(1);
  };
  skip_blanks();
  const bool negative = line.starts_with('-');
  if (negative) line.remove_prefix(1);
  const std::size_t point = line.find('.'), number = point + 1 + kDecimals;
  if (point < 1 || point > kWholeDigits || line.size() <= number || line[number] != ' ') return {};
  std::int32_t value = 0;
  for (std::size_t i = 0; i < number; ++i) {
    if (i == point) continue;
    if (line[i] < '0' || line[i] > '9') return {};
    value = value * 10 + (line[i] - '0');
  }
  line.remove_prefix(number);
  skip_blanks();
  const bool valid = line.starts_with('1');
  if (!valid && !line.starts_with('0')) return {};
  line.remove_prefix(1);
  skip_blanks();
  if (!line.empty()) return {};
  return Reading{negative ? -value : value, valid};
}

std::size_t format_line(const Reading& reading, char* out) noexcept {
  constexpr std::int32_t kMicro = 1'000'000;
  const std::int32_t size = std::abs(reading.micro_degrees);
  return static_cast<std::size_t>(std::snprintf(out, kLongestLine, "%s%d.%06d %d\r\n",
                                                reading.micro_degrees < 0 ? "-" : "", size / kMicro,
                                                size % kMicro, reading.valid ? 1 : 0));
}

}  // namespace ifog::dsp3000
