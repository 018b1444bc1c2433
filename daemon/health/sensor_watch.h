// SPDX-License-Identifier: Apache-2.0
// Notices when a sensor is no longer what it was: for people, in the status message and as one line in the
// log. What is published does not change for it. Housekeeping's work, on sums that the hot path keeps.
//
// While the sensor rests, blocks of ten seconds (of a hundred samples at least) are tested, each kind against
// what the sensor itself has shown in its first hours at rest:
//
//   noise    the mean square of the innovations: is it usual that a block's is over 1.5 times what it was?
//   colour   neighbouring innovations: is it usual that their correlation is off by 0.1 (or five standard errors)?
//            And the block means, in the innovations of their own level: does each follow the one before?
//   bias     block means: have they stepped?
//   range    more than half of the samples of ten minutes were outside the range of the model's channels
//
// The first three are wrong at most once in thirty days of all axes together. As real innovations are not
// quite those of the theory, they are designed for kAlarmEvery_s, which is shared among them: nineteen in
// twenty of the alarms to the bias, which needs them most, as the others' bound is far above what they do;
// the last cannot be wrong. See sequential_tests.h and step_test.h.
//
// A sensor that is turned rests at another rate afterwards, as the Earth turns: the level then restarts.
// A sensor that turns so slowly that it passes for rest is reported as a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/health/level_noise.h"
#include "daemon/health/rest_sums.h"
#include "daemon/health/sequential_tests.h"
#include "daemon/health/step_test.h"

namespace ifog {

// status_t's NOTICED_…
enum Noticed : std::int32_t {
  kNoticedNoise = 1,
  kNoticedColour = 2,
  kNoticedBias = 4,
  kNoticedRange = 8,
};

class SensorWatch {
 public:
  static constexpr double kAlarmEvery_s = 40.0 * 86400.0;
  static constexpr double kForStep = 0.95;  // of the alarms
  static constexpr double kBlock_s = 10.0;
  // Blocks at rest before anything is tested: two hours.
  static constexpr double kLearned = 720.0;

  SensorWatch(std::size_t axes, double sample_rate_hz);

  // What there is by now, about once a second. samples, out_of_range: counters of published samples.
  void take(const RestSums& sums, std::uint64_t samples, std::uint64_t out_of_range);
  // Another model is in use: what it leaves is learned again.
  void renew();

  [[nodiscard]] std::int32_t noticed() const;
  // What is noticed and what to do about it, one line; "" for nothing. only: these of it.
  [[nodiscard]] std::string words(std::int32_t only = ~0) const;
  // The last step that was found, rad/s; 0: none was.
  [[nodiscard]] double step_radps() const { return step_radps_; }
  // For who wants to know how near it was: StepTest::nearest() of all axes.
  [[nodiscard]] double nearest_step() const;

 private:
  struct Axis {
    Axis(double usual, double colour, double step);
    RestSums::Axis at_block{};               // the sums when the block under way began
    double blocks = 0.0;                     // learned
    double square = 0.0, correlation = 0.0;  // means over them
    double louder = 0.0;  // mean square over what it was, of the latest loud blocks; 0: none of late
    UsualCusum loud, odd_neighbours;
    ColourCusum follows;
    StepTest steps;
    LevelNoise level;
    double skipped = 0.0;   // blocks since the last that was tested
    double turned = 0.0;    // rad/s times samples away from the level, not at rest
    double bias_for = 0.0;  // blocks that a step is still reported for
  };
  void take_block(Axis& axis, const RestSums::Axis& sums);
  // True: a loud block.
  bool test_noise(Axis& axis, double square, double correlation, double pairs);
  void test_level(Axis& axis, double mean);
  void follow_motion(Axis& axis, const RestSums::Axis& now, const RestSums::Axis& before) const;

  double block_samples_, period_s_;
  std::vector<Axis> axes_;
  RestSums before_{};
  std::uint64_t samples_ = 0, out_of_range_ = 0;  // when the ten minutes under way began
  std::uint64_t seen_ = 0, seen_out_of_range_ = 0;
  int silent_ = 0;
  bool range_ = false;
  double step_radps_ = 0.0;
};

}  // namespace ifog
