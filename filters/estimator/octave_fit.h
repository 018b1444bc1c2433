// SPDX-License-Identifier: Apache-2.0
// White noise and a random walk fitted to the second differences of block means, octave by octave, where the
// short octaves may be of another kind.
//
// White noise R and a walk of q dt = ratio R give the second difference of means of m samples the variance
// R (6 / m + ratio m). Most sensors' noise is not white from one sample to the next: an output filter makes
// neighbours alike, quantisation makes them unlike. Over blocks much longer than that it is white again, as
// loud as it is at low frequency, but the short octaves hold nearly all of the differences and a fit to all
// of them takes the passage for a walk, thousands of times too quick. So octaves from the shortest on may be
// left to themselves, each described by its own variance, for as many as pay for that by Schwarz's criterion
// (Annals of Statistics 6, 1978).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "filters/random/log_exp.h"

namespace ifog {

struct OctaveFit {
  double misfit = std::numeric_limits<double>::infinity();  // -2 log-likelihood, up to what all ratios share
  double low_noise = 0.0;                                   // R of the white noise that long blocks have
  double noise = 0.0;                                       // variance of a single sample, walk left out
};

// squares[k]: sum of counts[k] independent squared differences of means of 2^k samples. Three octaves
// at least are fitted.
[[nodiscard]] inline OctaveFit fit_octaves(std::span<const double> squares, std::span<const double> counts,
                                           double ratio) noexcept {
  constexpr std::size_t kFewest = 3;
  double all = 0.0, alone = 0.0;  // counts; misfit of octaves left to themselves
  std::size_t there = 0;
  for (std::size_t k = 0; k < squares.size(); ++k) {
    if (!(counts[k] > 0.0) || !(squares[k] > 0.0)) continue;
    all += counts[k];
    alone += counts[k] * logarithm(squares[k] / counts[k]);
    ++there;
  }
  OctaveFit best;
  if (there == 0) return best;
  const double price = logarithm(std::max(all, 2.0));
  double weighted = 0.0, total = 0.0, logs = 0.0;
  std::size_t taken = 0, first = 0;
  for (std::size_t k = squares.size(); k-- > 0;) {
    if (!(counts[k] > 0.0) || !(squares[k] > 0.0)) continue;
    const double block = std::ldexp(1.0, static_cast<int>(k)), shape = 6.0 / block + ratio * block;
    weighted += squares[k] / shape;
    total += counts[k];
    logs += counts[k] * logarithm(shape);
    alone -= counts[k] * logarithm(squares[k] / counts[k]);
    ++taken;
    const std::size_t left = there - taken;
    if (left > 0 && taken < kFewest) continue;
    const double noise = weighted / total;
    const double misfit = total * logarithm(noise) + logs + alone + price * static_cast<double>(left);
    if (!(misfit < best.misfit)) continue;
    best.misfit = misfit;
    best.low_noise = noise;
    first = k;
  }
  // Variance by halves: what the mean of two halves leaves of each is half of the Allan variance of the
  // halves.
  best.noise = std::ldexp(best.low_noise, -static_cast<int>(first));
  for (std::size_t k = 0; k < first; ++k)
    if (counts[k] > 0.0) best.noise += squares[k] / counts[k] / 12.0;
  return best;
}

}  // namespace ifog
