// SPDX-License-Identifier: Apache-2.0
// Axes that are not alike and share one gain: what is said of each is its own, whichever it is.
#include "filters/estimator/estimator.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr std::size_t kAxes = 3;

// One axis that is five times as loud as the two others is no louder than it was where it comes alone: the
// gain, which is one for all, is the same for it.
TEST(UnlikeAxes, TheLoudOneAloneHasNotBecomeLouder) {
  test::Fed filter(test::told(1e-4, 9.0), kAxes);
  test::Noise normal(7);
  double alone = 0.0, together = 0.0;
  for (std::size_t i = 0; i < 40'000; ++i) {
    filter.in.valid_axes = i % 4 == 3 ? 4U : 7U;
    Axes rate{};
    for (std::size_t a = 0; a < kAxes; ++a) rate[a] = (a == 2 ? 5.0 : 1.0) * normal();
    filter.step(rate);
    if (i >= 20'000) (i % 4 == 3 ? alone : together) += filter.out.gain[2];
  }
  EXPECT_NEAR(alone * 3.0 / together, 1.0, 0.1);
}

// One of three that is not measured for a while, or repeats a value: as a walk it is known less by its
// driving noise times the time, whatever the others are known by.
TEST(UnlikeAxes, OneThatIsNotMeasuredIsKnownEverLess) {
  constexpr double kWalk = 1e-4;
  for (const bool stuck : {false, true}) {
    for (const int axes : {1, 3}) {
      test::Fed filter(test::told(kWalk), axes);
      const auto last = static_cast<std::size_t>(axes - 1);
      std::array<test::Record, kAxes> records;
      for (std::size_t a = 0; a < kAxes; ++a) records[a] = test::record(a + 1, 30'000, kWalk);
      const EstimatorOutput& out = filter.out;
      double early = 0.0;
      for (std::size_t i = 0; i < 30'000; ++i) {
        const bool lost = i >= 10'000 && i < 20'000;
        Axes rate{};
        for (std::size_t a = 0; a <= last; ++a) rate[a] = records[a].measured[i];
        if (lost && stuck) rate[last] = records[last].measured[9'999];
        filter.in.valid_axes = (1U << axes) - 1U - (lost && !stuck ? 1U << last : 0U);
        filter.in.stuck_axes = lost && stuck ? 1U << last : 0U;
        filter.step(rate);
        if (i == 12'000) early = out.variance_rad2ps2[last];
        if (i == 10'500 && !stuck) {
          EXPECT_NEAR(out.variance_rad2ps2[last], 0.01 + 500 * kWalk, 0.015) << axes;
        }
        if (i != 19'999) continue;
        EXPECT_NEAR(out.variance_rad2ps2[last] - early, 7999 * kWalk, 0.1) << axes << stuck;
      }
      EXPECT_LT(out.variance_rad2ps2[last], 0.02) << axes << stuck;
    }
  }
}

// What is foreseen of a motion whose samples are lost is worth something for a while, then nothing: behind a
// gap the measurement counts, in it the variance says how little is known. Told by the truth of the records
// that are made here; 1 kHz, noise 1e-5 rad/s.

constexpr double kPeriod = 1e-3, kNoise = 1e-5;

class Sensor {
 public:
  Sensor(int axes, double q_over_r, unsigned seed)
      : axes_(axes), estimator_(settings(q_over_r), axes, kPeriod), random_(seed) {}

  // All axes turn alike at so many sigma, and those in `lost` are missing; `missed` rows before this one.
  void step(double sigmas, std::uint32_t lost = 0, int missed = 0, std::array<double, 3> added = {}) {
    EstimatorInput in;
    in.sequence = sequence_++;
    in.dt_s = kPeriod * (missed + 1);
    for (std::size_t a = 0; a < static_cast<std::size_t>(axes_); ++a) {
      in.rate_radps[a] = kNoise * (sigmas + normal_(random_) + added[a]);
      if ((lost >> a & 1U) != 0) continue;
      in.valid_axes |= 1U << a;
      in.covered_s[a] = kPeriod;
    }
    estimator_.step(in, out_);
  }
  [[nodiscard]] double rate(std::size_t axis) const { return out_.denoised_radps[axis] / kNoise; }
  [[nodiscard]] double sd(std::size_t axis) const { return std::sqrt(out_.variance_rad2ps2[axis]) / kNoise; }
  [[nodiscard]] bool under_way() const { return (out_.flags & kManoeuvre) != 0; }
  [[nodiscard]] const EstimatorHealth& health() const { return estimator_.health(); }

 private:
  static FilterSettings settings(double q_over_r) {
    FilterSettings settings;
    settings.measurement_noise = kNoise * kNoise;
    settings.process_noise = q_over_r * kNoise * kNoise / kPeriod;
    return settings;
  }
  int axes_;
  Estimator estimator_;
  EstimatorOutput out_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uint64_t sequence_ = 0;
};

double swing(double sigmas, double cycles) { return sigmas * std::sin(2.0 * std::numbers::pi * cycles); }

// Gaps of 300 to 3000 samples each, wherever the trackers have started again.
TEST(LostAxes, BehindAGapInASwingTheMeasurementCounts) {
  for (const double q_over_r : {1e-6, 1e-9}) {
    for (const double sigmas : {3.0, 1000.0}) {
      for (const double cycles_a_sample : {1e-4, 1e-3}) {
        Sensor sensor(3, q_over_r, 3);
        std::mt19937_64 random(4);
        std::uniform_real_distribution<double> uniform;
        long at = 0;
        int gaps = 0;
        for (int i = 0; i < 30'000; ++i) {
          const bool gap = i > 5000 && uniform(random) < 0.005, was_under_way = sensor.under_way();
          const int missed = gap ? static_cast<int>(300.0 * std::pow(10.0, uniform(random))) : 0;
          at += 1 + missed;
          const double truth = i > 5000 ? swing(sigmas, cycles_a_sample * static_cast<double>(at)) : 0.0;
          sensor.step(truth, 0, missed);
          if (!gap || !was_under_way) continue;
          ++gaps;
          for (std::size_t a = 0; a < 3; ++a)
            ASSERT_NEAR(sensor.rate(a), truth, 20.0)
                << q_over_r << ", " << sigmas << ", " << cycles_a_sample << ", " << i;
        }
        EXPECT_GT(gaps, 50);
      }
    }
  }
}

// Nobody knows what it does then: what is published stays what such a vibration can be, and within what the
// variance says.
TEST(LostAxes, OfAVibrationThatIsLostNoParabolaIsLeft) {
  for (const std::uint32_t lost : {1U, 3U}) {
    for (const double sigmas : {30.0, 3000.0}) {
      for (const double cycles_a_sample : {0.005, 0.02, 0.1}) {
        for (int phase = 0; phase < 8; ++phase) {
          Sensor sensor(2, 1e-6, static_cast<unsigned>(phase));
          const int from = 4000 + static_cast<int>(phase / 8.0 / cycles_a_sample);
          for (int i = 0; i < from + 1000; ++i) {
            const double truth = i > 2000 ? swing(sigmas, cycles_a_sample * (i - 2000)) : 0.0;
            sensor.step(truth, i < from ? 0 : lost);
            if (i < from) continue;
            ASSERT_LT(std::abs(sensor.rate(0)), 3.0 * sigmas) << lost << ", " << cycles_a_sample << ", " << i;
            ASSERT_LT(std::abs(sensor.rate(0) - truth), 8.1 * sensor.sd(0))
                << lost << ", " << sigmas << ", " << cycles_a_sample << ", " << i;
          }
        }
      }
    }
  }
}

// One sample of x is far, then x is gone. Long after, one of y is: no jump of both.
TEST(LostAxes, AnOutlierThatWasItsAxisLastIsNoPartOfWhatComesLongAfter) {
  Sensor sensor(3, 1e-6, 5);
  for (int i = 0; i < 20'000; ++i) {
    std::array<double, 3> added{};
    if (i == 5000) added[0] = 1000.0;
    if (i == 15'000) added[1] = 8.0;
    sensor.step(0.0, i > 5000 ? 1 : 0, 0, added);
    if (i < 5000) continue;
    ASSERT_LT(std::abs(sensor.rate(0)), 1.0) << i;
    ASSERT_LT(std::abs(sensor.rate(1)), 1.0) << i;
  }
  EXPECT_EQ(sensor.health().manoeuvres, 0U);
}

}  // namespace
}  // namespace ifog
