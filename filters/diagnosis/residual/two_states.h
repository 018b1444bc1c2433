// SPDX-License-Identifier: Apache-2.0
// A bias that has two states and jumps between them (popcorn noise, random telegraph signal): no noise of a
// spectrum, which would move from one level to the next by all levels between.
#pragma once

#include <optional>
#include <span>

namespace ifog {

struct TwoStates {
  double difference = 0.0;           // between the levels, in the series' unit
  double low_s = 0.0, high_s = 0.0;  // mean stay
  std::size_t jumps = 0;
  double ratio = 0.0;  // twice the log-likelihood beyond a walk with white noise
};

// left: even steps of period_s, NaN missing. A hidden Markov chain of two levels with white noise (Baum and
// Welch) against a random walk with white noise, both at their greatest likelihood, over a thousand means.
// Nothing where the walk is as likely, the levels overlap, or there are fewer than four jumps.
std::optional<TwoStates> find_two_states(std::span<const double> left, double period_s);

}  // namespace ifog
