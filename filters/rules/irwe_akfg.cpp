// SPDX-License-Identifier: Apache-2.0
// Innovation-based random weighting estimation with adaptive Kalman filter gain correction: C is the randomly
// weighted mean of the last N squared innovations, including the current one. Narasimhappa et al., section
// 3.2; form of the gain: Yang et al., Sensors 2015 15(10):26940 and Song et al., Appl. Opt. 2019 58(35):9505.
//
// Weights e_i / sum e, e_i ~ Exp(1), are Dirichlet(1, …, 1): mean 1/N, variance (N-1)/(N^2 (N+1)). One draw
// has the plain window's mean and 2N/(N+1) times its variance. `fresh` draws all N weights at every step.
// `kept` lets each innovation keep its e_i in the window: the same distribution, one draw per step, and a
// smooth covariance. `uniform` uses e_i ~ U(0, 1), the other interpretation of "randomly generated in the
// range [0, 1]".
#include <array>

#include "filters/random/deviates.h"
#include "filters/rules/rule.h"

namespace ifog {
namespace {

class IrweAkfg final : public Rule {
 public:
  explicit IrweAkfg(const FilterSettings& settings)
      : noise_(settings.measurement_noise),
        epsilon_(settings.floor),
        window_(static_cast<std::size_t>(settings.window)),
        draws_(static_cast<std::size_t>(settings.draws)),
        fresh_(settings.weights != "kept"),
        deviates_(
            settings.seed, 0,
            settings.weights == "uniform" ? DeviateStream::Law::kUniform : DeviateStream::Law::kExponential),
        squares_(window_),
        kept_(window_ * draws_),
        scratch_(window_),
        sums_(draws_),
        estimate_(noise_) {}

  double innovation_covariance(const RuleInput& in) noexcept override {
    double square = 0.0;
    for (const double v : in.innovations) square += v * v;
    square /= static_cast<double>(in.innovations.size()) * in.noise_scale;
    insert(square, in.sequence);
    const double least = epsilon_ * noise_ * in.noise_scale;
    if (filled_ < window_) {
      const double c = in.projected + noise_ * in.noise_scale;
      estimate_ = noise_;
      return c;
    }
    const double c =
        floored((fresh_ ? fresh_average(in.sequence) : kept_average()) * in.noise_scale, in.projected, least);
    estimate_ = (c - in.projected) / in.noise_scale;
    return c;
  }

  double measurement_noise() const noexcept override { return estimate_; }

  void restart() noexcept override {
    filled_ = 0;
    next_ = 0;
    estimate_ = noise_;
    for (Sums& sums : sums_) sums = {};
  }

 private:
  void insert(double square, std::uint64_t sequence) noexcept {
    const double leaving = squares_[next_];
    squares_[next_] = square;
    if (!fresh_) {
      for (std::size_t b = 0; b < draws_; ++b) {
        double& weight = kept_[b * window_ + next_];
        if (filled_ == window_) {
          sums_[b].weight -= weight;
          sums_[b].weighted -= weight * leaving;
        }
        weight = deviates_.at(sequence, static_cast<std::uint32_t>(b));
        sums_[b].weight += weight;
        sums_[b].weighted += weight * square;
        sums_[b].round_weight += weight;
        sums_[b].round_weighted += weight * square;
      }
    }
    if (filled_ < window_) ++filled_;
    if (++next_ == window_) {
      next_ = 0;
      for (Sums& sums : sums_) sums = {sums.round_weight, sums.round_weighted};
    }
  }

  double kept_average() const noexcept {
    double sum = 0.0;
    for (const Sums& sums : sums_) sum += sums.weighted / sums.weight;
    return sum / static_cast<double>(draws_);
  }

  double fresh_average(std::uint64_t sequence) noexcept {
    double sum = 0.0;
    for (std::size_t b = 0; b < draws_; ++b) {
      deviates_.fill(sequence, static_cast<std::uint32_t>(b), scratch_);
      // Four parallel sums in a fixed order.
      std::array<double, 4> weights{}, weighted{};
      std::size_t i = 0;
      for (; i + 4 <= window_; i += 4) {
#pragma GCC unroll 4
        for (std::size_t lane = 0; lane < 4; ++lane) {
          weights[lane] += scratch_[i + lane];
          weighted[lane] += scratch_[i + lane] * squares_[i + lane];
        }
      }
      for (; i < window_; ++i) {
        weights[0] += scratch_[i];
        weighted[0] += scratch_[i] * squares_[i];
      }
      sum += total(weighted) / total(weights);
    }
    return sum / static_cast<double>(draws_);
  }

  static double total(const std::array<double, 4>& parts) noexcept {
    return (parts[0] + parts[1]) + (parts[2] + parts[3]);
  }

  double noise_, epsilon_;
  std::size_t window_, draws_;
  bool fresh_;
  DeviateStream deviates_;
  std::vector<double> squares_;  // ring of the innovations' mean square over axes, at the nominal period
  std::vector<double> kept_;     // [draw][index in the ring]
  std::vector<double> scratch_;
  // Of the window, by draw, and of this round of the ring. After a round the latter replaces the former, so
  // rounding errors do not accumulate.
  struct Sums {
    double weight = 0.0, weighted = 0.0, round_weight = 0.0, round_weighted = 0.0;
  };
  std::vector<Sums> sums_;
  std::size_t next_ = 0, filled_ = 0;
  double estimate_;
};

}  // namespace

std::unique_ptr<Rule> make_irwe_akfg(const FilterSettings& settings) {
  return std::make_unique<IrweAkfg>(settings);
}

}  // namespace ifog
