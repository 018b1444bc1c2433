// SPDX-License-Identifier: Apache-2.0
// A feedback ramp with a closed form, rebuilt online: the oracle is the formula that made the rate.
#include "filters/effects/ramp_tracker.h"
#include "filters/effects/compensator.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kStep_s = 0.005;
constexpr double kCycles = 77000.0;  // a radian
constexpr double kEarth = 5.4e-5;    // rad/s
constexpr double kNoise = 4.4e-7;    // rad/s, a sample

// Two waves and a flyback that is not quite 2 pi and takes some hundredths of a cycle, rad over cycles.
double nonlinearity(double cycles) {
  const double x = 2.0 * M_PI * (cycles - std::floor(cycles));
  double flyback = 0.0;
  for (int h = 1; h <= 40; ++h) flyback -= std::exp(-std::pow(h / 16.0, 2.0)) * std::sin(h * x) / (M_PI * h);
  return 4e-9 * std::sin(x + 0.3) + 2e-9 * std::cos(5.0 * x) + 8e-9 * flyback;
}

RampSettings settings() {
  RampSettings made{kCycles, {}, kNoise * std::sqrt(kStep_s), 2.4e-4};
  for (int i = 0; i < 256; ++i) made.angle_rad.push_back(nonlinearity(i / 256.0));
  return made;
}

// A gyro whose true rate is given over time; its ramp begins anywhere. The loop follows what it measures, so
// that most of its noise is in the ramp, too; a tenth is not.
class Gyro {
 public:
  Gyro(std::function<double(double)> rate, double noise, unsigned seed, double cycles = kCycles)
      : rate_(std::move(rate)), noise_(noise), cycles_(cycles), random_(seed) {
    phase_ = std::uniform_real_distribution<double>(0.0, 1.0)(random_);
  }
  struct Sample {
    double measured, truth, ramp;  // rad/s
  };
  Sample next(bool ramp = true) {
    const double truth = rate_(time_ += kStep_s);
    const double before = nonlinearity(phase_);
    const double noise = noise_ * normal_(random_);
    phase_ += cycles_ * (truth + noise) * kStep_s;
    const double error = ramp ? (nonlinearity(phase_) - before) / kStep_s : 0.0;
    return {truth + error + noise + 0.1 * noise_ * normal_(random_), truth, error};
  }

 private:
  std::function<double(double)> rate_;
  double noise_, cycles_, phase_ = 0.0, time_ = 0.0;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

double step(RampTracker& tracker, double rate, double missed_s = 0.0) {
  return tracker.step(
      {.measured_radps = rate, .rest_radps = rate, .dt_s = kStep_s + missed_s, .missed_s = missed_s});
}

double steadily(double) { return kEarth; }

struct Result {
  int until_locked = -1;
  double before = 0.0, after = 0.0;  // mean squares of the ramp and of what is left of it, once locked
};

Result run(RampTracker& tracker, Gyro& gyro, int samples) {
  Result out;
  int locked = 0;
  for (int i = 0; i < samples; ++i) {
    const Gyro::Sample sample = gyro.next();
    const double correction = step(tracker, sample.measured);
    EXPECT_TRUE(tracker.locked() || correction == 0.0);
    if (tracker.locked() && out.until_locked < 0) out.until_locked = i;
    if (!tracker.locked()) continue;
    ++locked;
    out.before += sample.ramp * sample.ramp;
    out.after += (sample.ramp - correction) * (sample.ramp - correction);
  }
  out.before /= std::max(locked, 1);
  out.after /= std::max(locked, 1);
  return out;
}

TEST(RampTracker, AcquiresAnyPhaseWithinSecondsAndTakesTheRampAway) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Gyro gyro(steadily, kNoise, seed);
    RampTracker tracker(settings());
    const Result found = run(tracker, gyro, 12000);
    EXPECT_GE(found.until_locked, 32) << "seed " << seed;
    EXPECT_LT(found.until_locked, 1000) << "seed " << seed;
    EXPECT_LT(found.after, 0.05 * found.before) << "seed " << seed;
    EXPECT_TRUE(tracker.locked());
  }
}

TEST(RampTracker, DoesNothingWhereThereIsNoRamp) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    for (const double amplitude : {0.0, 1e-6, 1e-3}) {
      Gyro gyro([=](double t) { return kEarth + amplitude * std::sin(2.0 * M_PI * 0.7 * t); }, kNoise, seed);
      RampTracker tracker(settings());
      for (int i = 0; i < 20000; ++i) {
        ASSERT_EQ(step(tracker, gyro.next(false).measured), 0.0) << "seed " << seed << ", sample " << i;
        ASSERT_FALSE(tracker.locked());
      }
    }
  }
}

// Through a gap the angle is not known: nothing is corrected until the phase is found again.
TEST(RampTracker, AGapLosesThePhaseAndItIsFoundAnew) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Gyro gyro([](double t) { return t > 30.0 && t < 40.0 ? 3.0 * kEarth : kEarth; }, kNoise, seed);
    RampTracker tracker(settings());
    run(tracker, gyro, 5900);
    ASSERT_TRUE(tracker.locked());
    for (int i = 0; i < 2400; ++i) gyro.next();  // 29.5 to 41.5 s, the turn in it
    const double correction = step(tracker, gyro.next().measured, 2400 * kStep_s);
    EXPECT_EQ(correction, 0.0);
    EXPECT_FALSE(tracker.locked());
    const Result again = run(tracker, gyro, 6000);
    EXPECT_LT(again.until_locked, 1000) << "seed " << seed;
    EXPECT_LT(again.after, 0.05 * again.before) << "seed " << seed;
  }
}

TEST(RampTracker, OneLostSampleIsBridged) {
  Gyro gyro(steadily, kNoise, 3);
  RampTracker tracker(settings());
  run(tracker, gyro, 6000);
  for (int k = 0; k < 20; ++k) {
    gyro.next();
    step(tracker, gyro.next().measured, kStep_s);
    ASSERT_TRUE(tracker.locked());
    const Result left = run(tracker, gyro, 200);
    EXPECT_LT(left.after, 0.1 * left.before);
  }
}

// k as the model has it is 3e-5 off, as after a change of temperature, and the gyro has a bias of 0.01 °/h.
TEST(RampTracker, FollowsASlowlyWrongK) {
  Gyro gyro([](double) { return kEarth; }, kNoise, 7, kCycles * (1.0 + 3e-5));
  RampTracker tracker(settings());
  run(tracker, gyro, 40000);
  const Result later = run(tracker, gyro, 40000);
  EXPECT_EQ(later.until_locked, 0);
  EXPECT_LT(later.after, 0.05 * later.before);
}

// Turned by a radian the phase is lost, for k is not known that well; afterwards it is found again.
TEST(RampTracker, ALongTurnLosesThePhase) {
  Gyro gyro([](double t) { return t > 20.0 && t < 30.0 ? 0.1 : kEarth; }, kNoise, 11, kCycles * (1.0 + 5e-6));
  RampTracker tracker(settings());
  run(tracker, gyro, 3900);
  ASSERT_TRUE(tracker.locked());
  bool lost = false;
  for (int i = 3900; i < 6200; ++i) {
    step(tracker, gyro.next().measured);
    lost = lost || !tracker.locked();
  }
  EXPECT_TRUE(lost);
  run(tracker, gyro, 4000);
  const Result after = run(tracker, gyro, 4000);
  EXPECT_EQ(after.until_locked, 0);
  EXPECT_LT(after.after, 0.05 * after.before);
}

// Rotation that is put into the rate comes out with its gain and its phase, from standing still to many
// resets a sample; the sum of all that is taken away stays an angle of the table's size.
TEST(RampTracker, IsTransparentToRotation) {
  for (const double bias : {0.0, -2.0 * kEarth, 20.0 * kEarth, 8e-3}) {
    for (const double frequency : {0.1, 1.0, 5.0, 20.0, 80.0}) {
      const double amplitude = 2e-5;
      const auto turning = [=](double t) {
        return kEarth + (t > 10.0 ? bias + amplitude * std::sin(2.0 * M_PI * frequency * t) : 0.0);
      };
      Gyro gyro(turning, kNoise, 13);
      RampTracker tracker(settings());
      run(tracker, gyro, 2000);
      ASSERT_TRUE(tracker.locked());
      std::complex<double> in;
      std::complex<double> out;
      double taken = 0.0;
      for (int i = 0; i < 20000; ++i) {
        const Gyro::Sample sample = gyro.next();
        const double correction = step(tracker, sample.measured);
        const std::complex<double> carrier =
            std::polar(1.0, -2.0 * M_PI * frequency * (10.0 + kStep_s * (i + 1)));
        in += (sample.truth - kEarth - bias) * carrier;
        out += (sample.truth - kEarth - bias - correction) * carrier;
        taken += correction * kStep_s;
        ASSERT_LT(std::abs(taken), 1e-7);
      }
      EXPECT_NEAR(std::abs(out / in), 1.0, 0.02) << bias << " rad/s, " << frequency << " Hz";
      EXPECT_NEAR(std::arg(out / in), 0.0, 2.0 * M_PI / 180.0) << bias << " rad/s, " << frequency << " Hz";
    }
  }
}

Effect effect() {
  Effect made;
  made.form = "rebuilt_ramp";
  made.angle = true;
  made.period = 1.0;
  const RampSettings from = settings();
  for (std::size_t i = 0; i <= 256; ++i) {
    made.table_x.push_back(static_cast<double>(i) / 256.0);
    made.table_y.push_back(from.angle_rad[i % 256]);
  }
  made.parameters = {{"cycles_per_rad", from.cycles_per_rad, 0.01, "1/rad"},
                     {"noise_density", from.noise_density, 0.0, "rad/s/sqrt(Hz)"},
                     {"phase_walk", from.phase_walk, 0.0, "cycles/sqrt(s)"}};
  return made;
}

CompensatorOutput step(Compensator& compensator, double rate) {
  CompensatorInput in;
  in.dt_s = kStep_s;
  in.rate_radps = {rate, 0.0, 0.0};
  CompensatorOutput out;
  compensator.step(in, out);
  return out;
}

// From the model file as it is written and read again; after a reload of the same ramp it stays locked.
TEST(RampTracker, RunsInTheCompensatorFromAModelFile) {
  Model model;
  model.effects = {effect()};
  const Model read = parse_model(model_text(model), "written");
  Compensator compensator(read, {""});
  EXPECT_TRUE(compensator.channels().empty());
  EXPECT_TRUE(compensator.left_out().empty());
  Gyro gyro(steadily, kNoise, 17);
  EXPECT_EQ(step(compensator, gyro.next().measured).flags, kRampUnknown);
  for (int i = 0; i < 2000; ++i) step(compensator, gyro.next().measured);
  Compensator reloaded(read, {""});
  reloaded.take_over(compensator);
  double before = 0.0;
  double after = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const Gyro::Sample sample = gyro.next();
    const CompensatorOutput out = step(reloaded, sample.measured);
    ASSERT_EQ(out.flags, 0U);
    EXPECT_DOUBLE_EQ(out.compensated_radps[0], sample.measured - out.correction_radps[0]);
    before += sample.ramp * sample.ramp;
    after += (sample.ramp - out.correction_radps[0]) * (sample.ramp - out.correction_radps[0]);
  }
  EXPECT_LT(after, 0.05 * before);
}

TEST(RampTracker, RefusesWhatIsNoRamp) {
  for (const char* name : {"cycles_per_rad", "noise_density"}) {
    Effect bad = effect();
    for (ModelParameter& each : bad.parameters)
      if (each.name == name) each.value = 0.0;
    EXPECT_THROW(RampTracker(ramp_settings(bad)), std::invalid_argument) << name;
  }
  Effect uneven = effect();
  uneven.table_x[3] += 0.001;
  EXPECT_THROW(ramp_settings(uneven), std::invalid_argument);
  Effect none = effect();
  none.table_x.clear();
  none.table_y.clear();
  EXPECT_THROW(ramp_settings(none), std::invalid_argument);
}

}  // namespace
}  // namespace ifog
