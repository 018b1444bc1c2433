// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/noise_likelihood.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/linear/normal_equations.h"
#include "filters/linear/projection.h"
#include "filters/linear/symmetric.h"

namespace ifog {
namespace {

// First steps that cannot overshoot: multiply each variance by the ratio pull / push.
constexpr int kFromAfar = 10, kFromNear = 1;
constexpr int kMostSteps = 100;
constexpr double kClose = 1e-7;  // log-likelihood that a further step could gain

Eigen::Index row(std::size_t i) { return static_cast<Eigen::Index>(i); }

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

NoiseLikelihood::NoiseLikelihood(const NoiseSpectrum& spectrum, Ramp ramp) : ramp_(ramp) {
  unit_.fill(std::numeric_limits<double>::infinity());
  for (const SpectralBin& bin : spectrum.bins) {
    if (!bin.used) continue;
    bins_.push_back(&bin);
    for (std::size_t t = 0; t < kTerms; ++t)
      unit_[t] = std::min(unit_[t], std::max(1e-300, bin.power) / bin.expected[t]);
  }
  for (const SlowPart& slow : spectrum.slow) {
    Part part{slow.value, slow.ramp, slow.covariance};
    if (ramp == Ramp::kProjected && !slow.ramp.isZero()) {
      // Orthonormal basis of the space orthogonal to the ramp.
      const Eigen::MatrixXd complement = Projection::complement(slow.ramp);
      part.value = complement.transpose() * slow.value;
      for (Eigen::MatrixXd& c : part.covariance) c = (complement.transpose() * c * complement).eval();
    }
    parts_.push_back(std::move(part));
  }
}

NoiseLikelihood::RampEstimate NoiseLikelihood::ramp_at(const Eigen::Vector4d& x) const {
  double along = 0.0, weight = 0.0;
  for (const Part& part : parts_) {
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(part.value.size(), part.value.size());
    for (std::size_t t = 0; t < kTerms; ++t) c += x[row(t)] * unit_[t] * part.covariance[t];
    const Eigen::VectorXd g = CholeskyFactor(c).solve(part.ramp);
    along += g.dot(part.value);
    weight += g.dot(part.ramp);
  }
  return {along / weight, 1.0 / std::sqrt(weight)};
}

void NoiseLikelihood::add_slow(const Eigen::Vector4d& x, TermSet open, State& state) const {
  const double slope = ramp_ == Ramp::kFree && !parts_.empty() ? ramp_at(x).value : 0.0;
  for (const Part& part : parts_) {
    Eigen::VectorXd z = part.value;
    if (ramp_ == Ramp::kFree) z -= slope * part.ramp;
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(z.size(), z.size());
    for (std::size_t t = 0; t < kTerms; ++t)
      if (x[row(t)] > 0.0) c += x[row(t)] * unit_[t] * part.covariance[t];
    const CholeskyFactor cholesky(c);
    if (!cholesky.exists()) {
      state.log_likelihood = -std::numeric_limits<double>::infinity();
      return;
    }
    const Eigen::VectorXd y = cholesky.solve(z);
    state.log_likelihood -= cholesky.log_determinant() + 0.5 * y.dot(z);
    if (open.none()) continue;
    std::array<Eigen::MatrixXd, kTerms> share;
    for (std::size_t t = 0; t < kTerms; ++t) {
      if (!open[t]) continue;
      share[t] = unit_[t] * cholesky.solve(part.covariance[t]);
      state.pull[row(t)] += 0.5 * unit_[t] * y.dot(part.covariance[t] * y);
      state.push[row(t)] += 0.5 * share[t].trace();
      for (std::size_t s = 0; s <= t; ++s)
        if (open[s])
          state.information(row(s), row(t)) += 0.5 * share[t].cwiseProduct(share[s].transpose()).sum();
    }
  }
}

NoiseLikelihood::State NoiseLikelihood::evaluate(const Eigen::Vector4d& x, TermSet open) const {
  State state;
  for (const SpectralBin* bin : bins_) {
    Eigen::Vector4d a;
    for (std::size_t t = 0; t < kTerms; ++t) a[row(t)] = bin->expected[t] * unit_[t];
    const double expected = a.dot(x), half = 0.5 * bin->degrees;
    state.log_likelihood -= half * (std::log(expected) + bin->power / expected);
    if (open.none()) continue;
    a /= expected;
    state.pull += half * bin->power / expected * a;
    state.push += half * a;
    state.information += half * a * a.transpose();
  }
  add_slow(x, open, state);
  state.information = Eigen::Matrix4d(state.information.selfadjointView<Eigen::Upper>());
  return state;
}

NoiseLikelihood::Maximum NoiseLikelihood::climb(TermSet allowed, Eigen::Vector4d x, int careful) const {
  State now = evaluate(x, allowed);
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
      next = evaluate(trial, allowed);
      gain = next.log_likelihood - now.log_likelihood;
    }
    if (!(gain >= 0.0)) break;
    x = trial;
    now = next;
  }
  Maximum best;
  best.log_likelihood = now.log_likelihood;
  for (std::size_t t = 0; t < kTerms; ++t) best.variances[t] = x[row(t)] * unit_[t];
  return best;
}

Eigen::Vector4d NoiseLikelihood::in_units(const TermVariances& v) const {
  Eigen::Vector4d x;
  for (std::size_t t = 0; t < kTerms; ++t) x[row(t)] = v[t] / unit_[t];
  return x;
}

NoiseLikelihood::Maximum NoiseLikelihood::maximise(TermSet allowed) const {
  TermVariances start{};
  for (std::size_t t = 0; t < kTerms; ++t) start[t] = allowed[t] ? 0.3 * unit_[t] : 0.0;
  return climb(allowed, in_units(start), kFromAfar);
}

NoiseLikelihood::Maximum NoiseLikelihood::maximise(TermSet allowed, const TermVariances& near) const {
  // Starts with a little of every allowed term, because the first steps cannot leave zero.
  TermVariances start{};
  for (std::size_t t = 0; t < kTerms; ++t) start[t] = allowed[t] ? std::max(near[t], 1e-4 * unit_[t]) : 0.0;
  return climb(allowed, in_units(start), kFromNear);
}

NoiseLikelihood::Maximum NoiseLikelihood::maximise_with(Term held, double variance, TermSet allowed,
                                                        const TermVariances& near) const {
  TermVariances start{};
  for (std::size_t t = 0; t < kTerms; ++t) start[t] = allowed[t] ? std::max(near[t], 1e-4 * unit_[t]) : 0.0;
  start[held] = variance;
  return climb(TermSet(allowed).reset(held), in_units(start), kFromNear);
}

Eigen::Matrix4d NoiseLikelihood::information(const TermVariances& at) const {
  Eigen::Matrix4d information = evaluate(in_units(at), TermSet().set()).information;
  for (std::size_t t = 0; t < kTerms; ++t)
    for (std::size_t s = 0; s < kTerms; ++s) information(row(t), row(s)) /= unit_[t] * unit_[s];
  return information;
}

NoiseLikelihood::RampEstimate NoiseLikelihood::ramp(const TermVariances& at) const {
  return ramp_at(in_units(at));
}

}  // namespace ifog
