// SPDX-License-Identifier: Apache-2.0
// The search of the diagnosis: basics first, then one loop that adds, swaps and removes effects by one score
// in the innovations of the noise model, each fitted together with the noise. What is added also has to predict
// held-out blocks.
#pragma once

#include <functional>
#include <optional>

#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

struct Chosen {
  Candidate candidate;
  double likelihood_ratio = 0.0;  // twice the log-likelihood lost without it, with the noise fitted again
  double p_value = 1.0;           // after correction for everything tried
  bool of_a_law = false;          // of two coefficients that are one law; see natural_pairs()
};

struct Alternative {
  std::size_t of;  // index of the chosen effect it could stand for
  Candidate candidate;
  double correlation;  // of the whitened regressors, all else projected out
  double loss;         // twice the log-likelihood lost by taking it instead
};

struct SearchResult {
  std::vector<Chosen> chosen;
  std::vector<Alternative> alternatives;
  NoiseFit noise;                // with the chosen effects
  Eigen::VectorXd coefficients;  // nuisances (one constant a record) first, then that of each chosen effect
  Eigen::MatrixXd covariance;    // of those
  double tries = 1.0;  // independent ones of a channel's effect, over their share of the significance
};

std::vector<Candidate> candidates_of(const std::vector<Chosen>& chosen);

struct SearchOptions {
  double significance = 0.01;
  std::size_t most_effects = 8;
  std::function<void(std::size_t, std::size_t)> progress;
  std::optional<NoiseShape> noise;  // of a search before, to begin with; none: from nothing known
};

// data: channels as with_reconstructed_channels() makes them.
SearchResult search_effects(const BlockData& data, const SearchOptions& options);

}  // namespace ifog
