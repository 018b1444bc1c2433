// SPDX-License-Identifier: Apache-2.0
// The search's result as a report tells it: effects with parameters and their errors, the covariance, the
// ranges they were fitted on, and which alternatives fit as well.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/regression/uncertainty.h"
#include "filters/diagnosis/residual/lines.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

struct Findings {
  std::vector<FoundEffect> effects;      // as in `chosen`
  std::vector<Eigen::VectorXd> parts;    // rad/s by block, of each
  std::vector<Indistinguishable> pairs;  // of them
};

// Coefficients, time constants and their errors from `joint`. reconstructed: the reconstructed channels.
Findings findings_of(const BlockData& data, const BlockData& reconstructed, const SearchResult& found,
                     const JointFit& joint, const std::string& axis);

// Effects by their coefficients alone, of which the constants come first.
std::vector<Effect> effects_of(const BlockData& data, const std::vector<Candidate>& candidates,
                               const Eigen::VectorXd& coefficients, const std::string& axis);

// Row-major, of all parameters of all effects; the first ones are those of `joint`, the others stand alone.
std::vector<double> covariance_of(const std::vector<FoundEffect>& effects, const JointFit& joint,
                                  Eigen::Index nuisances, std::size_t jointly);

std::vector<ChannelRange> ranges_of(const BlockData& data, const std::vector<FoundEffect>& effects);

// The joint fit of what the search chose, put into `found`.
JointFit settle(const BlockData& reconstructed, SearchResult& found);

}  // namespace ifog
