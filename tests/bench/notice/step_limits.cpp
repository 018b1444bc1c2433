// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/notice/step_limits.h"

#include <cstdio>
#include <random>
#include <vector>

#include "daemon/health/sensor_watch.h"
#include "daemon/health/step_test.h"
#include "tests/bench/notice/noise_kinds.h"
#include "tests/bench/notice/step_bound.h"
#include "tests/bench/notice/step_scan.h"

namespace ifog::bench {
namespace {

constexpr double kLimitBlock_s = SensorWatch::kBlock_s, kLimitLook_s = 600.0, kMonth_s = 30.0 * 86400.0;
constexpr double kFine = 20.0;  // of a block; small enough to be continuous
constexpr std::size_t kLooks = static_cast<std::size_t>(kLimitLook_s / kLimitBlock_s), kTrials = 20000;
constexpr double kTimes = 5.0, kAllowed = kLimitBlock_s / kMonth_s;

std::vector<StepScan::Window> of_the_test() {
  std::vector<StepScan::Window> out;
  for (std::size_t i = 0; i < StepTest::kLengths.size(); ++i)
    out.push_back({StepTest::kLengths[i], StepTest::kShares[i]});
  return out;
}

void print_limits(const NoiseKind& kind, std::size_t blocks, unsigned seed) {
  std::mt19937_64 random(seed);
  const double step = kTimes * bias_instability(kind);
  const std::vector<double> left = left_of_step(kind, step, kLimitBlock_s, kLooks);
  const double d = deviations(left);
  const double finely =
      deviations(left_of_step(kind, step, kLimitBlock_s / kFine, kLooks * static_cast<std::size_t>(kFine)));
  StepScan one_sided(left, {{kLooks, 1.0}}, false), one(left, {{kLooks, 1.0}}, true),
      test(left, of_the_test(), true);
  for (StepScan* scan : {&one_sided, &one, &test}) scan->watch_nothing(blocks, random);
  const auto share = [&](const StepScan& scan, double level, bool anywhere) {
    const std::size_t looks = anywhere ? kLooks - 1 : kLooks;
    return 100.0 * scan.found(level, looks, anywhere, kTrials, random);
  };
  const double designed = kLimitBlock_s / SensorWatch::kAlarmEvery_s * SensorWatch::kForStep;
  std::printf(
      "%-18s d %.2f (%.2f without blocks); all known %.1f %%; time unknown %.1f %%; and the sign %.1f %%; "
      "windows of the test %.1f %%, step anywhere in a block %.1f %%; its formula %.1f %%; its margin %.1f "
      "%%; alarms by the formula, of those there are: one window %.2f, all %.2f\n",
      kind.name.c_str(), d, finely, 100.0 * best_share(d, kLimitLook_s, kMonth_s),
      share(one_sided, one_sided.level(kAllowed), false), share(one, one.level(kAllowed), false),
      share(test, test.level(kAllowed), false), share(test, test.level(kAllowed), true),
      share(test, kAllowed, false), share(test, designed, false), kAllowed / one.alarms_per_block(kAllowed),
      kAllowed / test.alarms_per_block(kAllowed));
  std::fflush(stdout);
}

}  // namespace

void print_limits(std::size_t blocks, unsigned seed, const std::string& word) {
  for (const NoiseKind& kind : kinds())
    if (bias_instability(kind) > 0.0 && kind.name.find(word) != std::string::npos)
      print_limits(kind, blocks, seed);
}

}  // namespace ifog::bench
