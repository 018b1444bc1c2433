// SPDX-License-Identifier: Apache-2.0
// Sentences on what a diagnosis did not use and why.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filters/diagnosis/checks/predicted_capture.h"
#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {

// Effect that increases an error in the daemon's correction.
std::string harmful_in_words(const Effect& effect, bool by_chance);

// Effects of one channel that a capture refutes.
std::string denied_in_words(const std::vector<Effect>& effects, const DeniedEffects& denied,
                            const std::vector<Record>& records);

// Warns that a channel may only be correlated with the cause, if much stays unexplained. Empty if little does
// or no effect uses a channel. captures: number diagnosed together.
std::string unexplained_despite_claims(const Diagnosis& diagnosis, std::size_t captures);

// Names the values of channels for which bias and scale factor are given although the captures are far from them. Empty
// without a reference rate, or if every capture reaches them.
std::string far_zeros_in_words(const Diagnosis& diagnosis);

// Throws std::invalid_argument if the rate is as many times the reference as another sign or unit makes it.
void refuse_other_unit(const Diagnosis& diagnosis);

// Sentence on a record that turns while more than a twentieth of the variance of its 1 s means is not the
// reference's; empty if none does.
std::string unlike_reference_in_words(const std::vector<Record>& records,
                                      const std::vector<EvenError>& errors, double sample_s);

// Sentence on the channels that cannot be used: not in every record, without a value, or constant; empty if
// there is none. ramps: effects that already use channels.
std::string unused_channels(const std::vector<Record>& records, const BlockData& data,
                            const std::vector<FoundEffect>& ramps);

}  // namespace ifog
