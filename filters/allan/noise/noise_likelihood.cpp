// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/noise_likelihood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "filters/linear/normal_equations.h"

namespace ifog {
namespace {

// First steps that cannot overshoot: multiply each variance by the ratio pull / push.
constexpr int kFromAfar = 10, kFromNear = 1;
constexpr int kMostSteps = 100;
constexpr double kClose = 1e-7;  // log-likelihood that a further step could gain

Eigen::Index row(std::size_t i) { return static_cast<Eigen::Index>(i); }

Eigen::Map<const Eigen::Array4d> of_terms(const TermVariances& v) {
  return Eigen::Map<const Eigen::Array4d>(v.data());
}

// Maximum of slopeᵀd − dᵀ·information·d/2 over non-negative variances x + d, by comparing all faces, each
// with its terms at zero. Clipping a plain scoring step could even decrease the likelihood if terms are
// interchangeable.
Eigen::Vector4d scoring_step(const Eigen::Vector4d& x, const Eigen::Vector4d& slope,
                             const Eigen::Matrix4d& information, TermSet allowed) {
  Eigen::Vector4d best = Eigen::Vector4d::Zero();
  double most = 0.0;
  for (unsigned long bits = 1; bits < 1UL << kTerms; ++bits) {
    const TermSet open(bits);
    if ((open & ~allowed).any()) continue;
    Eigen::Vector4d d = Eigen::Vector4d::Zero();
    std::vector<Eigen::Index> face;
    for (std::size_t t = 0; t < kTerms; ++t) {
      if (open[t])
        face.push_back(row(t));
      else if (allowed[t])
        d[row(t)] = -x[row(t)];
    }
    // Terms differ by many powers of ten.
    d(face) = NormalEquations(information(face, face), (slope - information * d)(face)).coefficients();
    if (!d.allFinite() || ((x + d)(face).array() < 0.0).any()) continue;
    const double gain = slope.dot(d) - 0.5 * d.dot(information * d);
    if (gain <= most) continue;
    most = gain;
    best = d;
  }
  return best;
}

}  // namespace

NoiseLikelihood::NoiseLikelihood(const NoiseSpectrum& spectrum, Ramp ramp)
    : spectrum_(spectrum),
      ramp_(ramp),
      unit_(Eigen::Array4d::Constant(std::numeric_limits<double>::infinity())) {
  for (const SpectralBin& bin : spectrum.bins)
    if (bin.used) unit_ = unit_.min(std::max(1e-300, bin.power) / of_terms(bin.expected));
}

NoiseLikelihood::RampEstimate NoiseLikelihood::ramp_at(const Eigen::Vector4d& x) const {
  double along = 0.0, weight = 0.0;
  for (const SlowCosine& slow : spectrum_.slow) {
    const double expected = (of_terms(slow.expected) * unit_).matrix().dot(x);
    along += slow.ramp * slow.value / expected;
    weight += slow.ramp * slow.ramp / expected;
  }
  return {along / weight, 1.0 / std::sqrt(weight)};
}

NoiseLikelihood::State NoiseLikelihood::evaluate(const Eigen::Vector4d& x) const {
  State state;
  // Returns each term's part of the power per unit_.
  const auto add = [&](const TermVariances& of_unit, double power, double degrees) -> Eigen::Vector4d {
    Eigen::Vector4d part = of_terms(of_unit) * unit_;
    const double expected = part.dot(x), half = 0.5 * degrees;
    part /= expected;
    state.log_likelihood -= half * (std::log(expected) + power / expected);
    state.pull += half * power / expected * part;
    state.push += half * part;
    state.information += half * part * part.transpose();
    return part;
  };
  for (const SpectralBin& bin : spectrum_.bins)
    if (bin.used) add(bin.expected, bin.power, bin.degrees);
  if (spectrum_.slow.empty()) return state;
  const RampEstimate ramp = ramp_ == Ramp::kNone ? RampEstimate{} : ramp_at(x);
  Eigen::Vector4d along = Eigen::Vector4d::Zero();
  for (const SlowCosine& slow : spectrum_.slow) {
    const double left = slow.value - ramp.value * slow.ramp;
    const Eigen::Vector4d part = add(slow.expected, left * left, 1.0);
    if (ramp_ != Ramp::kProjected) continue;
    // Share of the ramp's information; the likelihood of what is orthogonal to it lacks that much.
    const double expected = (of_terms(slow.expected) * unit_).matrix().dot(x);
    const double share = std::pow(slow.ramp * ramp.std_error, 2) / expected;
    along += share * part;
    state.information -= share * part * part.transpose();
  }
  if (ramp_ != Ramp::kProjected) return state;
  state.log_likelihood += std::log(ramp.std_error);
  state.push -= 0.5 * along;
  state.information += 0.5 * along * along.transpose();
  return state;
}

NoiseLikelihood::Maximum NoiseLikelihood::climb(TermSet allowed, Eigen::Vector4d x, int careful) const {
  State now = evaluate(x);
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::Vector4d move = Eigen::Vector4d::Zero();
    if (step < careful) {
      for (std::size_t t = 0; t < kTerms; ++t)
        if (allowed[t] && x[row(t)] > 0.0)
          move[row(t)] = x[row(t)] * (std::sqrt(now.pull[row(t)] / now.push[row(t)]) - 1.0);
    } else {
      move = scoring_step(x, now.pull - now.push, now.information, allowed);
      if ((now.pull - now.push).dot(move) < kClose) break;
    }
    State next;
    double gain = -1.0, length = 1.0;
    Eigen::Vector4d trial = x;
    for (int half = 0; half < 30 && !(gain >= 0.0); ++half, length *= 0.5) {
      trial = (x + length * move).cwiseMax(0.0);
      if (trial.maxCoeff() <= 0.0) continue;
      next = evaluate(trial);
      gain = next.log_likelihood - now.log_likelihood;
    }
    if (!(gain >= 0.0)) break;
    x = trial;
    now = next;
  }
  Maximum best;
  best.log_likelihood = now.log_likelihood;
  Eigen::Map<Eigen::Array4d>(best.variances.data()) = x.array() * unit_;
  return best;
}

NoiseLikelihood::Maximum NoiseLikelihood::maximise(TermSet allowed, const TermVariances& near) const {
  const bool afar = of_terms(near).maxCoeff() <= 0.0;
  // Starts with a little of every allowed term, because the first steps cannot leave zero.
  Eigen::Vector4d x = (of_terms(near) / unit_).max(afar ? 0.3 : 1e-4);
  for (std::size_t t = 0; t < kTerms; ++t)
    if (!allowed[t]) x[row(t)] = 0.0;
  return climb(allowed, x, afar ? kFromAfar : kFromNear);
}

NoiseLikelihood::Maximum NoiseLikelihood::maximise_with(Term held, double variance, TermSet allowed,
                                                        const TermVariances& near) const {
  Eigen::Vector4d x = (of_terms(near) / unit_).max(1e-4);
  for (std::size_t t = 0; t < kTerms; ++t)
    if (!allowed[t]) x[row(t)] = 0.0;
  x[row(held)] = variance / unit_[row(held)];
  return climb(TermSet(allowed).reset(held), x, kFromNear);
}

Eigen::Matrix4d NoiseLikelihood::information(const TermVariances& at) const {
  return unit_.inverse().matrix().asDiagonal() * evaluate(of_terms(at) / unit_).information *
         unit_.inverse().matrix().asDiagonal();
}

NoiseLikelihood::RampEstimate NoiseLikelihood::ramp(const TermVariances& at) const {
  return ramp_at(of_terms(at) / unit_);
}

}  // namespace ifog
