// SPDX-License-Identifier: Apache-2.0
// Notices when a sensor's behaviour changes: in the status message and one line in the log. Published data do
// not change. Done by housekeeping, with sums from the hot path.
//
// At rest, blocks of ten seconds (at least a hundred samples) are tested against the sensor's first hours at
// rest:
//
//   noise    mean square of innovations: is more than 1.5 times the former value usual?
//   colour   neighbouring innovations: is a correlation off by 0.1 (or five standard errors) usual? And
//   innovations of the block means: does each follow the one before?
//   bias     block means: have they stepped?
//   range    more than half of the samples of ten minutes were outside the range of the model's channels
//
// The first three have at most one false alarm in thirty days over all axes. Since real innovations differ
// from theory, they are designed for kAlarmEvery_s. 95 % of the alarms are allotted to the bias, as the
// others' bound is far above their actual rate. The last has no false alarms. See sequential_tests.h and
// step_test.h.
//
// A turned sensor senses another part of the Earth's rate, so the level restarts. A turn so slow that it
// looks like rest is reported as a step.
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

class SensorWatch {
 public:
  static constexpr double kAlarmEvery_s = 40.0 * 86400.0;
  static constexpr double kForStep = 0.95;  // share of the alarms
  static constexpr double kBlock_s = 10.0;
  // Blocks at rest before testing starts: two hours.
  static constexpr double kLearned = 720.0;

  SensorWatch(std::size_t axes, double sample_rate_hz);

  // To be called about once a second. samples, out_of_range: counters of published samples.
  void take(const RestSums& sums, std::uint64_t samples, std::uint64_t out_of_range);
  // Another model is in use: learning restarts.
  void renew();

  // Bits NOTICED_… of status_t.
  [[nodiscard]] std::int32_t noticed() const;
  // What was noticed and what to do, one line; "" for nothing. only: mask.
  [[nodiscard]] std::string words(std::int32_t only = ~0) const;
  // Last detected step, rad/s; 0: none.
  [[nodiscard]] double step_radps() const { return step_radps_; }

 private:
  struct Axis {
    Axis(double cusum, double step) : loud(cusum), odd_neighbours(cusum), follows(cusum), steps(step) {}
    RestSums::Axis at_block{};               // sums at the start of the present block
    double blocks = 0.0;                     // learned
    double square = 0.0, correlation = 0.0;  // means over them
    double louder = 0.0;  // mean square / former value, of the latest noisy blocks; 0: none recently
    Cusum loud, odd_neighbours, follows;
    std::optional<double> last_innovation;  // of the block before, with variance 1
    StepTest steps;
    LevelNoise level;
    double skipped = 0.0;   // blocks since the last tested one
    double turned = 0.0;    // rad/s times samples off the level, not at rest
    double bias_for = 0.0;  // blocks for which a step is still reported
  };
  void take_block(Axis& axis, const RestSums::Axis& sums);
  // True: a noisy block.
  bool test_noise(Axis& axis, double square, double correlation, double pairs);
  void test_level(Axis& axis, double mean);
  void follow_motion(Axis& axis, const RestSums::Axis& now, const RestSums::Axis& before) const;

  double block_samples_, period_s_;
  double cusum_, step_;  // thresholds
  std::vector<Axis> axes_;
  RestSums before_{};
  std::uint64_t samples_ = 0, out_of_range_ = 0;  // at the start of the present ten minutes
  std::uint64_t seen_ = 0, seen_out_of_range_ = 0;
  int silent_ = 0;
  bool range_ = false;
  double step_radps_ = 0.0;
};

}  // namespace ifog
