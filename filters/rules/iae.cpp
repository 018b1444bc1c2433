// SPDX-License-Identifier: Apache-2.0
// Innovation-based adaptive estimation: C is the mean of the last N squared innovations. Mehra, IEEE Trans.
// AC 15(2), 1970; Mohamed and Schwarz, J. Geodesy 73, 1999. R only, as Q is not identifiable with it.
#include "filters/rules/window.h"

namespace ifog {
namespace {

class Iae final : public WindowRule {
 public:
  using WindowRule::WindowRule;

  double innovation_covariance(const RuleInput& in) noexcept override {
    window_.insert(mean_square(in.innovations) / in.noise_scale);
    if (!window_.full()) return in.projected + noise_ * in.noise_scale;
    const double c = floored(window_.mean() * in.noise_scale, in.projected, least_ * in.noise_scale);
    estimate_ = (c - in.projected) / in.noise_scale;
    return c;
  }
};

}  // namespace

std::unique_ptr<Rule> make_iae(const FilterSettings& settings) { return std::make_unique<Iae>(settings); }

}  // namespace ifog
