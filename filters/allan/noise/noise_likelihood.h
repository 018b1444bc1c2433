// SPDX-License-Identifier: Apache-2.0
// Likelihood of the noise terms given a record's spectrum (noise_spectrum.h), and its maximum over variances
// that are not negative.
//
// Bins: gamma distributed (Whittle's likelihood with the degrees of freedom each bin has). Slow parts:
// Gaussian with their exact covariance; a rate ramp in them is ignored, projected out or estimated.
#pragma once

#include <bitset>
#include <span>
#include <vector>

#include "filters/allan/noise/noise_spectrum.h"

namespace ifog {

using TermSet = std::bitset<kTerms>;

enum class Ramp {
  kNone,       // there is none
  kProjected,  // nothing along it is used: the same likelihood with any ramp
  kFree,       // estimated by generalised least squares, one for all stretches
};

class NoiseLikelihood {
 public:
  NoiseLikelihood(const NoiseSpectrum& spectrum, Ramp ramp);

  struct Maximum {
    TermVariances variances{};  // 0 for terms not allowed, and for those the data drive to zero
    double log_likelihood = 0.0;
  };
  // Over the allowed terms (at least one), from a start of its own or from `near`.
  [[nodiscard]] Maximum maximise(TermSet allowed) const;
  [[nodiscard]] Maximum maximise(TermSet allowed, const TermVariances& near) const;
  // The same with one more term held at a variance.
  [[nodiscard]] Maximum maximise_with(Term held, double variance, TermSet allowed,
                                      const TermVariances& near) const;

  // Fisher information of the variances, at these.
  [[nodiscard]] Eigen::Matrix4d information(const TermVariances& at) const;

  struct RampEstimate {
    double value = 0.0, std_error = 0.0;  // rate a sample
  };
  // By generalised least squares from the slow parts. Only with Ramp::kFree.
  [[nodiscard]] RampEstimate ramp(const TermVariances& at) const;

  // No term can have much more than the variance that makes it fill one of the bins alone: a scale for it.
  [[nodiscard]] const TermVariances& unit() const { return unit_; }

 private:
  struct Part {
    Eigen::VectorXd value, ramp;
    std::array<Eigen::MatrixXd, kTerms> covariance;
  };
  struct State {
    double log_likelihood = 0.0;
    // The log-likelihood's gradient is pull − push, both >= 0; both and information by variance in units.
    Eigen::Vector4d pull = Eigen::Vector4d::Zero(), push = Eigen::Vector4d::Zero();
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  };
  // Slopes for the terms of `open` only.
  [[nodiscard]] State evaluate(const Eigen::Vector4d& x, TermSet open) const;
  void add_slow(const Eigen::Vector4d& x, TermSet open, State& state) const;
  [[nodiscard]] RampEstimate ramp_at(const Eigen::Vector4d& x) const;
  [[nodiscard]] Maximum climb(TermSet allowed, Eigen::Vector4d x, int careful) const;
  [[nodiscard]] Eigen::Vector4d in_units(const TermVariances& v) const;

  std::vector<const SpectralBin*> bins_;
  std::vector<Part> parts_;
  Ramp ramp_;
  TermVariances unit_{};
};

}  // namespace ifog
