// SPDX-License-Identifier: Apache-2.0
// Channel that was logged late or early relative to the rate. It is reported; the logger must be corrected.
#pragma once

#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/candidates.h"

namespace ifog {

// Shifts the channel to its values without the delay: linear between fine steps, constant at the ends of a
// record.
void undo_delay(const BlockGrid& grid, double delay_s, FineChannel& channel);

// Delays, within ±60 s, of channels of the model that make the model far more likely, with everything else
// unchanged. Negative: early.
std::vector<ChannelDelay> delayed_channels(const BlockData& data, const std::vector<Candidate>& model,
                                           const NoiseShape& shape);

std::string delay_in_words(const ChannelDelay& delay);

}  // namespace ifog
