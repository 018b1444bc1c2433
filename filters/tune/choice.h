// SPDX-License-Identifier: Apache-2.0
// Choice of the model to be written.
//
// The likelihood decides, and may be overruled only in favour of the random walk, for two reasons. The
// correlation of a term may be too slow for the record to distinguish it from a walk or a line. And a more
// likely model may divide level and noise wrongly, since the likelihood depends only on their sum; then its
// published rate predicts the measurements worse. (Small motion of the published rate is no criterion: a
// constant moves least.)
#pragma once

#include <cstddef>
#include <vector>

#include "filters/tune/tune.h"

namespace ifog {

// Prediction error of `model` relative to `walk` on held-out data: ratio of the mean squares of
// Outcome::ahead, geometric mean over axes and horizons.
[[nodiscard]] double prediction_against(const Outcome& model, const Outcome& walk);

// Record length in memories of the model's slowest noise: 1 - |z| of its pole z next to the unit circle,
// times the samples. Infinite without noise terms.
[[nodiscard]] double memories_in_record(const FilterSettings& settings, double period_s, double samples);

// Index of the most likely model without an objection; sets the reasons of those before it. models: by BIC;
// without a random walk the first is chosen. samples: per axis.
[[nodiscard]] std::size_t choose(std::vector<TunedModel>& models, double period_s, double samples);

}  // namespace ifog
