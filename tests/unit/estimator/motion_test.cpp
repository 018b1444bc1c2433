// SPDX-License-Identifier: Apache-2.0
// At rest as good as a Kalman filter told the truth; after a change of rate quick; not led astray by an
// outlier.
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog::test;

// Told the right noise it is one of the regimes of tests/bench/quality. Noise that is louder than was given is believed
// once it has been white for 8192 samples; a quick walk is then not told from motion.
TEST(Rest, IsWithinFivePercentOfTheFilterToldTheTruthWhereItIsToldAWrongNoise) {
  for (const auto& [ratio, noise] : {std::pair{1e-3, 100.0}, {1e-6, 100.0}, {1e-6, 0.01}}) {
    double ours = 0.0, best = 0.0;
    for (std::uint64_t seed = 1; seed <= fewer(10U, 2U); ++seed) {
      const Record r = record(seed, 60'000, ratio);
      const Filtered got = run(told(ratio, noise), r.measured);
      ours += mean_square_error(got.denoised, r.truth, 30'000);
      best += mean_square_error(told_the_truth(r.measured, ratio), r.truth, 30'000);
      if (noise > 1.0) {
        EXPECT_EQ(got.health.manoeuvres, 0U) << ratio;
      }
    }
    EXPECT_LT(std::sqrt(ours / best), 1.05) << "Q/R " << ratio << ", told R times " << noise;
  }
}

int median_samples_to_90_percent(double step) {
  std::vector<int> samples;
  for (std::uint64_t seed = 1; seed <= 41; ++seed) {
    constexpr int kAt = 3000;
    const Record r = record(seed, kAt + 500, 1e-3, [step](int i) { return i >= kAt ? step : 0.0; });
    const Filtered got = run(told(1e-3), r.measured);
    std::size_t k = kAt;
    while (k < r.truth.size() && got.denoised[k] - r.truth[kAt - 1] < 0.9 * step) ++k;
    samples.push_back(static_cast<int>(k) - kAt + 1);
  }
  std::sort(samples.begin(), samples.end());
  return samples[samples.size() / 2];
}

TEST(Step, IsFollowed) {
  EXPECT_LE(median_samples_to_90_percent(20.0), 10);
  EXPECT_LE(median_samples_to_90_percent(5.0), 25);
}

TEST(Outlier, IsPassedOver) {
  for (const double size : {8.0, 50.0, 1e6}) {
    Record r = record(4, 6000, 1e-3);
    const Filtered without = run(told(1e-3), r.measured);
    r.measured[4000] += size;
    const Filtered with = run(told(1e-3), r.measured);
    EXPECT_TRUE(with.flags[4000] & ifog::kGated) << size;
    EXPECT_EQ(with.health.manoeuvres, 0U) << size;
    for (std::size_t i = 4000; i < 6000; ++i) {
      // A fifth of the noise: what leaving a measurement out, and another draw of R, may do.
      ASSERT_NEAR(with.denoised[i], without.denoised[i], 0.2) << size << ", sample " << i;
    }
  }
}

// A motion that grows out of the noise is noise to the rule at first. After it the rule must learn again.
TEST(AfterAManoeuvre, TheRuleUnlearnsWhatItTookForNoise) {
  const auto swings = [](int i) {
    return i < 2000 || i > 8000 ? 0.0 : 0.5 * std::exp((i - 2000) / 900.0) * std::sin(0.1 * i);
  };
  for (const char* rule : {"irwe-akfg", "iae", "rae", "sage-husa", "vb"}) {
    for (const double ratio : {1e-3, 1.0}) {
      ifog::FilterSettings settings = told(ratio);
      settings.rule = rule;
      const Record r = record(1, 14'000, ratio, swings);
      const Filtered got = run(settings, r.measured);
      EXPECT_GT(got.health.manoeuvres, 0U) << rule << ", Q/R " << ratio;
      EXPECT_LT(got.health.measurement_noise[0], 3.0) << rule << ", Q/R " << ratio;
      EXPECT_NEAR(got.health.nis_mean[0], 1.0, 0.4) << rule << ", Q/R " << ratio;
    }
  }
}

// A filter that begins in the middle of a turn, told a noise half as loud again as it is. What it lags behind
// by, before it knows its noise, is motion, not colour: of forty records none is still more than three sigma
// off after 400 samples, and the angle is all there after 4000. Where neighbours have half of their noise in common, which
// no tracker foresees, that it moves is found later, and then all it has fallen short of is owed to the motion.
TEST(Motion, ThatIsUnderWayAtTheFirstSampleIsNoColourAndKeepsTheAngle) {
  for (const bool coloured : {false, true}) {
    const int turns = coloured ? 3000 : 1500;
    double worst_off = 0.0, worst_angle = 0.0;  // the latter in what noise turns by behind the filter's lag
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const auto turn = [=](int i) {
        return i < turns ? 0.13 * i : 0.13 * turns * std::exp((turns - i) / 200.0);
      };
      Record r = record(seed, 6000, 0.0, turn);
      for (std::size_t i = r.measured.size(); coloured && i-- > 1;)
        r.measured[i] = r.truth[i] + 0.8 * (r.measured[i] - r.truth[i] + r.measured[i - 1] - r.truth[i - 1]);
      const Filtered f = run(told(2e-4, 1.5), r.measured);
      double off = 0.0, angle = 0.0;
      for (std::size_t i = 0; i < r.measured.size(); ++i) {
        if (i >= 400 && i < 1500) off += (f.denoised[i] - r.truth[i]) / 1100.0;
        angle += f.denoised[i] - r.measured[i];
      }
      // The lag of the filter at rest: of white noise some 70 samples.
      const double lag = coloured ? std::sqrt(f.health.measurement_noise[0] / 2e-4) : 70.0;
      worst_off = std::max(worst_off, std::abs(off));
      worst_angle = std::max(worst_angle, std::abs(angle) / std::sqrt(lag));
    }
    if (!coloured) {
      EXPECT_LT(worst_off, 1.0);
    }
    // Noise alone turns by lag / sqrt(lag) sigma samples, of coloured noise by 1.6 times as much, and by half as much again
    // with what is not settled: of forty the worst is at three of these.
    EXPECT_LT(worst_angle, coloured ? 6.0 * 1.6 : 4.5) << coloured;
  }
}

// A car's gentle turns, of some standard deviations, in noise whose neighbours an output filter correlates (ADIS16405: 0.17;
// an average of two: 0.5): what is hidden in noise for a second is not learned as colour, which would hide the next turn.
TEST(Motion, GentleTurnsInColouredNoiseAreFollowed) {
  constexpr int kFrom = 20'000, kEach = 2500, kLong = 1200, kLength = kFrom + 12 * kEach;
  constexpr double kSlow = 0.01;  // of two first-order lags, per sample
  for (const double before : {0.0, 0.175, 1.0}) {
    double first = 0.0, second = 0.0;
    Record r = record(5, kLength, 0.0, [&](int i) {
      const int turn = (i - kFrom) / kEach;
      const bool turns = i >= kFrom && (i - kFrom) % kEach < kLong;
      first += kSlow * ((turns ? (turn % 2 == 0 ? 1.0 : -1.0) * (3.0 + 0.4 * turn) : 0.0) - first);
      second += kSlow * (first - second);
      return second;
    });
    double last = 0.0;
    for (std::size_t i = 0; i < r.measured.size(); ++i) {
      const double noise = r.measured[i] - r.truth[i];
      r.measured[i] = r.truth[i] + (noise + before * std::exchange(last, noise)) / std::hypot(1.0, before);
    }
    const Filtered got = run(told(1e-6), r.measured);
    EXPECT_LT(mean_square_error(got.denoised, r.truth, kFrom),
              0.2 * mean_square_error(r.measured, r.truth, kFrom))
        << before;
  }
}

// A sea too slow and too small to be followed comes back, and what the filter at rest lags behind by comes
// back with it: to pay it on top puts the rate off by 3 %.
TEST(Motion, ThatComesBackIsNoDebt) {
  double ours = 0.0, best = 0.0;
  for (std::uint64_t seed = 1; seed <= fewer(8U, 4U); ++seed) {
    const Record r = record(seed, 40'000, 1e-3, [](int i) { return 3.0 * std::sin(6.2831853 * i / 2000.0); });
    ours += mean_square_error(run(told(1e-3), r.measured).denoised, r.truth, 10'000);
    best += mean_square_error(told_the_truth(r.measured, 1e-3), r.truth, 10'000);
  }
  EXPECT_LT(std::sqrt(ours / best), 1.025);
}

}  // namespace
