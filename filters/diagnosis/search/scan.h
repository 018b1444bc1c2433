// SPDX-License-Identifier: Apache-2.0
// Scores of the whole library at once: for a spread of noise models around the present one every column is
// whitened, the effects already chosen are projected out, and what is left of each column is regressed on
// what is left of the measurement. The best noise model counts for each candidate separately: the noise
// fitted without an effect has already swallowed part of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/regression/noise_fit.h"
#include "filters/diagnosis/regression/whitening.h"

namespace ifog {

struct Scored {
  Candidate candidate;
  std::optional<Candidate> with;  // of a natural pair the second
  double ratio = 0.0;             // twice the log-likelihood gained
  NoiseShape shape;               // the noise model at which it gains that
  double correlation = 0.0;       // with the effect it is compared to, if any
};

class Scan {
 public:
  Scan(const BlockData& data, std::vector<Candidate> candidates);

  [[nodiscard]] std::size_t size() const { return candidates_.size(); }

  // Further candidates; those of a shape that is there already are skipped.
  void add(const std::vector<Candidate>& more);

  // thorough: the full spread of noise models; otherwise a few of them.
  // With `pairs` these follow the candidates, in their order.
  [[nodiscard]] std::vector<Scored> score(const std::vector<Candidate>& base, const NoiseFit& noise,
                                          bool thorough, const Candidate* compared = nullptr,
                                          const NoiseShape* at = nullptr, bool pairs = false) const;

  // Natural pairs whose both effects are in the library; none given: no pairs.
  void pair(const std::vector<NaturalPair>& pairs);
  [[nodiscard]] std::size_t pairs() const { return pairs_.size(); }

  // The most likely positions of a step of the rate, one a record at most.
  [[nodiscard]] std::vector<Scored> steps(const std::vector<Candidate>& base, const NoiseFit& noise) const;

 private:
  void fill(std::size_t candidate);
  struct Projected {
    Eigen::VectorXd y;
    Columns columns;
    double square;
  };
  [[nodiscard]] Projected project(const std::vector<Candidate>& base, const NoiseShape& shape,
                                  const Columns& candidates) const;

  const BlockData& data_;
  std::vector<Candidate> candidates_;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs_;  // of candidates
  Columns columns_;
};

// How many independent tries a search over correlated candidates amounts to. Counting every column and every
// position of a step would ask for far more than chance can do, and effects that are there would be missed.
// The noise is fitted again under each candidate, from a record that holds few of its longest swings: chance
// then exceeds a likelihood ratio more often than with known noise. Of some 1500 simulated sensors without
// effects 0.7 % had one found at a level of 1 % with a factor of 3, so that a tenth of all samples of a
// thousand would have had more than 1 %.
inline constexpr double kProfiled = 5.0;

// Probability that chance makes twice the log-likelihood gained by so many parameters of what is not there
// reach `ratio` (chi-square of that many degrees of freedom, 1 or 2).
double tail(double ratio, int parameters);

// Neighbours among lags, powers and products of a channel correlate above 0.9: of so many columns a third is
// new.
inline double independent_columns(std::size_t columns) {
  return std::max(1.0, 0.3 * static_cast<double>(columns));
}

}  // namespace ifog
