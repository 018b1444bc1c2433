// The date that models and pages bear.
#pragma once

#include <string>

namespace ifog::tools {

// Now by the wall clock, in UTC, as ISO 8601: 2026-01-31T13:05:09Z.
std::string utc_now();

}  // namespace ifog::tools
