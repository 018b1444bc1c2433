// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/noise_term.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "filters/state_models/state_name.h"

namespace ifog {
namespace {

// theta: ln variance of the innovation e, atanh of p partial autocorrelations and of q of the MA part.
class ArmaTerm : public NoiseTerm {
 public:
  ArmaTerm(int p, int q) : p_(p), q_(q) {}
  [[nodiscard]] int size() const override { return 1 + p_ + q_; }
  void bounds(std::span<double> low, std::span<double> high) const override {
    low[0] = -24.0;
    high[0] = 8.0;
    std::fill_n(low.begin() + 1, p_ + q_, -kMost);
    std::fill_n(high.begin() + 1, p_ + q_, kMost);
  }
  void add_density(std::span<const double> theta, const RecordSpectrum& spectrum,
                   std::span<double> out) const override {
    const std::vector<double> c = coefficients(theta);
    const double variance = std::exp(theta[0]);
    const auto bins = static_cast<Eigen::Index>(out.size());
    const auto row = [&](const std::vector<double>& values) {
      return Eigen::Map<const Eigen::ArrayXd>(values.data(), bins);
    };
    Eigen::ArrayXd ar = Eigen::ArrayXd::Ones(bins), ar_i = Eigen::ArrayXd::Zero(bins), ma = ar, ma_i = ar_i;
    for (std::size_t i = 0; i < count(p_); ++i) {
      ar -= c[i] * row(spectrum.cosine[i]);
      ar_i -= c[i] * row(spectrum.sine[i]);
    }
    for (std::size_t i = 0; i < count(q_); ++i) {
      ma += c[count(p_) + i] * row(spectrum.cosine[i]);
      ma_i += c[count(p_) + i] * row(spectrum.sine[i]);
    }
    Eigen::Map<Eigen::ArrayXd>(out.data(), bins) +=
        variance * (ma.square() + ma_i.square()) / (ar.square() + ar_i.square());
  }
  [[nodiscard]] std::vector<double> parameters(std::span<const double> theta,
                                               double period_s) const override {
    std::vector<double> all = coefficients(theta);
    all.push_back(std::exp(theta[0]) / period_s);
    return all;
  }
  [[nodiscard]] std::vector<CandidateFigure> figures(std::span<const double> theta, double scale,
                                                     double /*period_s*/) const override {
    std::vector<CandidateFigure> out{{"innovation_sigma", "rad/s", std::exp(0.5 * theta[0]) * scale}};
    const auto c = coefficients(theta);
    for (int i = 0; i < p_ + q_; ++i)
      out.push_back(
          {i < p_ ? "phi_" + std::to_string(i + 1) : "theta_" + std::to_string(i - p_ + 1), "", c[count(i)]});
    return out;
  }

 private:
  static constexpr double kMost = 6.0;  // atanh of a partial correlation of 1 - 1e-5
  static std::size_t count(int n) { return static_cast<std::size_t>(n); }
  [[nodiscard]] std::vector<double> coefficients(std::span<const double> theta) const {
    const auto part = [&](std::size_t first, int size) {
      std::vector<double> partial(count(size));
      const auto from = theta.subspan(first, partial.size());
      std::transform(from.begin(), from.end(), partial.begin(),
                     [](double value) { return std::tanh(value); });
      return ar_from_partial(partial);
    };
    std::vector<double> c = part(1, p_);
    // 1 + θ(B) is invertible if −θ are the coefficients of a stationary AR.
    const std::vector<double> moving = part(1 + count(p_), q_);
    std::transform(moving.begin(), moving.end(), std::back_inserter(c), std::negate<>());
    return c;
  }
  int p_, q_;
};

// At the samples an AR(1) with positive coefficient.
class GaussMarkovTerm final : public ArmaTerm {
 public:
  GaussMarkovTerm() : ArmaTerm(1, 0) {}
  void bounds(std::span<double> low, std::span<double> high) const override {
    ArmaTerm::bounds(low, high);
    low[1] = 0.02;  // a quarter of a sample
    high[1] = 8.0;  // a million samples
  }
  [[nodiscard]] std::vector<double> parameters(std::span<const double> theta,
                                               double period_s) const override {
    const double tau_s = correlation(theta[1]) * period_s;
    return {tau_s, 2.0 * variance(theta) / tau_s};
  }
  [[nodiscard]] std::vector<CandidateFigure> figures(std::span<const double> theta, double scale,
                                                     double period_s) const override {
    return {{"gauss_markov_sigma", "rad/s", std::sqrt(variance(theta)) * scale},
            {"gauss_markov_correlation_time", "s", correlation(theta[1]) * period_s}};
  }

 private:
  static double correlation(double partial) { return -1.0 / std::log(std::tanh(partial)); }  // samples
  // 1 - tanh² = 1 / cosh², without cancellation for long correlation times.
  static double variance(std::span<const double> theta) {
    return std::exp(theta[0]) * std::pow(std::cosh(theta[1]), 2);
  }
};

}  // namespace

std::vector<double> ar_from_partial(std::span<const double> partial) {
  std::vector<double> phi, last;
  for (std::size_t k = 0; k < partial.size(); ++k) {
    last = phi;
    phi.push_back(partial[k]);
    for (std::size_t i = 0; i < k; ++i) phi[i] = last[i] - partial[k] * last[k - 1 - i];
  }
  return phi;
}

std::unique_ptr<NoiseTerm> make_noise_term(const std::string& name) {
  if (name == "gauss-markov") return std::make_unique<GaussMarkovTerm>();
  const auto [p, q] = arma_orders(name).value_or(std::pair{0, 0});
  if (p < 1 || p > static_cast<int>(RecordSpectrum::kOrders) || q >= p) return nullptr;
  return std::make_unique<ArmaTerm>(p, q);
}

}  // namespace ifog
