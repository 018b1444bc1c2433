// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace ifog::bench {

// What of the steps of 5 B can be found within ten minutes with each piece of knowledge taken away that a
// daemon does not have, one line a kind of noise whose name has the word; `blocks` without a step set the
// thresholds.
void print_limits(std::size_t blocks, unsigned seed, const std::string& word);

}  // namespace ifog::bench
