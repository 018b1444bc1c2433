// SPDX-License-Identifier: Apache-2.0
// Light that reaches the detector by a second path, over a splice, a connector or the wrong polarisation,
// interferes with the rest, and the bias swings as the temperature changes the difference of the paths: a
// fringe of a period that no maker tells. Polynomials stand in for a few fringes where they were seen, badly,
// and go off where they were not.
#pragma once

#include <cstddef>
#include <optional>

#include "filters/diagnosis/search/refine.h"

namespace ifog {

struct Significance {
  double level = 0.01;
  double tries = 1.0;  // independent ones of the rest of the search
};

// `model` with a cosine and a sine of one temperature, of the likeliest period between a twelfth and four
// fifths of the range in which it was seen; beside its other effects from `first` on, or instead of its
// polynomials and transitions, whichever is likelier. None where that gains less than it costs, or than
// chance would with the periods tried, or where it does not tell held-out blocks.
std::optional<FittedModel> with_fringe(const BlockData& data, std::size_t first, const FittedModel& model,
                                       const Significance& significance);

}  // namespace ifog
