// SPDX-License-Identifier: Apache-2.0
// What speaks for a cause that was not logged, in sentences.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/checks/predicted_capture.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"

namespace ifog {

// Effects of one channel that a capture denies.
std::string denied_in_words(const std::vector<Effect>& effects, const DeniedEffects& denied,
                            const std::vector<Record>& records);

// Beside much that stays unexplained a channel that was logged may only run along with the cause; empty where
// little is, or no effect was traced to a channel. captures: diagnosed together.
std::string unexplained_beside_claims(const Diagnosis& diagnosis, std::size_t captures);

}  // namespace ifog
