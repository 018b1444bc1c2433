// SPDX-License-Identifier: Apache-2.0
// Several captures of one sensor, each predicted by the others: of a channel that only ran along with the
// cause in one capture nothing is there in the next, and a correction by it makes that worse.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Effects that share a channel, for two of them may be one law.
struct DeniedEffects {
  std::vector<std::size_t> effects;  // ascending
  std::size_t record = 0;            // that denies them
  // Share of what the other captures predict that is present in this one. Below one half a correction leaves
  // more error than none does. NaN: they predict nothing certain, but their regressors move as much here as where
  // they are seen, and they are not.
  double share = 0.0, share_error = 0.0;
};

// The effects whose prediction is surely less than half there, by four standard errors; captures for which
// the others predict nothing that would be seen, or nothing certain, are asked whether they see anything.
// None with one record. data: reconstructed.
std::optional<DeniedEffects> denied_by_a_capture(const BlockData& data, const std::vector<Candidate>& effects,
                                                 const NoiseFit& noise);

}  // namespace ifog
