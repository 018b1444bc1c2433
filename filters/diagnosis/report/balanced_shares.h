// SPDX-License-Identifier: Apache-2.0
// What effects explain and what stays unexplained are shares of one variance: together they are no more than
// all of it.
#pragma once

#include <cstddef>

#include "filters/diagnosis/diagnosis.h"

namespace ifog {

// Parts of effects that run against each other, or against slow noise, are together more than they take away.
// Lowers the shares of the first `jointly` effects in proportion, down to what the unexplained leaves; those
// behind are shares of single samples.
void balance_shares(std::size_t jointly, Diagnosis& diagnosis);

}  // namespace ifog
