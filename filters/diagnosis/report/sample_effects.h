// SPDX-License-Identifier: Apache-2.0
// Effects fitted to samples instead of block means, outside the joint fit: ramps, dead zone, lines.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/ramp/ramp.h"
#include "filters/diagnosis/residual/dead_zone.h"
#include "filters/diagnosis/residual/lines.h"

namespace ifog {

// A dead zone with the true rates, by record, and the name of their column.
struct FoundZone {
  DeadZone zone;
  std::vector<Samples> rates;
  std::string channel;
};

// Ramps first, then the zone, then lines. errors: of the records.
std::vector<FoundEffect> sample_effects(const std::vector<RampFit>& ramps,
                                        const std::optional<FoundZone>& zone,
                                        const std::vector<LineOf>& lines,
                                        const std::vector<EvenError>& errors, const std::string& axis);

}  // namespace ifog
