// SPDX-License-Identifier: Apache-2.0
// Likelihood of the noise terms given a record's spectrum (noise_spectrum.h), and its maximum over
// non-negative variances.
//
// Bins: gamma distributed (Whittle's likelihood with each bin's degrees of freedom). Slow parts: Gaussian
// with exact covariance; a rate ramp in them is ignored, projected out or estimated.
#pragma once

#include <bitset>
#include <span>
#include <vector>

#include "filters/allan/noise/noise_spectrum.h"

namespace ifog {

using TermSet = std::bitset<kTerms>;

enum class Ramp {
  kNone,       // there is no ramp
  kProjected,  // the component along a ramp is not used
  kFree,       // estimated by generalised least squares, one ramp for all stretches
};

class NoiseLikelihood {
 public:
  NoiseLikelihood(const NoiseSpectrum& spectrum, Ramp ramp);

  struct Maximum {
    TermVariances variances{};  // 0 for terms that are not allowed or that the data drive to zero
    double log_likelihood = 0.0;
  };
  // Maximum over the allowed terms (at least one); the search starts at `near` if given.
  [[nodiscard]] Maximum maximise(TermSet allowed) const;
  [[nodiscard]] Maximum maximise(TermSet allowed, const TermVariances& near) const;
  // The same with the variance of one more term fixed.
  [[nodiscard]] Maximum maximise_with(Term held, double variance, TermSet allowed,
                                      const TermVariances& near) const;

  // Fisher information of the variances.
  [[nodiscard]] Eigen::Matrix4d information(const TermVariances& at) const;

  struct RampEstimate {
    double value = 0.0, std_error = 0.0;  // rate per sample
  };
  // Generalised least squares from the slow parts; only with Ramp::kFree.
  [[nodiscard]] RampEstimate ramp(const TermVariances& at) const;

  // Scale of each term: no term can have much more than the variance that alone fills one of the bins.
  [[nodiscard]] const TermVariances& unit() const { return unit_; }

 private:
  struct Part {
    Eigen::VectorXd value, ramp;
    std::array<Eigen::MatrixXd, kTerms> covariance;
  };
  struct State {
    double log_likelihood = 0.0;
    // Gradient of the log-likelihood is pull − push, both >= 0, per unit() of variance, as is `information`.
    Eigen::Vector4d pull = Eigen::Vector4d::Zero(), push = Eigen::Vector4d::Zero();
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  };
  // Derivatives only for the terms in `open`.
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
