// SPDX-License-Identifier: Apache-2.0
// The search of the diagnosis: score every candidate in the innovations of the noise model, take the one that
// also predicts held-out blocks, fit everything anew, until nothing passes.
#pragma once

#include <functional>

#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

struct Chosen {
  Candidate candidate;
  double likelihood_ratio = 0.0;  // twice the log-likelihood lost without it, noise fitted anew
  double p_value = 1.0;           // after correction for everything tried
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
  NoiseFit noise;          // with the chosen effects
  NoiseFit noise_without;  // without any
  Eigen::VectorXd
      coefficients;  // nuisances (one constant a record) first, then the columns of each chosen effect
  Eigen::MatrixXd covariance;  // of those
  // The same as the search fitted them to reconstructed channels; the ones above are brought to what was
  // read.
  std::vector<Candidate> fitted;
  Eigen::VectorXd fitted_coefficients;
  double tries = 1.0;  // independent ones of a channel's effect, over their share of the significance
};

std::vector<Candidate> candidates_of(const std::vector<Chosen>& chosen);

struct SearchOptions {
  double significance = 0.01;
  std::size_t most_effects = 8;
  std::function<void(std::size_t, std::size_t)> progress;
  std::vector<Candidate> given;  // lines, found elsewhere; in the fit from the start
};

// Twice the log-likelihood less what its effects' complexity costs: by which two searches compare.
double score_of(const SearchResult& result);

// data: channels as read; reconstructed: as with_reconstructed_channels() makes them of it. A warm-up has no
// channel to blame and fits whatever a record began with; where channels explain as much without it, it is
// theirs.
SearchResult search_effects(const BlockData& data, const BlockData& reconstructed,
                            const SearchOptions& options);

}  // namespace ifog
