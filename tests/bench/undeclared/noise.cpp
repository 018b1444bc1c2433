// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/undeclared/noise.h"

#include <cmath>
#include <numbers>

namespace ifog::undeclared {
namespace {
constexpr double kRatio = 2.5;
}

NoiseModel::NoiseModel(const NoiseTruth& truth, std::size_t samples, double dt_s)
    : samples_(samples), white_sigma_(truth.N / std::sqrt(dt_s)), walk_sigma_(truth.K * std::sqrt(dt_s)) {
  if (truth.B > 0.0) {
    // A Gauss-Markov process of variance v has the one-sided density 4 v T / (1 + (2 pi f T)^2); over time
    // constants in the ratio r the sum is v / (f ln r).
    const double variance = truth.B * truth.B * std::log(kRatio) / (2.0 * std::numbers::pi);
    for (double T = dt_s; T < 10.0 * dt_s * static_cast<double>(samples); T *= kRatio) {
      const double decay = std::exp(-dt_s / T);
      decay_.push_back(decay);
      drive_sigma_.push_back(std::sqrt(variance * (1.0 - decay * decay)));
      start_variance_.push_back(variance);
    }
  }
  decay_.push_back(1.0);
  drive_sigma_.push_back(walk_sigma_);
  start_variance_.push_back(0.0);

  const std::size_t m = decay_.size();
  gain_.resize(samples * m);
  innovation_sigma_.resize(samples);
  std::vector<double> P(m * m, 0.0), PH(m);
  for (std::size_t i = 0; i < m; ++i) P[i * m + i] = start_variance_[i];
  for (std::size_t k = 0; k < samples; ++k) {
    double S = white_sigma_ * white_sigma_;
    for (std::size_t i = 0; i < m; ++i) {
      PH[i] = 0.0;
      for (std::size_t j = 0; j < m; ++j) PH[i] += P[i * m + j];
      S += PH[i];
    }
    innovation_sigma_[k] = std::sqrt(S);
    for (std::size_t i = 0; i < m; ++i) gain_[k * m + i] = PH[i] / S;
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        double p = (P[i * m + j] - PH[i] * PH[j] / S) * decay_[i] * decay_[j];
        if (i == j) p += drive_sigma_[i] * drive_sigma_[i];
        P[i * m + j] = P[j * m + i] = p;
      }
  }
}

std::vector<double> NoiseModel::draw(Draw& draw) const {
  const std::size_t m = decay_.size();
  std::vector<double> x(m), out(samples_);
  for (std::size_t i = 0; i < m; ++i) x[i] = std::sqrt(start_variance_[i]) * draw.normal();
  for (double& value : out) {
    value = white_sigma_ * draw.normal();
    for (std::size_t i = 0; i < m; ++i) {
      value += x[i];
      x[i] = decay_[i] * x[i] + drive_sigma_[i] * draw.normal();
    }
  }
  return out;
}

std::vector<double> NoiseModel::whiten(const std::vector<double>& column) const {
  const std::size_t m = decay_.size();
  std::vector<double> x(m, 0.0), out(samples_);
  for (std::size_t k = 0; k < samples_; ++k) {
    double innovation = column[k];
    for (std::size_t i = 0; i < m; ++i) innovation -= x[i];
    out[k] = innovation / innovation_sigma_[k];
    for (std::size_t i = 0; i < m; ++i) x[i] = decay_[i] * (x[i] + gain_[k * m + i] * innovation);
  }
  return out;
}

double NoiseModel::log_determinant() const {
  double sum = 0.0;
  for (const double sigma : innovation_sigma_) sum += 2.0 * std::log(sigma);
  return sum;
}

std::vector<double> Visibility::whitened(const Column& column) const {
  std::vector<double> out;
  for (const std::vector<double>& capture : column) {
    const std::vector<double> part = noise_->whiten(capture);
    out.insert(out.end(), part.begin(), part.end());
  }
  return out;
}

double Visibility::of(const Column& column, const std::vector<Column>& others) const {
  std::vector<std::vector<double>> basis;
  const auto dot = [](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  };
  const auto project_out = [&](std::vector<double>& w) {
    for (int twice = 0; twice < 2; ++twice)  // again, because of rounding errors
      for (const auto& b : basis) {
        const double along = dot(w, b);
        for (std::size_t i = 0; i < w.size(); ++i) w[i] -= along * b[i];
      }
  };
  const auto add = [&](const Column& nuisance) {
    std::vector<double> w = whitened(nuisance);
    const double before = std::sqrt(dot(w, w));
    project_out(w);
    const double norm = std::sqrt(dot(w, w));
    if (norm <= 1e-7 * before || norm == 0.0) return;  // linearly dependent
    for (double& value : w) value /= norm;
    basis.push_back(std::move(w));
  };
  const auto captures = static_cast<std::size_t>(captures_);
  for (std::size_t c = 0; c < captures; ++c) {
    Column constant(captures);
    for (std::size_t d = 0; d < captures; ++d) constant[d].assign(column[d].size(), d == c ? 1.0 : 0.0);
    add(constant);
  }
  for (const Column& other : others) add(other);
  std::vector<double> w = whitened(column);
  project_out(w);
  return std::sqrt(dot(w, w));
}

}  // namespace ifog::undeclared
