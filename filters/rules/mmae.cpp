// SPDX-License-Identifier: Apache-2.0
// Multiple-model adaptive estimation: a bank of filters with factors on Q and R; outputs are weighted by
// posterior probabilities. Magill, IEEE Trans. AC 10(4), 1965. The probabilities have a lower limit, so a
// model that was wrong for long can recover (Maybeck, Stochastic Models, Estimation and Control 2, 1982,
// section 10.8).
//
// There is no additional forgetting. At rest a neighbouring filter loses about a quarter of its gain per
// sample in log-likelihood, so a memory shorter than its lag cannot identify the right one: with forgetting
// in 50 samples the RMSE at Q/R = 3e-7 was 2.6 times that of the right filter, without it 1.01. After a
// change the limit bounds the recovery time, as in Page's test.
#include <algorithm>
#include <array>

#include "filters/random/log_exp.h"
#include "filters/rules/rule.h"

namespace ifog {
namespace {

constexpr std::array kProcessFactors{1e-4, 1e-2, 1.0, 1e2, 1e4};
constexpr std::array kNoiseFactors{1e-2, 1.0, 1e2};
constexpr std::size_t kModels = kProcessFactors.size() * kNoiseFactors.size();
static_assert(kModels <= Rule::kMaxHypotheses);

constexpr std::array<double, kModels> process_factors() {
  std::array<double, kModels> all{};
  for (std::size_t j = 0; j < kModels; ++j) all[j] = kProcessFactors[j % kProcessFactors.size()];
  return all;
}
constexpr std::array<double, kModels> kFactorOfModel = process_factors();

class Mmae final : public Rule {
 public:
  explicit Mmae(const FilterSettings& settings) : noise_(settings.measurement_noise) { restart(); }

  std::span<const double> hypotheses() const noexcept override { return kFactorOfModel; }
  double weight(std::size_t hypothesis) const noexcept override { return weight_[hypothesis]; }

  double innovation_covariance(const RuleInput& in) noexcept override {
    const std::size_t j = in.hypothesis;
    const double c = in.projected + measurement_noise_of(j) * in.noise_scale;
    double squares = 0.0;
    for (const double v : in.innovations) squares += v * v;
    log_[j] -= 0.5 * (squares / c + static_cast<double>(in.innovations.size()) * logarithm(c / noise_));
    if (j + 1 == kModels) weigh();
    return c;
  }
  double measurement_noise() const noexcept override { return measurement_noise_of(likeliest_); }
  double measurement_noise_of(std::size_t hypothesis) const noexcept override {
    return noise_ * kNoiseFactors[hypothesis / kProcessFactors.size()];
  }
  void restart() noexcept override {
    log_ = {};
    weight_.fill(1.0 / static_cast<double>(kModels));
    likeliest_ = kProcessFactors.size() + kProcessFactors.size() / 2;  // both factors one
  }

 private:
  static constexpr double kLeastLogWeight = -14.0;

  void weigh() noexcept {
    for (std::size_t j = 0; j < kModels; ++j) {
      if (log_[j] > log_[likeliest_]) likeliest_ = j;
    }
    const double greatest = log_[likeliest_];
    double sum = 0.0;
    for (std::size_t j = 0; j < kModels; ++j) {
      log_[j] = std::max(log_[j] - greatest, kLeastLogWeight);
      sum += weight_[j] = exponential(log_[j]);
    }
    for (double& weight : weight_) weight /= sum;
  }

  double noise_;
  std::array<double, kModels> log_{}, weight_{};
  std::size_t likeliest_ = 0;
};

}  // namespace

std::unique_ptr<Rule> make_mmae(const FilterSettings& settings) { return std::make_unique<Mmae>(settings); }

}  // namespace ifog
