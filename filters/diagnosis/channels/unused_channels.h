// SPDX-License-Identifier: Apache-2.0
// Columns that a diagnosis cannot use, so that nobody takes their silence for a finding.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/record/blocks.h"

namespace ifog {

// One sentence naming the channels that are not in every record, have no value, or never change; empty when
// all are of use. `ramps`: channels that an effect has been made of already, and that are in no block.
std::string unused_channels(const std::vector<Record>& records, const BlockData& data,
                            const std::vector<std::string>& ramps);

}  // namespace ifog
