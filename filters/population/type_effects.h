// SPDX-License-Identifier: Apache-2.0
// From what single gyros show to the effects that their type may have, to be measured on all of them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/model_file/model.h"

namespace ifog {

struct FoundInGyro {
  std::size_t gyro = 0;
  Effect effect;  // as its own diagnosis wrote it
};

// One effect of the type, under each form that it was found in: what is a lag in one gyro is linear in
// another, where the noise hides the difference. The form most gyros took it for comes first.
struct TypeCandidate {
  std::vector<Effect> forms;  // coefficient zero; time constants: the median of those found
  std::size_t found_in = 0;   // gyros that show one of them by themselves
};

// The least number of gyros that chance makes show something wrong no oftener than once in 1 / chance such
// populations, when it makes one gyro do so with that chance.
std::size_t least_repeats(std::size_t gyros, double chance);

// Effects that more gyros show than false alarms at this significance explain, the most frequent first.
// Forms of one channel (or pair of channels) on one axis stand for each other, unless gyros show both at once
// again and again. Only what a correction of the next capture can use: no events, lines or tables.
std::vector<TypeCandidate> type_candidates(std::span<const FoundInGyro> found, std::size_t gyros,
                                           double significance);

// Whether a gyro's own effect is this one, under whichever form.
bool is_of(const TypeCandidate& candidate, const Effect& effect);

}  // namespace ifog
