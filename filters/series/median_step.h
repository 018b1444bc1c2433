// SPDX-License-Identifier: Apache-2.0
// Usual step of a column of times.
#pragma once

#include <span>

namespace ifog {

// Exact median of the differences of neighbours, in constant memory; of an even number the upper one. Needs
// two values or more, not decreasing, without NaN.
[[nodiscard]] double median_step(std::span<const double> series);

}  // namespace ifog
