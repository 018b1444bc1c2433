// SPDX-License-Identifier: Apache-2.0
// What the daemon notices of a sensor. Oracles: the law that a test's threshold is derived from, and what was
// put into the samples.
#include <regex>

#include <ifog/status_t.hpp>

#include "daemon/health/sensor_watch.h"
#include "daemon/health/sequential_tests.h"
#include "daemon/health/step_test.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kRate = 10.0;  // Hz: a block is ten seconds, a hundred samples
constexpr double kSigma = 1e-6;

// A sensor whose filter has no lag worth a word: what is published as innovation is the noise.
class Made {
 public:
  explicit Made(unsigned seed, std::size_t axes = 1) : watch(axes, kRate), random_(seed), axes_(axes) {}
  void run(double seconds) {
    for (int second = 0; second < static_cast<int>(seconds); ++second) {
      for (int i = 0; i < static_cast<int>(kRate); ++i) {
        for (std::size_t a = 0; a < axes_; ++a) {
          const double fresh = normal_(random_);
          const double noise = sigma * (colour * last_[a] + std::sqrt(1.0 - colour * colour) * fresh);
          last_[a] = colour * last_[a] + std::sqrt(1.0 - colour * colour) * fresh;
          sums_.add(a, at_rest, rate + noise, noise);
        }
        ++samples_;
        if (out_of_range) ++out_;
      }
      watch.take(sums_, samples_, out_);
      if (watch.noticed() != 0 && found_s < 0.0) found_s = second;
    }
  }
  SensorWatch watch;
  double sigma = kSigma, rate = 3e-5, colour = 0.0, found_s = -1.0;
  bool at_rest = true, out_of_range = false;

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::size_t axes_;
  std::array<double, kMaxAxes> last_{};
  RestSums sums_;
  std::uint64_t samples_ = 0, out_ = 0;
};

constexpr double kHour = 3600.0, kMinute = 60.0;

TEST(SensorWatch, NoticesNothingOfASensorThatStaysAsItIs) {
  Made made(1, 3);
  made.run(24.0 * kHour);
  EXPECT_EQ(made.watch.noticed(), 0) << made.watch.words();
  EXPECT_EQ(made.watch.words(), "");
}

TEST(SensorWatch, NoticesDoubledNoiseAndThatItIsOver) {
  Made made(2);
  made.run(3.0 * kHour);
  made.sigma *= std::sqrt(2.0);
  made.run(10.0 * kMinute);
  EXPECT_EQ(made.watch.noticed(), status_t::NOTICED_NOISE) << made.watch.words();
  EXPECT_GE(made.found_s, 0.0);
  EXPECT_LT(made.found_s, 2.0 * kMinute);
  EXPECT_TRUE(std::regex_search(made.watch.words(), std::regex("1\\.[345] times"))) << made.watch.words();
  made.sigma = kSigma;
  made.run(kHour);
  EXPECT_EQ(made.watch.noticed(), 0) << made.watch.words();
}

TEST(SensorWatch, NoticesNeighboursThatComeToAgree) {
  Made made(3);
  made.run(3.0 * kHour);
  made.colour = 0.8;
  made.run(10.0 * kMinute);
  EXPECT_NE(made.watch.noticed() & status_t::NOTICED_COLOUR, 0) << made.watch.words();
  EXPECT_EQ(made.watch.noticed() & status_t::NOTICED_NOISE, 0);
}

TEST(SensorWatch, NoticesAStepOfTheBiasWithItsSize) {
  for (const double sign : {1.0, -1.0}) {
    Made made(4);
    made.run(6.0 * kHour);
    // Of ten-second means three standard deviations; of a single sample 0.3.
    made.rate += sign * 0.3 * kSigma;
    made.run(10.0 * kMinute);
    EXPECT_EQ(made.watch.noticed(), status_t::NOTICED_BIAS) << made.watch.words();
    EXPECT_NEAR(made.watch.step_radps(), sign * 0.3 * kSigma, 0.1 * kSigma);
    made.run(2.0 * kHour);
    EXPECT_EQ(made.watch.noticed(), 0) << made.watch.words();
  }
}

// Three hundred sigma of ten-second means, as a slow turn that passes for rest: no noise to measure by.
TEST(SensorWatch, AHugeStepHidesNotTheNext) {
  Made made(6);
  made.run(4.0 * kHour);
  made.rate += 30.0 * kSigma;
  made.run(2.0 * kHour);
  EXPECT_EQ(made.watch.noticed(), 0) << made.watch.words();
  made.rate += 0.5 * kSigma;
  made.run(10.0 * kMinute);
  EXPECT_EQ(made.watch.noticed(), status_t::NOTICED_BIAS);
}

TEST(SensorWatch, ATurnIsNoStepAndTheNextStepIsFound) {
  Made made(5);
  made.run(6.0 * kHour);
  made.at_rest = false;
  const double rest = made.rate;
  made.rate = 0.1;
  made.run(20.0);
  made.at_rest = true;
  made.rate = rest + 10.0 * kSigma;  // another part of the Earth's rate
  made.run(kHour);
  EXPECT_EQ(made.watch.noticed(), 0) << made.watch.words();
  made.rate += 0.2 * kSigma;
  made.run(10.0 * kMinute);
  EXPECT_EQ(made.watch.noticed(), status_t::NOTICED_BIAS);
}

TEST(SensorWatch, AStepThatEndsTheRestForAMomentIsAStep) {
  Made made(6);
  made.run(6.0 * kHour);
  made.rate += 2.0 * kSigma;
  made.at_rest = false;
  made.run(1.0);
  made.at_rest = true;
  made.run(5.0 * kMinute);
  EXPECT_EQ(made.watch.noticed(), status_t::NOTICED_BIAS) << made.watch.words();
}

TEST(SensorWatch, NoticesAChannelOutsideTheRangeForLong) {
  Made made(7);
  made.out_of_range = true;
  made.run(5.0 * kMinute);
  made.out_of_range = false;
  made.run(6.0 * kMinute);
  EXPECT_EQ(made.watch.noticed(), 0);
  made.out_of_range = true;
  made.run(20.0 * kMinute);
  EXPECT_EQ(made.watch.noticed(), status_t::NOTICED_RANGE);
  EXPECT_TRUE(test::has(made.watch.words(), "range of the model"));
  made.watch.renew();
  EXPECT_EQ(made.watch.noticed(), 0);
}

TEST(SensorWatch, AnotherModelIsLearnedAnew) {
  Made made(8);
  made.run(3.0 * kHour);
  made.watch.renew();
  made.sigma *= 3.0;
  made.rate += 5.0 * kSigma;
  made.run(3.0 * kHour);
  EXPECT_EQ(made.watch.noticed(), 0) << made.watch.words();
}

// How long a white series takes to alarm, on average, in blocks.
template <typename Alarm>
double mean_time_to_alarm(int runs, Alarm&& alarm_after) {
  double sum = 0.0;
  for (int run = 0; run < runs; ++run) sum += alarm_after(static_cast<unsigned>(run));
  return sum / runs;
}

// What a filter of this gain makes of white innovations.
LevelNoise::Innovation white(double value, double gain) {
  LevelNoise::Innovation out;
  out.known = true;
  out.value = value;
  out.spread = 1.0;
  out.keep.fill(1.0);
  out.gain.back() = gain;
  return out;
}

// Whatever the gain. Of innovations that are not white, whose sums vary by a fifth more, hardly more often once it has
// learned that; not learned, 2.3 times as often.
TEST(StepTest, AlarmsNoMoreOftenThanItIsAllowedTo) {
  constexpr double kBlocks = 3000.0;
  for (const auto& [gain, colour] : {std::pair{0.0, 0.0}, {0.02, 0.0}, {0.2, 0.0}, {0.0, 0.1}}) {
    std::normal_distribution<double> normal;
    double last = 0.0;
    const auto alarms = [&](StepTest& test, std::mt19937_64& random) {
      const double fresh = normal(random), value = fresh + colour * std::exchange(last, fresh);
      return test.take(white(value / std::hypot(1.0, colour), gain));
    };
    StepTest learned(kBlocks);
    std::mt19937_64 before(99);
    for (int n = 0; colour > 0.0 && n < 100'000; ++n) (void)alarms(learned, before);
    const double found = mean_time_to_alarm(test::fewer(100, 20), [&](unsigned seed) {
      std::mt19937_64 random(seed);
      StepTest test = learned;
      test.restart();
      double n = 1.0;
      while (!alarms(test, random)) n += 1.0;
      return n;
    });
    EXPECT_GT(found, (colour > 0.0 ? 0.6 : 0.85) * kBlocks) << gain << ", " << colour;
  }
}

TEST(SequentialTests, ACusumsAlarmsAreNoMoreFrequentThanLordenHasIt) {
  const double threshold = std::log(1000.0);
  const double follows = mean_time_to_alarm(200, [&](unsigned seed) {
    test::Noise normal(seed);
    Cusum test(threshold);
    double n = 0.0, last = normal();
    for (; !test.alarmed(); n += 1.0) {
      const double value = normal();
      test.add(colour_log_ratio(std::exchange(last, value), value));
    }
    return n;
  });
  EXPECT_GT(follows, 1000.0);
  const double usual = mean_time_to_alarm(200, [&](unsigned seed) {
    std::mt19937_64 random(seed);
    std::bernoulli_distribution odd(0.01);
    Cusum test(threshold);
    double n = 0.0;
    for (; !test.alarmed(); n += 1.0) test.add(usual_log_ratio(odd(random)));
    return n;
  });
  EXPECT_GT(usual, 1000.0);
}

// The rate of a gyro whose bias instability meets its white noise at 100 s, S(f) = B^2 / (2 pi f), as processes half a
// decade apart: another table than the filter's.
class Wandering {
 public:
  explicit Wandering(unsigned seed) : made(13), random_(seed) {
    for (double& each : process_) each = kDeviation * normal_(random_);
  }
  void run(double seconds) {
    for (int second = 0; second < static_cast<int>(seconds); ++second) {
      double time_s = 10.0;
      made.rate = rest;
      for (double& each : process_) {
        const double keep = std::exp(-1.0 / time_s);
        made.rate += each = keep * each + kDeviation * std::sqrt(1.0 - keep * keep) * normal_(random_);
        time_s *= kHalfDecade;
      }
      made.run(1.0);
    }
  }
  // What comes is another than it was to be.
  void turn(unsigned seed) { random_.seed(seed); }

  static constexpr double kHalfDecade = 3.1623, kDeviation = 0.03 * kSigma;
  // A process has the variance of half a decade of S(f).
  static double instability() {
    return kDeviation * std::sqrt(2.0 * std::numbers::pi / std::log(kHalfDecade));
  }
  Made made;
  double rest = 3e-5;

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::array<double, 9> process_{};
};

TEST(SensorWatch, OfABiasThatWandersNothingIsNoticedButMostStepsAre) {
  Wandering learned(10);
  learned.run(36.0 * kHour);
  ASSERT_LT(learned.made.found_s, 0.0) << learned.made.watch.words();
  int found = 0;
  constexpr int kTrials = 100;
  for (int trial = 1; trial <= kTrials; ++trial) {
    Wandering each = learned;
    each.turn(static_cast<unsigned>(trial));
    each.run(kMinute);
    each.rest += (trial % 2 == 0 ? 3.0 : -3.0) * Wandering::instability();
    each.run(10.0 * kMinute);
    found += (each.made.watch.noticed() & status_t::NOTICED_BIAS) != 0 ? 1 : 0;
  }
  EXPECT_GT(found, 70);
}

}  // namespace
}  // namespace ifog
