// SPDX-License-Identifier: Apache-2.0
// A channel that was logged late or early against the rate. It is reported, and mended in the logger.
#pragma once

#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/candidates.h"

namespace ifog {

// Values of the channel as they would have been logged without that delay; linear between fine steps, held at
// the ends of a record.
void undo_delay(const BlockGrid& grid, double delay_s, FineChannel& channel);

// Channels of the model whose delay, within 60 s, makes the model far likelier with everything else unchanged.
// Delays below zero are early.
std::vector<ChannelDelay> delayed_channels(const BlockData& data, const std::vector<Candidate>& model,
                                           const NoiseShape& shape);

std::string delay_in_words(const ChannelDelay& delay);

}  // namespace ifog
