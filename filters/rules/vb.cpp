// SPDX-License-Identifier: Apache-2.0
// Variational Bayes: R is inverse-gamma with parameters alpha, beta that fade by rho per step; state and R
// are fitted alternately to each measurement. Sarkka and Nummenmaa, IEEE Trans. AC 54(3), 2009.
#include "filters/rules/rule.h"

namespace ifog {
namespace {

class VariationalBayes final : public Rule {
 public:
  explicit VariationalBayes(const FilterSettings& settings)
      : noise_(settings.measurement_noise),
        least_(settings.floor * settings.measurement_noise),
        // alpha settles at half the memory, 1 / (2 (1 - rho)): as long as the other rules' window.
        fading_(1.0 - 1.0 / settings.window) {
    restart();
  }

  double innovation_covariance(const RuleInput& in) noexcept override {
    const double alpha = fading_ * alpha_ + 0.5 * static_cast<double>(in.innovations.size());
    const double beta_before = fading_ * beta_;
    double squares = 0.0;
    for (const double v : in.innovations) squares += v * v;
    double beta = beta_before;
    double c = 0.0;
    // R = beta / alpha, with this measurement already in alpha, as in the paper's algorithm.
    for (int turn = 0; turn < kTurns; ++turn) {
      c = in.projected + beta / alpha * in.noise_scale;
      const double share = 1.0 - in.projected / c;
      const double residuals = squares * share * share;
      const double spread = static_cast<double>(in.innovations.size()) * in.projected * share;
      beta = beta_before + 0.5 * (residuals + spread) / in.noise_scale;
    }
    alpha_ = alpha;
    beta_ = beta;
    return floored(c, in.projected, least_ * in.noise_scale);
  }
  double measurement_noise() const noexcept override { return beta_ / alpha_; }
  void restart() noexcept override {
    alpha_ = 1.0;  // worth two measurements
    beta_ = noise_;
  }

 private:
  static constexpr int kTurns = 3;  // the fixed point is reached to about 1e-3 of R

  double noise_, least_, fading_;
  double alpha_ = 1.0, beta_ = 0.0;
};

}  // namespace

std::unique_ptr<Rule> make_vb(const FilterSettings& settings) {
  return std::make_unique<VariationalBayes>(settings);
}

}  // namespace ifog
