// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace ifog::bench {

// Fraction of steps of 5 B that can be found within ten minutes without each kind of knowledge that a daemon
// lacks. Prints one line per kind of noise with `word` in its name; `blocks` without a step set the
// thresholds.
void print_limits(std::size_t blocks, unsigned seed, const std::string& word);

}  // namespace ifog::bench
