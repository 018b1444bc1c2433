// SPDX-License-Identifier: Apache-2.0
// Result of the search for the report: effects with parameters and errors, covariance, fitted ranges, and
// equivalent alternatives.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/regression/uncertainty.h"
#include "filters/diagnosis/residual/lines.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

struct Findings {
  std::vector<FoundEffect> effects;      // in the order of `chosen`
  std::vector<Eigen::VectorXd> parts;    // of each, rad/s by block
  std::vector<Indistinguishable> pairs;  // of the effects
};

// Takes coefficients, time constants and errors from `joint`. data: channels as they were read.
Findings findings_of(const BlockData& data, const SearchResult& found, const JointFit& joint,
                     const std::string& axis);

Effect effect_with(const BlockData& data, const Candidate& candidate, double coefficient,
                   const std::string& axis);

// Row-major, of all parameters of all effects: first those of `joint`, the others without correlation.
std::vector<double> covariance_of(const std::vector<FoundEffect>& effects, const JointFit& joint,
                                  const BlockGrid& grid, std::size_t jointly);

// Diagnosis::means. of_chosen: means of the regressors of the first effects, zero if not corrected.
std::vector<double> means_of_corrections(const std::vector<FoundEffect>& effects,
                                         const std::vector<ChannelRange>& ranges,
                                         const Eigen::VectorXd& of_chosen);

std::vector<ChannelRange> ranges_of(const BlockData& data, const std::vector<FoundEffect>& effects);

// Joint fit of the chosen effects; updates `found`.
JointFit settle(const BlockData& reconstructed, SearchResult& found);

}  // namespace ifog
