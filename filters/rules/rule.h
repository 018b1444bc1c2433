// SPDX-License-Identifier: Apache-2.0
// Adaptation rule: computes the innovation covariance, which sets the gain, from innovations. It uses scalars
// only, so it works with every state model. To add one: a class derived from Rule in its own file, and a line
// in list.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "filters/settings/filter_settings.h"

namespace ifog {

struct RuleInput {
  double projected = 0.0;               // h'P-h, (rad/s)^2
  double noise_scale = 1.0;             // R of this sample / R at the nominal period
  std::span<const double> innovations;  // of the valid axes, one to three
  std::uint64_t sequence = 0;
  std::size_t hypothesis = 0;  // core that asks, for a rule with several
};

class Rule {
 public:
  static constexpr std::size_t kMaxHypotheses = 15;

  virtual ~Rule() = default;

  // Innovation covariance for this measurement, which some rules include. Always above `projected` unless the
  // floor is off. Called once per accepted measurement.
  [[nodiscard]] virtual double innovation_covariance(const RuleInput& in) noexcept = 0;

  // Present estimate of the measurement noise at the nominal period, (rad/s)^2.
  [[nodiscard]] virtual double measurement_noise() const noexcept = 0;
  // The same for one core of a bank.
  [[nodiscard]] virtual double measurement_noise_of(std::size_t) const noexcept {
    return measurement_noise();
  }

  virtual void restart() noexcept = 0;

  // Factors on Q of the cores of a bank; one core unless overridden. weight() gives the weights of their
  // outputs.
  [[nodiscard]] virtual std::span<const double> hypotheses() const noexcept {
    static constexpr double kOne = 1.0;
    return {&kOne, 1};
  }
  [[nodiscard]] virtual double weight(std::size_t) const noexcept { return 1.0; }

  [[nodiscard]] virtual std::uint64_t floor_hits() const noexcept { return floor_hits_; }

 protected:
  // C >= h'P h + epsilon R0: otherwise the gain exceeds one and the covariance becomes negative. Not in the
  // paper.
  [[nodiscard]] double floored(double c, double projected, double least_noise) noexcept {
    const double least = projected + least_noise;
    if (c >= least || least_noise <= 0.0) return c;
    ++floor_hits_;
    return least;
  }

 private:
  std::uint64_t floor_hits_ = 0;
};

struct RuleEntry {
  const char* name;
  std::unique_ptr<Rule> (*make)(const FilterSettings& settings);
};

// All rules, in the order of the command line's list.
std::span<const RuleEntry> rules();
std::vector<std::string_view> rule_names();

// Throws std::invalid_argument that names the setting, its value and what was expected.
std::unique_ptr<Rule> make_rule(const FilterSettings& settings);

std::unique_ptr<Rule> make_ckf(const FilterSettings& settings);
std::unique_ptr<Rule> make_irwe_akfg(const FilterSettings& settings);
std::unique_ptr<Rule> make_iae(const FilterSettings& settings);
std::unique_ptr<Rule> make_rae(const FilterSettings& settings);
std::unique_ptr<Rule> make_mmae(const FilterSettings& settings);
std::unique_ptr<Rule> make_sage_husa(const FilterSettings& settings);
std::unique_ptr<Rule> make_vb(const FilterSettings& settings);

}  // namespace ifog
