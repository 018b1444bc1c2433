// SPDX-License-Identifier: Apache-2.0
// Effects that were fitted to samples and not to block means, outside the joint fit: ramps, a dead zone and
// lines.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/residual/dead_zone.h"
#include "filters/diagnosis/residual/lines.h"

namespace ifog {

// A dead zone with the true rates it was found in, by record, and the name of their column.
struct FoundZone {
  DeadZone zone;
  std::vector<Samples> rates;
  std::string channel;
};

// Ramps first, then the zone. errors: of the records they were found in.
std::vector<FoundEffect> sample_effects(const std::vector<RampFit>& ramps,
                                        const std::optional<FoundZone>& zone,
                                        const std::vector<LineOf>& lines,
                                        const std::vector<EvenError>& errors, const std::string& axis);

}  // namespace ifog
