// SPDX-License-Identifier: Apache-2.0
#include "drivers/plugins/dsp3000/line.h"

namespace ifog::dsp3000 {
namespace {

constexpr std::size_t kWholeDigits = 3;
constexpr std::size_t kDecimals = 6;
constexpr std::int32_t kMicro = 1'000'000;

void skip_blanks(std::string_view& text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
}

// Removes leading digits; returns their number.
std::size_t take_digits(std::string_view& text, std::int32_t& value, std::size_t most) {
  std::size_t n = 0;
  while (n < most && !text.empty() && text.front() >= '0' && text.front() <= '9') {
    value = value * 10 + (text.front() - '0');
    text.remove_prefix(1);
    ++n;
  }
  return n;
}

}  // namespace

std::optional<Reading> parse_line(std::string_view line) noexcept {
  skip_blanks(line);
  const bool negative = !line.empty() && line.front() == '-';
  if (negative) line.remove_prefix(1);
  std::int32_t value = 0;
  if (take_digits(line, value, kWholeDigits) == 0 || line.empty() || line.front() != '.') return {};
  line.remove_prefix(1);
  if (take_digits(line, value, kDecimals) != kDecimals) return {};
  if (line.empty() || line.front() != ' ') return {};
  skip_blanks(line);
  if (line.empty() || (line.front() != '0' && line.front() != '1')) return {};
  const bool valid = line.front() == '1';
  line.remove_prefix(1);
  skip_blanks(line);
  if (!line.empty()) return {};
  return Reading{negative ? -value : value, valid};
}

std::size_t format_line(const Reading& reading, char* out) noexcept {
  char* at = out;
  const bool negative = reading.micro_degrees < 0;
  if (negative) *at++ = '-';
  std::int32_t rest = negative ? -reading.micro_degrees : reading.micro_degrees;
  std::int32_t unit = 100 * kMicro;
  for (; unit > 0; unit /= 10) {
    // Omits leading zeros except before the point.
    if (rest >= unit || unit <= kMicro || (at != out && at[-1] != '-'))
      *at++ = static_cast<char>('0' + rest / unit);
    rest %= unit;
    if (unit == kMicro) *at++ = '.';
  }
  for (const char c : {' ', reading.valid ? '1' : '0', '\r', '\n'}) *at++ = c;
  return static_cast<std::size_t>(at - out);
}

}  // namespace ifog::dsp3000
