// SPDX-License-Identifier: Apache-2.0
// Search of the diagnosis: basic effects first, then a loop that adds, swaps and removes effects by one score
// in the innovations of the noise model, with the noise fitted each time. An added effect must also predict
// held-out blocks.
#pragma once

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/design.h"

namespace ifog {

struct Chosen {
  Candidate candidate;
  double coefficient = 0.0, std_error = 0.0;
  double likelihood_ratio = 0.0;  // loss of twice the log-likelihood without it, with the noise fitted again
  double p_value = 1.0;           // corrected for the number of tries
  bool of_a_law = false;          // one of two coefficients of one law; see natural_pairs()
};

struct Alternative {
  std::size_t of;  // index of the chosen effect that it could replace
  Candidate candidate;
  double correlation;  // of the whitened regressors, all others projected out
  double loss;         // loss of twice the log-likelihood if it replaces that effect
};

struct SearchResult {
  std::vector<Chosen> chosen;
  std::vector<Alternative> alternatives;
  NoiseFit noise;
  double tries = 1.0;  // number of independent tries of channel effects / their share of the significance
};

std::vector<Candidate> candidates_of(const std::vector<Chosen>& chosen);
Eigen::VectorXd coefficients_of(const std::vector<Chosen>& chosen);

// Fits the coefficients of the chosen effects under the noise found.
void fit_coefficients(const BlockData& data, SearchResult& found);

// data: with channels from with_reconstructed_channels(). noise: start value, of an earlier search, or nullptr.
SearchResult search_effects(const BlockData& data, const DiagnoseOptions& options,
                            const NoiseShape* noise = nullptr);

}  // namespace ifog
