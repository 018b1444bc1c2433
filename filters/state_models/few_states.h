// SPDX-License-Identifier: Apache-2.0
// Matrices of up to kMaxStates states without allocation. Slower than fixed sizes, but compiled once.
#pragma once

#include <Eigen/Core>

#include "filters/state_models/state_model.h"

namespace ifog {

using FewStatesMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxStates, kMaxStates>;
using FewStatesVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxStates, 1>;

}  // namespace ifog
