// SPDX-License-Identifier: Apache-2.0
// What a diagnosis did not use and why, and what it judged besides, in sentences.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filters/diagnosis/checks/predicted_capture.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {

// One that the daemon's own run judged.
std::string harmful_in_words(const Effect& effect);

// Effects of one channel that a capture denies.
std::string denied_in_words(const std::vector<Effect>& effects, const DeniedEffects& denied,
                            const std::vector<Record>& records);

// Says that a channel that was logged may only run along with the cause, where much stays unexplained. Empty
// where little does, or no effect was traced to a channel. captures: diagnosed together.
std::string unexplained_beside_claims(const Diagnosis& diagnosis, std::size_t captures);

// Columns that a diagnosis cannot use, so that nobody takes their silence for a finding.
// One sentence naming the channels that are not in every record, have no value, or never change; empty when
// all are of use. `ramps`: channels that an effect has been made of already, and that are in no block.
std::string unused_channels(const std::vector<Record>& records, const BlockData& data,
                            const std::vector<std::string>& ramps);

}  // namespace ifog
