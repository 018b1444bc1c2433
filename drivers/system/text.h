// SPDX-License-Identifier: Apache-2.0
// Text for people: dates in models, pages and learned noise, and printf(3) into a string of whatever length it takes.
#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>

namespace ifog {

// Now by the wall clock, in UTC, as ISO 8601: 2026-01-31T13:05:09Z.
std::string utc_now();
// The same of a time in seconds since 1970; `form`: of strftime().
std::string utc_text(std::int64_t seconds, const char* form = "%Y-%m-%dT%H:%M:%SZ");

inline std::string formatted_list(const char* format, std::va_list values) {
  std::va_list again;
  va_copy(again, values);
  const int length = std::vsnprintf(nullptr, 0, format, again);
  va_end(again);
  std::string out(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  std::vsnprintf(out.data(), out.size() + 1, format, values);
  return out;
}

[[gnu::format(printf, 1, 2)]] inline std::string formatted(const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  std::string out = formatted_list(format, values);
  va_end(values);
  return out;
}

}  // namespace ifog
