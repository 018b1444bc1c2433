// SPDX-License-Identifier: Apache-2.0
// Dates as text, for models, pages and learned noise.
#pragma once

#include <cstdint>
#include <string>

namespace ifog {

// Present wall clock time in UTC, ISO 8601: 2026-01-31T13:05:09Z.
std::string utc_now();
// The same for a time in seconds since 1970; form: of strftime().
std::string utc_text(std::int64_t seconds, const char* form = "%Y-%m-%dT%H:%M:%SZ");

}  // namespace ifog
