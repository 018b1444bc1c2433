// SPDX-License-Identifier: Apache-2.0
// Dates as text, for models, pages and learned noise.
#pragma once

#include <cstdint>
#include <ctime>
#include <string>

namespace ifog {

// Time in seconds since 1970 in UTC, ISO 8601: 2026-01-31T13:05:09Z; form: of strftime().
inline std::string utc_text(std::int64_t seconds, const char* form = "%Y-%m-%dT%H:%M:%SZ") {
  const std::time_t time = seconds;
  std::tm utc{};
  gmtime_r(&time, &utc);
  std::string text(32, '\0');
  text.resize(std::strftime(text.data(), text.size(), form, &utc));
  return text;
}
// The same for the present wall clock time.
inline std::string utc_now() { return utc_text(std::time(nullptr)); }

}  // namespace ifog
