// SPDX-License-Identifier: Apache-2.0
// Matrices of as many states as a model has, up to kMaxStates, without an allocation. Slower than those whose
// size the compiler knows, and compiled once instead of once for each number of states.
#pragma once

#include <Eigen/Core>

#include "filters/state_models/state_model.h"

namespace ifog {

using FewStatesMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxStates, kMaxStates>;
using FewStatesVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxStates, 1>;

}  // namespace ifog
