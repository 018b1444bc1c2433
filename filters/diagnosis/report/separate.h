// SPDX-License-Identifier: Apache-2.0
// Which capture would tell two effects apart that this one cannot.
#pragma once

#include "filters/diagnosis/regression/candidates.h"

namespace ifog {

std::string capture_that_separates(const BlockData& data, const Candidate& one, const Candidate& other);

}  // namespace ifog
