// SPDX-License-Identifier: Apache-2.0
// Conventional Kalman filter: C = h'P h + R.
#include "filters/rules/rule.h"

namespace ifog {
namespace {

class Ckf final : public Rule {
 public:
  explicit Ckf(double noise) : noise_(noise) {}
  double innovation_covariance(const RuleInput& in) noexcept override {
    return in.projected + noise_ * in.noise_scale;
  }
  double measurement_noise() const noexcept override { return noise_; }
  void restart() noexcept override {}

 private:
  double noise_;
};

}  // namespace

std::unique_ptr<Rule> make_ckf(const FilterSettings& settings) {
  return std::make_unique<Ckf>(settings.measurement_noise);
}

}  // namespace ifog
