// SPDX-License-Identifier: Apache-2.0
// Residual-based adaptive estimation: R = mean of the last N squared residuals z - h'x+ plus h'P+h, which is
// always positive. Mohamed and Schwarz, J. Geodesy 73, 1999. The estimate is used for the next measurement,
// since a residual is known only after its gain.
#include "filters/rules/window.h"

namespace ifog {
namespace {

class Rae final : public WindowRule {
 public:
  using WindowRule::WindowRule;

  double innovation_covariance(const RuleInput& in) noexcept override {
    const double c =
        floored(in.projected + estimate_ * in.noise_scale, in.projected, least_ * in.noise_scale);
    const double share = 1.0 - in.projected / c;  // residual / innovation, and h'P+h / h'P-h
    window_.insert((mean_square(in.innovations) * share * share + in.projected * share) / in.noise_scale);
    if (window_.full()) estimate_ = window_.mean();
    return c;
  }
};

}  // namespace

std::unique_ptr<Rule> make_rae(const FilterSettings& settings) { return std::make_unique<Rae>(settings); }

}  // namespace ifog
