// SPDX-License-Identifier: Apache-2.0
// Dates as people are shown them, in models, pages and learned noise.
#pragma once

#include <cstdint>
#include <string>

namespace ifog {

// Now by the wall clock, in UTC, as ISO 8601: 2026-01-31T13:05:09Z.
std::string utc_now();
// The same of a time in seconds since 1970; `form`: of strftime().
std::string utc_text(std::int64_t seconds, const char* form = "%Y-%m-%dT%H:%M:%SZ");

}  // namespace ifog
