// SPDX-License-Identifier: Apache-2.0
// The date that models, pages and learned noise bear.
#pragma once

#include <ctime>
#include <string>

namespace ifog {

// Now by the wall clock, in UTC, as ISO 8601: 2026-01-31T13:05:09Z.
inline std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::string text(32, '\0');
  text.resize(std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc));
  return text;
}

}  // namespace ifog
