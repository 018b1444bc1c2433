// SPDX-License-Identifier: Apache-2.0
// Sage-Husa with fading memory: R(k) = (1 - d) R(k-1) + d (nu^2 - h'P-h), d = (1 - b) / (1 - b^(k+1)). Sage
// and Husa, Proc. Joint Automatic Control Conf., 1969, in the usual fading form. R only and zero-mean noise:
// joint estimation of q, Q and R diverges. A negative difference is limited by the floor.
#include "filters/rules/rule.h"
#include "filters/rules/window.h"

namespace ifog {
namespace {

class SageHusa final : public Rule {
 public:
  explicit SageHusa(const FilterSettings& settings)
      : noise_(settings.measurement_noise),
        least_(settings.floor * settings.measurement_noise),
        // Memory as long as the window of the other rules.
        fading_(1.0 - 1.0 / settings.window),
        estimate_(noise_) {}

  double innovation_covariance(const RuleInput& in) noexcept override {
    // Set to zero when negligible, to avoid slow subnormal numbers.
    power_ = power_ > 1e-30 ? power_ * fading_ : 0.0;
    const double d = (1.0 - fading_) / (1.0 - power_ * fading_);
    estimate_ += d * ((mean_square(in.innovations) - in.projected) / in.noise_scale - estimate_);
    const double c =
        floored(in.projected + estimate_ * in.noise_scale, in.projected, least_ * in.noise_scale);
    estimate_ = (c - in.projected) / in.noise_scale;
    return c;
  }
  double measurement_noise() const noexcept override { return estimate_; }
  void restart() noexcept override {
    power_ = 1.0;
    estimate_ = noise_;
  }

 private:
  double noise_, least_, fading_;
  double power_ = 1.0;  // b^k
  double estimate_;
};

}  // namespace

std::unique_ptr<Rule> make_sage_husa(const FilterSettings& settings) {
  return std::make_unique<SageHusa>(settings);
}

}  // namespace ifog
