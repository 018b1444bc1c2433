// SPDX-License-Identifier: Apache-2.0
// Measures given effects on captures regardless of their significance: estimate, standard error, and gain of
// likelihood. Statistics of a sensor population need insignificant effects as well.
//
// Preparation and regression are those of diagnose(): for each set of effects the noise model is fitted
// again, generalised least squares on the innovations, coefficients averaged over the possible noise. Time
// constants are fixed. Rate-dependent effects count from the bias that the effects leave.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"

namespace ifog {

struct EffectsToMeasure {
  std::vector<Effect> together;  // fitted jointly; only the time constants of their parameters are used
  // For each effect of `together`, alternatives that are tried in its place. One entry per effect, or none.
  std::vector<std::vector<Effect>> instead;
  // The sensor's other effects, fitted too: a step only in captures that can contain it, a line in none.
  std::vector<Effect> others;
  // From the sensor's model. They give how early its channels are; the daemon waits for those.
  std::vector<ChannelRange> ranges = {};
};

struct MeasuredEffect {
  Effect effect;                  // coefficient and its standard error in its parameters
  double likelihood_ratio = 0.0;  // loss of twice the log-likelihood without it, with the noise fitted again
  std::string not_measured;       // reason; empty if it was measured
  std::vector<double> instead;    // likelihood ratios of the alternatives; 0 if not measured
};

struct MeasuredEffects {
  std::vector<MeasuredEffect> together;
  std::vector<Effect> others;      // those with one coefficient that were fitted too
  std::vector<double> covariance;  // of the coefficients of `together`, then of `others`; row-major
  std::vector<double> means;       // of the rate for a coefficient of one, in the same order
  std::vector<ChannelRange> ranges;
};

// axis is written into the effects. Throws std::invalid_argument as diagnose() does.
MeasuredEffects measure_effects(const std::vector<Record>& records, const EffectsToMeasure& wanted,
                                const std::string& axis, double significance = 0.01);

}  // namespace ifog
