// SPDX-License-Identifier: Apache-2.0
// What a diagnosis left out and why, and what it judged beside, in sentences.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"

namespace ifog {

// Effects that do not hold on held-out data or all along the record.
std::string dropped_in_words(const std::vector<Effect>& dropped);

// One that the daemon's own run judged.
std::string harmful_in_words(const Effect& effect);

// Resonances and lines that move, of the noise; empty without any.
std::string judged_beside(std::size_t harmonics);

}  // namespace ifog
