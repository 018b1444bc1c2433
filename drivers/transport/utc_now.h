// SPDX-License-Identifier: Apache-2.0
// The date that models, pages and learned noise bear.
#pragma once

#include <string>

namespace ifog {

// Now by the wall clock, in UTC, as ISO 8601: 2026-01-31T13:05:09Z.
std::string utc_now();

}  // namespace ifog
