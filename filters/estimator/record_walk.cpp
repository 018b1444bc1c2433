// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/record_walk.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "filters/estimator/octave_fit.h"

namespace ifog {
namespace {

// Second differences that overlap by two thirds count for half of their number.
constexpr double kIndependent = 0.5;
// Trials of the ratio of walk to noise: a factor apart, up to a walk that is all there is.
constexpr double kStep = 1.2;
constexpr double kMostRatio = 10.0;
// Of fewer samples no walk is known.
constexpr double kLeast = 1024.0;

}  // namespace

void RecordWalk::take(double rate) {
  samples_ += 1.0;
  double mean = rate;
  for (std::size_t k = 0;; ++k) {
    if (k == octaves_.size()) octaves_.emplace_back();
    if (k == squares_.size()) {
      squares_.push_back(0.0);
      counts_.push_back(0.0);
    }
    Octave& octave = octaves_[k];
    if (octave.blocks == 2) {
      const double second = mean - 2.0 * octave.means[1] + octave.means[0];
      squares_[k] += kIndependent * second * second;
      counts_[k] += kIndependent;
    } else {
      ++octave.blocks;
    }
    octave.means = {octave.means[1], mean};
    octave.has_half = !octave.has_half;
    if (octave.has_half) {
      octave.half = mean;
      return;
    }
    mean = 0.5 * (octave.half + mean);
  }
}

double RecordWalk::variance() const {
  if (samples_ < kLeast) return 0.0;
  std::vector<double> walks, misfits;
  // No slower than the record could have shown.
  for (double ratio = 1.0 / (samples_ * samples_); ratio < kMostRatio; ratio *= kStep) {
    const OctaveFit fit = fit_octaves(squares_, counts_, ratio);
    walks.push_back(ratio * fit.low_noise);
    misfits.push_back(fit.misfit);
  }
  const double least = *std::min_element(misfits.begin(), misfits.end());
  if (!std::isfinite(least)) return 0.0;
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < walks.size(); ++i) {
    const double weight = std::exp(0.5 * (least - misfits[i]));
    sum += weight * walks[i];
    weights += weight;
  }
  return sum / weights;
}

}  // namespace ifog
