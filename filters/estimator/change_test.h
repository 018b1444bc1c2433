// SPDX-License-Identifier: Apache-2.0
// Whether the rate changes: does a tracker predict the measurements so much better than the filter at rest
// that noise cannot be the reason?
//
// For each tracker the log-likelihood ratio of its predictions against those of the filter at rest, over
// three of its memories: Page's test (Biometrika 41, 1954) with a bank of alternatives, so that a jump is
// found in samples and a drift of a hundredth of the noise in thousands. Three things keep noise out:
// - a single measurement counts for no more than outliers are rare (OutlierRun);
// - where the noise is coloured at rest, the ratio is divided by how much wider the sums of innovations over
//   that horizon are than white noise's;
// - noise that has just become louder is told from motion by the ratio each predictor earns under its own
//   best variance, the known one forgotten: the generalised likelihood ratio with unknown variance;
// - a model of colour or of a line may have become wrong, and then its filter predicts worse than any
//   tracker, though nothing moves: what a tracker gains on it all the time is no change.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "filters/estimator/lanes.h"
#include "filters/estimator/noise_scale.h"
#include "filters/estimator/tracker_bank.h"

namespace ifog {

// What a step knows of its measurement beside the measurement.
struct Surprise {
  std::uint32_t valid = 0;  // axes whose noise is known
  Axes rate{};
  Axes innovation{};         // of the filter at rest
  Axes covered_s{};          // time it stands for
  Axes scale{};              // variance of an innovation at rest as the noise is now
  Axes degrees{};            // of freedom that it is known with
  double rest_factor = 1.0;  // innovation variance of the filter at rest over that
};

// Of the error of the filter at rest, of which half is taken for noise and half for what it lags behind: by
// how much each is really more.
struct Wider {
  double noise = 1.0, walk = 1.0;
};

class ChangeTest {
 public:
  // e^-18 is 1.5e-8: on white noise not one false change in 3e6 samples.
  static constexpr double kEvidence = 18.0;

  // rate_alone: that of the filter at rest. axes: of the sensor, the first ones.
  explicit ChangeTest(bool rate_alone, std::size_t axes = kMaxAxes);

  // After trackers.predict(), before correct(). most: what one measurement may count for at most; lag: of the
  // filter at rest, samples. Gives the tracker that shows a change.
  std::optional<std::size_t> take(const TrackerBank& trackers, const Surprise& now,
                                  const std::array<NoiseScale, kMaxAxes>& noise, double most,
                                  double lag) noexcept;
  // Half of the evidence for a change has come together.
  [[nodiscard]] bool suspected() const noexcept { return suspected_; }
  // Mean square of what the filter at rest may be off by, (rad/s)^2, where its innovations lately have a mean
  // that noise alone seldom gives: a change may have begun, long before there is evidence enough for one.
  [[nodiscard]] double unseen(std::size_t axis) const noexcept { return unseen_[axis]; }
  // There was motion within the last thousand samples.
  [[nodiscard]] bool lately_moved() const noexcept { return relaxed_ > kLately; }
  // The change was dealt with. Lately there was motion: the next one needs less evidence for a while.
  void restart() noexcept;
  // What has come together until now was no evidence.
  void forget() noexcept;
  // Over white noise as loud as an axis' innovations, and the walk that their variance and the gain go with.
  // expected: of the innovations' variance the part that the filter takes for noise and walk; of the walk
  // what is believed of it before the innovations say more.
  [[nodiscard]] Wider wider(const TrackerBank& trackers, std::size_t axis, double lag,
                            const NoiseScale& noise, const Wider& expected) noexcept;
  // Sum of the innovations an axis has had over the tracker's horizon, by the time each stands for, rad: what
  // was owed before is not this change's.
  [[nodiscard]] double fallen_short(std::size_t tracker, std::size_t axis) const noexcept {
    return contests_[tracker].sums.angle[static_cast<Eigen::Index>(axis)];
  }
  [[nodiscard]] static double horizon(double memory) noexcept;

 private:
  // What all trackers are held against; 0 of an axis that is not measured.
  struct Measured {
    Lanes used = Lanes::Zero();  // 1: measured
    Lanes rate = Lanes::Zero(), scale = Lanes::Ones();
    Lanes rest = Lanes::Zero(), spoke_for_rest = Lanes::Zero();
    Lanes normalised = Lanes::Zero(), angle = Lanes::Zero();
    double rest_square = 0.0;
  };
  // What is the same for every measurement.
  struct Horizon {
    Horizon() = default;
    explicit Horizon(double length);
    double samples = 0.0;
    double share = 0.0, keep = 0.0;  // of one measurement, and what is kept of those before
    double keep_square = 0.0;
    double evidence = 0.0;  // asked for: a ratio over a long horizon is not looked at afresh each time
  };

  struct Sums {
    Lanes angle = Lanes::Zero();       // of innovations by their time over the horizon
    Lanes normalised = Lanes::Zero();  // the same of innovations over their scale
    Lanes weight = Lanes::Zero();      // variance of that if they are white
    Lanes widening = Lanes::Ones();    // of its variance over white noise's, as found
    Lanes horizons = Lanes::Zero();    // from so many of them

    void add(const Measured& now, const Horizon& over) noexcept;
    // Of this axis as they were.
    void keep(const Sums& before, Eigen::Index axis) noexcept;
  };

  struct Contest {
    double ratio = 0.0;  // log-likelihood ratio
    double usual = 0.0;  // what a measurement adds to it, on average over many horizons
    // Of normalised squares over the horizon: the filter at rest's, the tracker's, and the squares of the
    // former, for the number of measurements they stand on.
    double rest = 0.0, tracker = 0.0, rest_squares = 0.0;
    Sums sums;
  };

  // The horizons that say what the filter at rest lags behind with, by its lag and the trackers there are.
  struct Behind {
    double lag = -1.0;
    std::size_t trackers = 0;
    std::size_t longest = 1;  // of these horizons; 1: none is
    double gain = 0.0, forgets = 0.0;
    double unseen = 0.0;  // normalised square of a sum that is a sign of a change
  };

  [[nodiscard]] Measured measured(const Surprise& now, const std::array<NoiseScale, kMaxAxes>& noise,
                                  double most) noexcept;
  void add(const Measured& now, const Horizon& over, std::uint32_t valid, Sums& sums) const noexcept;
  void add_some(const Measured& now, const Horizon& over, std::uint32_t valid, Sums& sums) const noexcept;
  // By how much the test is to believe the sums wider than white noise's.
  [[nodiscard]] static Lanes wide(const Sums& sums, const Horizon& over, std::uint32_t coloured,
                                  const std::array<NoiseScale, kMaxAxes>& noise) noexcept;
  [[nodiscard]] double unusual() const noexcept;
  void see(const Sums& sums, const Surprise& now, const Lanes& square, const Lanes& limit) noexcept;
  [[nodiscard]] static double unknown_variance(const Contest& contest) noexcept;
  [[nodiscard]] static double believed(const Sums& sums, Eigen::Index axis, double before = 1.0) noexcept;
  void look_behind(const TrackerBank& trackers, double lag) noexcept;
  [[nodiscard]] double walk(std::size_t axis, double expected) const noexcept;
  [[nodiscard]] double coloured(const TrackerBank& trackers, std::size_t axis, double lag,
                                double share) const noexcept;

  // Of relaxed_ what is left after the samples that it is named by.
  static constexpr double kLately = 3.7;

  bool rate_alone_;
  std::uint32_t axes_;  // of the sensor, bit i
  std::array<Contest, TrackerBank::kMost> contests_{};
  std::array<Horizon, TrackerBank::kMost> horizons_{};
  std::size_t known_ = 0;  // of horizons_
  // What one measurement is clipped by, normalised: of skewed noise that has a mean. From so many.
  Axes clipped_{}, clipped_count_{};
  Behind behind_;
  double relaxed_ = 0.0;
  bool suspected_ = false;
  Axes unseen_{};
};

}  // namespace ifog
