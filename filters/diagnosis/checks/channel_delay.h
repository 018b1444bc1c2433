// SPDX-License-Identifier: Apache-2.0
// A channel that was logged late: the effect is there before its cause; or early, so that what leaps in it
// leaps later in the rate, which no lag does.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "filters/diagnosis/regression/candidates.h"

namespace ifog {

struct DelayOfChannel {
  std::size_t channel = 0;
  double delay_s = 0.0;      // late by; below zero: early
  double std_error_s = 0.0;  // by where the likelihood has fallen by one half
  double gain = 0.0;         // twice the log-likelihood, over no delay
};

// Values of the channel as they would have been logged without that delay; linear between fine steps, held at
// the ends of a record.
void undo_delay(const BlockGrid& grid, double delay_s, FineChannel& channel);

// Of all channels the one whose delay within 60 s gains most, beside the model's other effects. For a channel
// that the model does not use an effect of its own is looked for, and every product of it that the search
// knows: with the rate, through a temperature, behind a switch, with what has an effect. None where no delay
// gains anything.
std::optional<DelayOfChannel> most_delayed_channel(const BlockData& data, const std::vector<Candidate>& model,
                                                   const NoiseShape& shape);

}  // namespace ifog
