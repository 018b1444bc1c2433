// SPDX-License-Identifier: Apache-2.0
// Which of the fitted models is written.
//
// The likelihood decides, and may be overruled only towards the random walk, on two grounds. A colour that
// forgets too slowly for the record to show that it forgets may be the walk itself or a line; and a model that
// is likelier may still put into its level what is noise, or into its colour what is level, as the likelihood
// only knows their sum. That shows in what the published rate says of measurements to come. How little the
// published rate moves does not show it: a constant moves least.
#pragma once

#include <cstddef>
#include <vector>

#include "filters/tune/tune.h"

namespace ifog {

// By how much the published rate of `model` foretells the held-out measurements worse than that of `walk`:
// ratio of the mean squares of Outcome::ahead, the geometric mean over axes and horizons.
[[nodiscard]] double prediction_against(const Outcome& model, const Outcome& walk);

// How often the slowest of the model's noise forgets itself within the record: 1 - |z| of its pole z next to
// the unit circle, times the samples. Infinite: no term but the level.
[[nodiscard]] double memories_in_record(const FilterSettings& settings, double period_s, double samples);

// The likeliest model with nothing against it; says why of those before it. models: by BIC; without a random
// walk among them the first is chosen. samples: of an axis.
[[nodiscard]] std::size_t choose(std::vector<TunedModel>& models, double period_s, double samples);

}  // namespace ifog
