// SPDX-License-Identifier: Apache-2.0
// A sensor that turns while samples are lost, or come and cannot be used: the motion is still a motion, and
// none of its angle goes. Told by the truth of the records that are made here; 1 kHz, noise 1e-4 rad/s.
#include "filters/estimator/estimator.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace {

constexpr double kPeriod = 1e-3, kNoise = 1e-4;
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// What becomes of a sample of an axis.
enum class Sample { good, missing, invalid };

ifog::FilterSettings settings() {
  ifog::FilterSettings settings;
  settings.process_noise = 1e-13;
  settings.measurement_noise = kNoise * kNoise;
  return settings;
}

struct Seen {
  double square = 0.0, normalised = 0.0, worst = 0.0, worst_sigmas = 0.0, angle = 0.0;
  int count = 0, at_rest = 0, not_finite = 0;
  [[nodiscard]] double rms() const { return std::sqrt(square / count); }
  [[nodiscard]] double nees() const { return normalised / count; }
};

// `axes` axes that all turn alike; the first one's samples are lost as told, those of the others come (where
// all that there are are missing there is no step at all).
class Turning {
 public:
  Turning(int axes, std::function<double(int)> motion, std::function<Sample(int)> fate)
      : axes_(axes),
        motion_(std::move(motion)),
        fate_(std::move(fate)),
        estimator_(settings(), axes, kPeriod) {}

  // What is seen of the first axis, over the samples [from, to) that are received.
  Seen go(int from, int to, int length) {
    Seen seen;
    int lost = 0;
    for (int i = 0; i < length; ++i) {
      const Sample fate = fate_(i);
      ifog::EstimatorInput in;
      in.sequence = static_cast<std::uint64_t>(i);
      for (int a = 0; a < axes_; ++a)
        measure(in, static_cast<std::size_t>(a), i, a == 0 ? fate : Sample::good);
      if (fate == Sample::missing) {
        ++lost;
        continue;
      }
      in.dt_s = kPeriod * (std::exchange(lost, 0) + 1);
      estimator_.step(in, out_);
      look(in, i, i >= from && i < to, seen);
    }
    return seen;
  }
  [[nodiscard]] const ifog::EstimatorOutput& out() const { return out_; }

 private:
  void measure(ifog::EstimatorInput& in, std::size_t axis, int i, Sample fate) {
    in.rate_radps[axis] = motion_(i) + kNoise * normal_(random_);
    in.covered_s[axis] = kPeriod;
    if (fate == Sample::invalid) {
      in.rate_radps[axis] = kMissing;
      in.covered_s[axis] = 0.0;
    } else {
      in.valid_axes |= 1U << axis;
    }
  }
  void look(const ifog::EstimatorInput& in, int i, bool judged, Seen& seen) const {
    const bool valid = (in.valid_axes & 1U) != 0;
    const double error = out_.denoised_radps[0] - motion_(i);
    if (!std::isfinite(error) || !(out_.variance_rad2ps2[0] >= 0.0)) {
      ++seen.not_finite;
      return;
    }
    if (valid) seen.angle += (out_.denoised_radps[0] - in.rate_radps[0]) * kPeriod;
    if (!judged) return;
    seen.worst = std::max(seen.worst, std::abs(error));
    seen.worst_sigmas = std::max(seen.worst_sigmas, std::abs(error) / std::sqrt(out_.variance_rad2ps2[0]));
    seen.at_rest += (out_.flags & ifog::kAtRest) != 0 ? 1 : 0;
    if (!valid) return;
    seen.square += error * error;
    seen.normalised += error * error / out_.variance_rad2ps2[0];
    ++seen.count;
  }

  int axes_;
  std::function<double(int)> motion_;
  std::function<Sample(int)> fate_;
  ifog::Estimator estimator_;
  ifog::EstimatorOutput out_;
  std::mt19937_64 random_{4};
  std::normal_distribution<double> normal_;
};

// Two axes, of which the first one has all its samples.
class TwoAxes {
 public:
  explicit TwoAxes(unsigned seed) : filter_(settings(), 2, kPeriod), random_(seed) {}
  const ifog::EstimatorOutput& step(double first, double second, Sample of_second = Sample::good) {
    const bool good = of_second == Sample::good;
    const double noise = kNoise * normal_(random_), other = kNoise * normal_(random_);
    filter_.in.valid_axes = good ? 3 : 1;
    filter_.in.covered_s = {kPeriod, good ? kPeriod : 0.0};
    return filter_.step({first + noise, good ? second + other : kMissing});
  }
  [[nodiscard]] const ifog::EstimatorHealth& health() const { return filter_.estimator.health(); }

 private:
  ifog::test::Fed filter_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

// From 5 s to 65 s, then rest.
std::function<double(int)> sine(double amplitude, double hertz) {
  return [=](int i) {
    return i < 5000 || i >= 65'000
               ? 0.0
               : amplitude * std::sin(2 * std::numbers::pi * hertz * (i - 5000) * kPeriod);
  };
}

TEST(Holes, AMotionIsFollowedThroughThem) {
  for (const double amplitude : {1e-3, 0.02, 0.2}) {
    if (ifog::test::kSanitized && amplitude != 0.02) continue;
    for (const double hertz : {0.1, 2.0}) {
      // A slow motion begins as rest, and passes for it where it turns back.
      const Seen whole =
          Turning(1, sine(amplitude, hertz), [](int) { return Sample::good; }).go(7000, 65'000, 90'000);
      for (const int every : {200, 5000}) {
        for (const Sample how : {Sample::missing, Sample::invalid}) {
          const auto fate = [=](int i) {
            return i > 6000 && i < 65'000 && i % every < 20 ? how : Sample::good;
          };
          const Seen seen = Turning(1, sine(amplitude, hertz), fate).go(7000, 65'000, 90'000);
          const auto which = testing::Message() << amplitude << " rad/s, " << hertz << " Hz, every " << every
                                                << (how == Sample::missing ? " missing" : " invalid");
          EXPECT_LT(seen.rms(), kNoise) << which;
          EXPECT_LT(std::abs(seen.angle), 1e-4) << which;  // 0.006°
          EXPECT_LE(seen.at_rest, whole.at_rest + 500) << which;
          EXPECT_EQ(seen.not_finite, 0) << which;
        }
      }
    }
  }
}

// A logger records bursts with gaps between them, e.g. one of a temperature run (51 samples, 283 lost). The gains of one
// sample would make a tracker unstable there.
TEST(Holes, GapsInARhythmLeaveTheTrackersStable) {
  for (const double amplitude : {0.0, 0.05}) {
    const auto motion = [=](int i) { return amplitude * std::sin(0.4 * std::numbers::pi * i * kPeriod); };
    for (const auto& [there, lost] :
         {std::pair{2, 20}, {3, 3}, {10, 16}, {20, 49}, {48, 99}, {51, 283}, {200, 399}, {1000, 30}}) {
      const auto fate = [there = there, lost = lost](int i) {
        return i % (there + lost) < there ? Sample::good : Sample::missing;
      };
      const Seen seen = Turning(1, motion, fate).go(10'000, 100'000, 100'000);
      const auto which = testing::Message() << amplitude << " rad/s, " << there << " and " << lost << " lost";
      EXPECT_EQ(seen.not_finite, 0) << which;
      EXPECT_LT(seen.rms(), (amplitude == 0.0 ? 0.3 : 1.05) * kNoise) << which;
      EXPECT_LT(seen.worst, 6.0 * kNoise) << which;
      EXPECT_LT(seen.nees(), 1.5) << which;
    }
  }
}

// Some of each n samples cannot be used, from the first one on or in a turn, of the only axis or of one of
// three.
TEST(Holes, UnusableSamplesInARhythmLeaveTheTrackersStable) {
  for (const int axes : {1, 3}) {
    for (const double amplitude : {0.0, 1e-3, 0.05}) {
      if (ifog::test::kSanitized && amplitude != 0.05) continue;
      const auto motion = [=](int i) { return amplitude * std::sin(2 * std::numbers::pi * i * kPeriod); };
      const Seen whole = Turning(axes, motion, [](int) { return Sample::good; }).go(1000, 8000, 8000);
      for (const int begin : {0, 3000}) {
        for (const int n : {2, 3, 10, 20}) {
          for (const int k : {1, 2, n - 2, n - 1}) {
            if (k < 1 || k >= n) continue;
            const auto fate = [=](int i) {
              return i >= begin && i < begin + 3000 && i % n < k ? Sample::invalid : Sample::good;
            };
            const Seen seen = Turning(axes, motion, fate).go(1000, 8000, 8000);
            const auto which = testing::Message() << axes << " axes, " << amplitude << " rad/s, " << k
                                                  << " of " << n << " from " << begin;
            EXPECT_EQ(seen.not_finite, 0) << which;
            EXPECT_LT(seen.worst, amplitude + 0.05) << which;  // 500 sigmas, where it ran away without end
            if (n > 10) continue;
            // Weights are those of all axes: one that comes more seldom than the others is followed with
            // their memory, as far behind as its samples are apart.
            const bool seldom = axes > 1 && 2 * k > n;
            EXPECT_LT(seen.rms(), seldom ? 0.05 * amplitude + kNoise : 1.05 * kNoise) << which;
            // What is foreseen where nothing was measured is as uncertain as it says.
            EXPECT_LT(seen.worst_sigmas, axes > 1 ? 25.0 : std::max(25.0, 1.5 * whole.worst_sigmas)) << which;
          }
        }
      }
    }
  }
}

// The first samples of a jump, when a hole comes before it is known to be one.
TEST(Holes, NoAngleOfAJumpIsLostInThem) {
  for (const int before : {1, 2, 3}) {
    for (const int missing : {8, 30}) {
      const auto motion = [](int i) { return i >= 3000 && i < 4000 ? 1.0 : 0.0; };
      const auto fate = [=](int i) {
        return i >= 3000 + before && i < 3000 + before + missing ? Sample::missing : Sample::good;
      };
      EXPECT_LT(std::abs(Turning(1, motion, fate).go(0, 1, 60'000).angle), 1e-4) << before << ", " << missing;
    }
  }
  // One measurement of it, then none for a while.
  const auto motion = [](int i) { return i >= 3000 && i < 4000 ? 1.0 : 0.0; };
  for (const int invalid : {1, 8}) {
    const auto fate = [=](int i) { return i > 3000 && i <= 3000 + invalid ? Sample::invalid : Sample::good; };
    EXPECT_LT(std::abs(Turning(1, motion, fate).go(0, 1, 60'000).angle), 1e-4) << invalid;
  }
}

// One axis jumps while another that turns has no measurement.
TEST(Holes, AnAxisThatIsNotMeasuredWhileAnotherJumpsStaysWhereItIs) {
  for (const bool under_way : {false, true}) {
    TwoAxes sensor(3);
    for (int i = 0; i < 4000; ++i) {
      const double x =
          (under_way && i >= 2000 ? 0.05 * std::sin((i - 2000) * 3e-3) : 0.0) + (i >= 2100 ? 0.05 : 0.0);
      const ifog::EstimatorOutput& out =
          sensor.step(x, 0.5, i >= 2095 && i < 2105 ? Sample::invalid : Sample::good);
      ASSERT_NEAR(out.denoised_radps[1], 0.5, 20 * kNoise) << i << ", under way " << under_way;
      if (i >= 2200) {
        ASSERT_NEAR(out.denoised_radps[0], x, 10 * kNoise) << i << ", under way " << under_way;
      }
    }
    EXPECT_EQ(sensor.health().divergences, 0U);
  }
}

// What is not a number, on an axis while another jumps, leaves nothing behind: its variance stays that of
// what is known, and a step of it afterwards is followed like any.
TEST(Holes, AnAxisWithoutANumberWhileAnotherJumpsFollowsItsOwnStepAfterwards) {
  for (const double missing : {kMissing, HUGE_VAL, -HUGE_VAL})
    for (const int from : {2090, 2099, 2100, 2101, 2110})
      for (const int length : {1, 10, 200}) {
        TwoAxes sensor(5);
        double variance = 0.0;
        for (int i = 0; i < 4000; ++i) {
          const double step = i >= 3000 ? 50.0 * kNoise : 0.0;
          // The device calls every sample good.
          const ifog::EstimatorOutput& out =
              sensor.step(i >= 2100 ? 0.05 : 0.0, i >= from && i < from + length ? missing : step);
          variance = out.variance_rad2ps2[1];
          ASSERT_TRUE(std::isfinite(out.denoised_radps[1])) << i;
          ASSERT_GT(variance, 0.0) << i;
          // Little is known of an axis that is not measured while another jumps, and of its own step at
          // first.
          if (i < from || (i > from + length + 500 && i < 3000) || i > 3500) {
            ASSERT_LT(variance, 2.2 * kNoise * kNoise) << i << ", " << from << ", " << length;
          }
          if (i == 3010) {
            ASSERT_NEAR(out.denoised_radps[1], step, 0.1 * step) << from << ", " << length;
          }
        }
        // It has had 1000 samples since its step: no less than a mean of five times as many.
        EXPECT_GT(variance, kNoise * kNoise / 5000.0);
      }
}

// A car or a drone whose log lacks every seventh row: no parabola is laid through a shaking, and a smooth turn is not held.
TEST(Holes, AMissingSampleOfAShakeIsHeldAndOfATurnPredicted) {
  for (const bool shakes : {true, false}) {
    ifog::test::Fed filter(ifog::test::told(1e-6));
    ifog::test::Noise normal(3);
    double last = 0.0, before = 0.0, square = 0.0, held = 0.0, nees = 0.0, count = 0.0;
    for (int i = 0; i < 12'000; ++i) {
      const double turn = 300.0 * std::sin(0.1 * i), now = 100.0 * normal();
      const double shake = now - std::exchange(before, now);  // its angle is bounded
      const double rate = (i < 2000 ? 0.0 : shakes ? shake : turn) + normal();
      const bool missing = i % 7 == 6;
      filter.in.valid_axes = missing ? 0U : 1U;
      const ifog::EstimatorOutput& out = filter.step({rate});
      ASSERT_GT(out.variance_rad2ps2[0], 1e-6) << i;
      if (missing && i > 3000) {
        square += std::pow(out.denoised_radps[0] - rate, 2);
        nees += std::pow(out.denoised_radps[0] - rate, 2) / out.variance_rad2ps2[0];
        held += std::pow(last - rate, 2);
        count += 1.0;
      }
      if (!missing) last = rate;
    }
    EXPECT_LT(std::sqrt(square / held), shakes ? 1.05 : 0.25);
    EXPECT_LT(nees / count, 2.0) << shakes;
    EXPECT_GT(nees / count, 0.3) << shakes;
  }
}

// A turn about an axis of which only every n-th sample comes, while another that does not turn has all.
TEST(Holes, ATurnAboutAnAxisInARhythmIsSeen) {
  for (const int n : {2, 3, 4, 7}) {
    for (const double slope_s : {0.0, 0.05, 0.3, 2.0}) {
      TwoAxes sensor(5);
      double angle = 0.0;
      for (int i = 0; i < 30'000; ++i) {
        const double into_s = (i - 5000) * kPeriod, left_s = (9000 - i) * kPeriod;
        const double share = into_s < 0 || left_s <= 0 ? 0.0
                             : slope_s > 0             ? std::min({1.0, into_s / slope_s, left_s / slope_s})
                                                       : 1.0;
        const ifog::EstimatorOutput& out =
            sensor.step(0.0, 1.5 * share, i % n == 0 ? Sample::good : Sample::invalid);
        angle += (out.denoised_radps[1] - 1.5 * share) * kPeriod;
        if (i > 8500 && i < 8600) {
          ASSERT_NEAR(out.denoised_radps[1], 1.5 * share, 0.01) << n << ", " << slope_s << ", " << i;
        }
      }
      // 6 rad were turned; of a ramp of which one sample in seven comes nobody knows better.
      EXPECT_LT(std::abs(angle), n > 4 ? 0.1 : 0.01) << n << ", " << slope_s << ": " << angle;
    }
  }
}

}  // namespace
