// SPDX-License-Identifier: Apache-2.0
// Named effects measured on captures, whatever a search would say of them: estimate, standard error and what
// the likelihood gains. What a population of sensors is made of needs the ones below the threshold of a
// single diagnosis as well.
//
// The captures are prepared as diagnose() prepares them, and the regression is its own: the noise model
// fitted again under every set of effects, generalised least squares in its innovations, coefficients averaged
// over the noise that the captures allow. Time constants are as given. What depends on the rate counts from
// the bias that the effects leave, as in a diagnosis.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"

namespace ifog {

struct EffectsToMeasure {
  std::vector<Effect> together;  // in one fit; of their parameters the time constants count
  // By effect of `together`: others that are each tried in its place. As many entries, or none.
  std::vector<std::vector<Effect>> instead;
  // Other effects of the sensor, fitted along: a step only in the captures that can have it, a line in none.
  std::vector<Effect> beside;
  // Ranges of the sensor's own model, which say how early its channels are: the daemon waits for those.
  std::vector<ChannelRange> ranges = {};
};

struct MeasuredEffect {
  Effect effect;                  // coefficient and its standard error in its parameters
  double likelihood_ratio = 0.0;  // twice the log-likelihood lost without it, with the noise fitted again
  std::string not_measured;       // why; empty: it was
  std::vector<double> instead;    // likelihood ratios of the others in its place, 0 where not measured
};

struct MeasuredEffects {
  std::vector<MeasuredEffect> together;
  std::vector<Effect> beside;      // those of one coefficient that were fitted along
  std::vector<double> covariance;  // of the coefficients of all measured, then of `beside`; row-major
  std::vector<ChannelRange> ranges;
};

// axis: written into the effects. Throws std::invalid_argument as diagnose() does.
MeasuredEffects measure_effects(const std::vector<Record>& records, const EffectsToMeasure& wanted,
                                const std::string& axis, double significance = 0.01);

}  // namespace ifog
