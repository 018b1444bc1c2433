// SPDX-License-Identifier: Apache-2.0
// Effects of a type to be measured on all gyros, selected from the effects of single gyros.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/model_file/model.h"

namespace ifog {

struct FoundInGyro {
  std::size_t gyro = 0;
  Effect effect;  // as written by its own diagnosis
};

// One effect of the type, in each form in which it was found (e.g. lagged in one gyro, linear in another
// because of noise). The most frequent form is first.
struct TypeCandidate {
  std::vector<Effect> forms;  // coefficient zero; time constants: medians
  std::size_t found_in = 0;   // number of gyros with one of the forms
};

// Smallest number of gyros with the same false effect that chance reaches in at most `chance` of all
// populations, if each gyro has it with that probability.
std::size_t least_repeats(std::size_t gyros, double chance);

// Effects that more gyros show than false alarms at this significance explain, most frequent first. Forms of
// one channel (or pair) on one axis are one effect, unless gyros repeatedly show both. Only effects that can
// be corrected in the next capture: no events, lines or tables.
std::vector<TypeCandidate> type_candidates(std::span<const FoundInGyro> found, std::size_t gyros,
                                           double significance);

// True if a gyro's effect is this one, in any form.
bool is_of(const TypeCandidate& candidate, const Effect& effect);

}  // namespace ifog
