// SPDX-License-Identifier: Apache-2.0
// Has the rate left rest? Each tracker against the filter at rest, and the raw measurement against both.
//
// Page's test (Biometrika 41, 1954): the log-likelihood ratio of a tracker's predictions to those of the
// filter at rest, both with the known R, summed and forgotten over the tracker's horizon. exp of the sum is
// at most e^18 by chance once in e^18 samples (Ville's inequality). What no tracker predicts is found by its
// size alone: innovations of variance 4 R against R, which finds shaking.
//
// The only thing known about colour is by how much the sums of innovations over each horizon vary at rest. It is
// learned there.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "filters/estimator/sample.h"
#include "filters/estimator/trackers.h"

namespace ifog {

class ChangeTest {
 public:
  explicit ChangeTest(const Trackers& trackers) noexcept;

  // Index of "no tracker: the measurements are larger than the known noise".
  static constexpr std::size_t kShaking = Trackers::kMost;

  // colour: Noise::colour() of each axis; rarity: Outliers::rarity(); lag: of the filter at rest, samples. The tracker
  // that foresees the change, kShaking, or nothing. Before Trackers::correct().
  std::optional<std::size_t> take(const Trackers& trackers, const Sample& now, const Lanes& colour,
                                  double rarity, double lag) noexcept;
  // A manoeuvre was found, or begins with the filter: what is known of the noise stays.
  void begin() noexcept;
  [[nodiscard]] bool suspected() const noexcept { return suspected_; }
  // Angle, rad, that the filter at rest has fallen short of over the tracker's horizon.
  [[nodiscard]] const Lanes& angle(std::size_t tracker) const noexcept { return short_[tracker]; }
  void forget_angle() noexcept { short_.fill(Lanes::Zero()); }
  // Variance of a change that may have begun, (rad/s)^2.
  [[nodiscard]] const Lanes& unseen() const noexcept { return unseen_; }
  // Variance that the noise makes in the filter at rest, over that of white noise of the R that its rule believes in,
  // which is `rule` of the known one.
  [[nodiscard]] Lanes wide(const Trackers& trackers, double lag, double rule) const noexcept;

 private:
  struct Contest {
    Lanes ratio = Lanes::Zero(), sum = Lanes::Zero(), weight = Lanes::Zero();
    // Variance of a sum over that of white noise, as learned, and what evidence is divided by for it.
    Lanes wide = Lanes::Ones(), divisor = Lanes::Ones(), horizons = Lanes::Zero();
    Lanes times = Lanes::Zero();         // for which a change was likely to have begun
    double shrinks = 0.0, spread = 0.0;  // of an offset's likelihood
    double keep = 0.0, worth = 0.0;      // 1 - 1 / h and 1 / (2 h - 1) of the horizon h
    Lanes rest = Lanes::Zero(), rest2 = Lanes::Zero(), tracker = Lanes::Zero();
  };
  struct Common {
    Lanes clipped, squares, louder;  // louder: variance over the most of the known noise
    double cap, log_rest;
  };
  void contest(const Trackers& trackers, std::size_t j, const Sample& now, const Common& common,
               const Lanes& colour) noexcept;
  void expect(Contest& c, double h, const Lanes& nats, const Sample& now) noexcept;
  [[nodiscard]] double same_size(const Contest& c, Eigen::Index a) const noexcept;

  std::array<Contest, Trackers::kMost> contest_{};
  std::array<Lanes, Trackers::kMost> short_;
  Lanes shaking_ = Lanes::Zero();
  Lanes second_ = Lanes::Ones(), fourth_ = Lanes::Constant(3.0);  // moments of the innovations
  Lanes unseen_ = Lanes::Zero(), widest_ = Lanes::Ones();
  double seen_ = 64.0, age_ = 0.0;  // the latter: samples of rest
  bool suspected_ = false, coloured_ = false;
};

}  // namespace ifog
