// SPDX-License-Identifier: Apache-2.0
// The project's diagnosis, which sees only captures.
#pragma once

#include "tests/bench/undeclared/scoring.h"

namespace ifog::undeclared {

Diagnose project_diagnosis();

// A record for the diagnosis; it refers to the capture.
ifog::Record record_of(const Capture& capture, const std::string& name, std::size_t axis = 0);

// A found effect with its correction by the daemon's compensator.
Claim claim_of(const Effect& effect, const std::vector<ChannelRange>& ranges,
               const std::vector<Capture>& diagnosed);

}  // namespace ifog::undeclared
