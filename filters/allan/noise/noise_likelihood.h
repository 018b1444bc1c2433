// SPDX-License-Identifier: Apache-2.0
// Likelihood of the noise terms given a record's spectrum (noise_spectrum.h), and its maximum over
// non-negative variances.
//
// Bins: gamma distributed (Whittle's likelihood with each bin's degrees of freedom). Slow cosines: Gaussian; a rate ramp
// in them is ignored, projected out or estimated.
#pragma once

#include <Eigen/Dense>
#include <bitset>

#include "filters/allan/noise/noise_spectrum.h"

namespace ifog {

using TermSet = std::bitset<kTerms>;

enum class Ramp {
  kNone,       // there is no ramp
  kProjected,  // the component along a ramp is not used (restricted likelihood)
  kFree,       // estimated by generalised least squares, one ramp for all stretches
};

class NoiseLikelihood {
 public:
  // spectrum must outlive this object.
  NoiseLikelihood(const NoiseSpectrum& spectrum, Ramp ramp);

  struct Maximum {
    TermVariances variances{};  // 0 for terms that are not allowed or that the data drive to zero
    double log_likelihood = 0.0;
  };
  // Maximum over the allowed terms (at least one); the search starts at `near` unless that is zero.
  [[nodiscard]] Maximum maximise(TermSet allowed, const TermVariances& near = {}) const;
  // The same with the variance of one more term fixed.
  [[nodiscard]] Maximum maximise_with(Term held, double variance, TermSet allowed,
                                      const TermVariances& near) const;

  // Fisher information of the variances.
  [[nodiscard]] Eigen::Matrix4d information(const TermVariances& at) const;

  struct RampEstimate {
    double value = 0.0, std_error = 0.0;  // rate per sample
  };
  // Generalised least squares from the slow cosines.
  [[nodiscard]] RampEstimate ramp(const TermVariances& at) const;

 private:
  struct State {
    double log_likelihood = 0.0;
    // Gradient of the log-likelihood is pull − push, both >= 0, per unit_ of variance, as is `information`.
    Eigen::Vector4d pull = Eigen::Vector4d::Zero(), push = Eigen::Vector4d::Zero();
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  };
  [[nodiscard]] State evaluate(const Eigen::Vector4d& x) const;
  [[nodiscard]] RampEstimate ramp_at(const Eigen::Vector4d& x) const;
  [[nodiscard]] Maximum climb(TermSet allowed, Eigen::Vector4d x, int careful) const;

  const NoiseSpectrum& spectrum_;
  Ramp ramp_;
  // Scale of each term: no term can have much more than the variance that alone fills one of the bins.
  Eigen::Array4d unit_;
};

}  // namespace ifog
