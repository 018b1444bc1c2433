// SPDX-License-Identifier: Apache-2.0
// What an effect has to prove beyond its likelihood.
#pragma once

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// A model whose last effect is on trial, with the noise that belongs to it.
struct Claimed {
  const std::vector<Candidate>& model;
  const NoiseFit& noise;
};

// Whether the last effect's coefficient from the other folds makes the innovations of each fold smaller, all
// folds together. Constants and the effects before it are projected out on all blocks first.
bool predicts_held_out(const BlockData& data, const Claimed& claimed);

// A knock makes innovations like a step's, and what goes away and comes back those of two. A step is still
// there later: the means before and after differ by it, whatever other steps there are. And it is sudden: a
// change spread over a part of the record must not explain more.
bool step_persists(const BlockData& data, const Claimed& claimed);

}  // namespace ifog
