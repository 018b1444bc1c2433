// SPDX-License-Identifier: Apache-2.0
// The project's own diagnosis, seeing captures only.
#pragma once

#include "tests/bench/undeclared/scoring.h"

namespace ifog::undeclared {

Diagnose project_diagnosis();

// A capture as the diagnosis takes it; the capture stays with the caller.
ifog::Record record_of(const Capture& capture, const std::string& name, std::size_t axis = 0);

// A found effect with its correction, by the compensator that the daemon runs.
Claim claim_of(const Effect& effect, const std::vector<ChannelRange>& ranges,
               const std::vector<Capture>& diagnosed);

}  // namespace ifog::undeclared
