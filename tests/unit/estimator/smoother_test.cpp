// SPDX-License-Identifier: Apache-2.0
// The smoother against the measurements and the causal filter in motions of many kinds.
#include "filters/smoother/smoother.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog::test;
using ifog::Axes;
using ifog::FilterSettings;

// One axis smoothed, by itself. dt_s: empty: kPeriod each.
ifog::Smoothed smooth_one(const FilterSettings& settings, const std::vector<double>& rate,
                          std::vector<double> dt_s = {}, const ifog::AxisNoise& noise = {}) {
  if (dt_s.empty()) dt_s.assign(rate.size(), kPeriod);
  const std::array<std::span<const double>, 1> rates{rate};
  return std::move(ifog::smooth(settings, noise, rates, dt_s, kPeriod)[0]);
}

// Mean square of the error over the samples in [from, to), and of the error over its variance.
struct Judged {
  double square = 0.0, normalised = 0.0, count = 0.0;
  void add(const ifog::Smoothed& got, const std::vector<double>& truth, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      const double apart = got.rate_radps[i] - truth[i];
      square += apart * apart;
      normalised += apart * apart / got.variance_rad2ps2[i];
      count += 1.0;
    }
  }
  [[nodiscard]] double mean_square() const { return square / count; }
  [[nodiscard]] double nees() const { return normalised / count; }
};

// Filtered states are worked out again piece by piece: what is smoothed there is what a part of the record
// about it says, as nothing is remembered for as long.
TEST(Smoother, IsTheSameWhereItsPiecesMeet) {
  constexpr std::size_t kLength = 12'000, kAbout = 1000;
  const Record r = record(35, kLength, 0.01, [](int i) { return 50.0 * std::sin(0.002 * i); });
  const std::vector<double> walk(kLength, 0.01), steps(kLength, 1.0);
  for (const float memory : {ifog::pace::kRest, 20.0F}) {
    const std::vector<float> memories(kLength, memory);
    const ifog::Smoothed whole = ifog::smooth_course({r.measured, walk, steps, memories}, 1.0);
    for (const std::size_t at : {std::size_t{4096}, std::size_t{8192}}) {
      const auto part = [&](const auto& of) { return std::span(of).subspan(at - kAbout, 2 * kAbout); };
      const ifog::Smoothed got =
          ifog::smooth_course({part(r.measured), part(walk), part(steps), part(memories)}, 1.0);
      for (std::size_t i = at - 5; i < at + 5; ++i) {
        EXPECT_NEAR(got.rate_radps[i + kAbout - at], whole.rate_radps[i], 1e-9) << i;
        EXPECT_NEAR(got.variance_rad2ps2[i + kAbout - at], whole.variance_rad2ps2[i], 1e-9) << i;
      }
    }
  }
}

struct Motion {
  const char* name;
  std::function<double(int)> rate;  // in units of the noise, by sample
};

double trapezoid(double i, double slope, double height) { return std::clamp(slope * i, 0.0, height); }

// At 200 Hz and 0.01 deg/sqrt(h), whose noise is 8.5 deg/h: 60 deg/s in 0.2 s, 30 deg/s^2, 0.2 deg/s^2, a sea
// of 3 deg/s at 0.1 Hz; and tumbling at 5 kHz.
std::vector<Motion> motions() {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const auto turn = [](double slope, double height) {
    return [=](int i) { return trapezoid(i - 20'000, slope, height) - trapezoid(i - 24'000, slope, height); };
  };
  const auto swing = [](double amplitude, double frequency) {
    return [=](int i) {
      return i < 20'000 || i > 40'000 ? 0.0 : amplitude * std::sin(kTurn * frequency * (i - 20'000));
    };
  };
  return {{"step of 60 deg/s", turn(640.0, 25'600.0)},
          {"turn of 30 deg/s^2", turn(64.0, 12'800.0)},
          {"ramp of 0.2 deg/s^2", turn(0.43, 860.0)},
          {"sea", swing(1280.0, 0.0005)},
          {"tumbling", swing(34'000.0, 0.0001)}};
}

// No worse than the measurement or the causal filter, who has not seen what comes, and as far off as it says.
TEST(Smoother, IsTheBestOfAllInEveryMotion) {
  constexpr int kLength = 60'000;
  for (const double ratio : {1e-6, 1e-9}) {
    if (kSanitized && ratio != 1e-6) continue;
    for (const Motion& motion : motions()) {
      double smoothed = 0.0, filtered = 0.0, raw = 0.0, normalised = 0.0, moving = 0.0;
      for (std::uint64_t seed = 41; seed < 44; ++seed) {
        const Record r = record(seed, kLength, ratio, motion.rate);
        const ifog::Smoothed got = smooth_one(told(ratio), r.measured);
        const std::vector<double> causal = run(told(ratio), r.measured).denoised;
        double owed = 0.0;
        for (std::size_t i = 0; i < kLength; ++i) {
          owed += r.measured[i] - got.rate_radps[i];
          if (motion.rate(static_cast<int>(i)) == 0.0) continue;
          const double square = std::pow(got.rate_radps[i] - r.truth[i], 2);
          smoothed += square;
          filtered += std::pow(causal[i] - r.truth[i], 2);
          raw += std::pow(r.measured[i] - r.truth[i], 2);
          normalised += square / got.variance_rad2ps2[i];
          moving += 1.0;
        }
        EXPECT_NEAR(owed, 0.0, 1e-4) << motion.name << ratio;
      }
      EXPECT_LT(smoothed, 0.5 * std::min(filtered, raw)) << motion.name << ratio;
      EXPECT_GT(normalised / moving, 0.5) << motion.name << ratio;
      EXPECT_LT(normalised / moving, 1.5) << motion.name << ratio;
    }
  }
}

// One of three turns: nothing of it is in the others, and each has the variance of its own noise.
TEST(Smoother, EachAxisIsItsOwn) {
  constexpr int kLength = 40'000;
  constexpr double kRatio = 1e-5;
  const std::array<double, 3> loud{1.0, 10.0, 100.0};
  Axes normalised{}, over{};
  constexpr int kSeeds = fewer(6, 2);
  for (std::uint64_t seed = 51; seed < 51 + kSeeds; ++seed) {
    std::vector<Record> records;
    std::vector<std::vector<double>> rates;
    for (std::size_t a = 0; a < 3; ++a) {
      records.push_back(record(3 * seed + a, kLength, kRatio, [&](int i) {
        return a == 0 ? trapezoid(i - 20'000, 64.0, 1e4) - trapezoid(i - 24'000, 64.0, 1e4) : 0.0;
      }));
      for (double& rate : records[a].measured) rate *= loud[a];
      rates.push_back(records[a].measured);
    }
    const double mean = (1.0 + 100.0 + 10'000.0) / 3.0;
    FilterSettings settings = told(kRatio);
    settings.process_noise *= mean;
    settings.measurement_noise *= mean;
    const Axes share{1.0 / mean, 100.0 / mean, 10'000.0 / mean};
    const std::vector<double> dt(kLength, kPeriod);
    const std::vector<std::span<const double>> all(rates.begin(), rates.end());
    const std::vector<ifog::Smoothed> got = ifog::smooth(settings, {share, share, false}, all, dt, kPeriod);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < kLength; ++i) {
        if (a == 0 && i > 15'000 && i < 30'000) continue;
        const double square = std::pow(got[a].rate_radps[i] - loud[a] * records[a].truth[i], 2);
        normalised[a] += square / got[a].variance_rad2ps2[i];
        over[a] += 1.0;
      }
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_GT(normalised[a] / over[a], 0.7) << a;
    EXPECT_LT(normalised[a] / over[a], 1.4) << a;
  }
}

// A MEMS gyro with an output filter: all its noise is the model's colour, as tune finds, and R is at the bound of the fit
// (ADIS16405 at 100 Hz). At rest and in a vehicle.
TEST(Smoother, AModelsColourIsNoise) {
  constexpr std::size_t kLength = 40'000;
  constexpr double kPhi = 0.3, kShock = 1.0 - kPhi * kPhi, kWalkStep = 1e-7;
  FilterSettings settings = told(kWalkStep, 1e-9);
  settings.state = "random-walk + ar(1)";
  settings.state_parameters = {kPhi, kShock / kWalkStep};
  for (const double sways : {0.0, 300.0}) {
    Noise normal(81);
    std::vector<double> truth, measured;
    double colour = normal(), level = 0.0;
    for (std::size_t i = 0; i < kLength; ++i) {
      level += std::sqrt(kWalkStep) * normal();
      truth.push_back(level + sways * std::sin(0.01 * static_cast<double>(i)));
      measured.push_back(truth.back() + colour);
      colour = kPhi * colour + std::sqrt(kShock) * normal();
    }
    Judged judged;
    judged.add(smooth_one(settings, measured), truth, 0, kLength);
    EXPECT_LT(judged.mean_square(), sways == 0.0 ? 0.01 : 0.25) << sways;
    EXPECT_GT(judged.nees(), 0.3) << sways;
    EXPECT_LT(judged.nees(), 2.5) << sways;
  }
}

// Recordings smoothed of which samples are missing, or of whose noise nobody was told.

// Tumbling, one sample in twenty lost: a row that is absent is as good as one that is empty.
TEST(SmoothedRecord, AbsentRowsAreAsGoodAsEmptyOnes) {
  constexpr std::size_t kLength = 20'000;
  constexpr double kRatio = 1e-8;
  const Record r = record(71, kLength, kRatio, [](int i) {
    return 80'000.0 * std::sin(0.022 * i) * std::sin(0.0016 * i) + 34'000.0 * std::sin(0.041 * i);
  });
  std::mt19937 random(72);
  std::vector<double> empty = r.measured, absent, dt_s, truth;
  double since = 0.0;
  for (std::size_t i = 0; i < kLength; ++i) {
    since += kPeriod;
    if (i > 0 && random() % 20 == 0) {
      empty[i] = std::nan("");
      continue;
    }
    absent.push_back(r.measured[i]);
    truth.push_back(r.truth[i]);
    dt_s.push_back(std::exchange(since, 0.0));
  }
  const ifog::Smoothed of_empty = smooth_one(told(kRatio), empty);
  const ifog::Smoothed of_absent = smooth_one(told(kRatio), absent, dt_s);
  Judged judged;
  judged.add(of_absent, truth, 0, truth.size());
  EXPECT_LT(std::sqrt(judged.mean_square()), 0.6);
  EXPECT_GT(judged.nees(), 0.6);
  EXPECT_LT(judged.nees(), 1.3);
  double apart = 0.0, of_row = 0.0, of_cell = 0.0;
  for (std::size_t i = 0, k = 0; i < kLength; ++i) {
    if (!std::isfinite(empty[i])) continue;
    apart += std::pow(of_absent.rate_radps[k] - of_empty.rate_radps[i], 2);
    of_row += of_absent.variance_rad2ps2[k];
    of_cell += of_empty.variance_rad2ps2[i];
    ++k;
  }
  EXPECT_LT(apart, 0.05 * of_cell);
  EXPECT_NEAR(of_row / of_cell, 1.0, 0.02);
}

// Every other sample of the quiet axis of two comes, in a slow sway; settings are of the mean of both.
TEST(SmoothedRecord, AnAxisWithHalfOfItsSamplesHasItsOwnNoise) {
  constexpr std::size_t kLength = 60'000;
  constexpr double kRatio = 1e-10, kLoud = 30.0;
  Judged judged;
  for (std::uint64_t seed = 73; seed < 76; ++seed) {
    Record quiet = record(seed, kLength, kRatio, [](int i) { return 3.0 * std::sin(3e-4 * i); });
    Record loud = record(100 + seed, kLength, kRatio);
    for (std::size_t i = 0; i < kLength; ++i) {
      loud.measured[i] *= kLoud;
      if (i % 2 == 1) quiet.measured[i] = std::nan("");
    }
    const double mean = 0.5 * (1.0 + kLoud * kLoud);
    FilterSettings settings = told(kRatio, mean);
    settings.process_noise *= mean;
    const std::array<std::span<const double>, 2> rates{quiet.measured, loud.measured};
    const std::vector<double> dt_s(kLength, kPeriod);
    const Axes share{1.0 / mean, kLoud * kLoud / mean, 1.0};
    judged.add(ifog::smooth(settings, {share, share, false}, rates, dt_s, kPeriod)[0], quiet.truth, 0,
               kLength);
  }
  EXPECT_LT(std::sqrt(judged.mean_square()), 0.1);
  EXPECT_GT(judged.nees(), 0.3);
  EXPECT_LT(judged.nees(), 1.5);
}

// There are too few samples to detect it.
TEST(SmoothedRecord, AnAxisThatIsNotHeardHasTheNoiseDeclared) {
  constexpr std::size_t kLength = 5000;
  const Record seen = record(77, kLength, 1e-12);
  std::vector<double> hardly(kLength, std::nan(""));
  for (std::size_t i = 100; i < kLength; i += 1000) hardly[i] = 100.0 * seen.measured[i];
  const std::array<std::span<const double>, 2> rates{seen.measured, hardly};
  const std::vector<double> dt_s(kLength, kPeriod);
  FilterSettings settings = told(1e-12, 5000.5);
  const ifog::AxisNoise noise{Axes{2.0 / 10'001.0, 20'000.0 / 10'001.0, 1.0}, Axes{1.0, 1.0, 1.0}, false};
  const std::vector<ifog::Smoothed> got = ifog::smooth(settings, noise, rates, dt_s, kPeriod);
  // The mean of five measurements.
  EXPECT_NEAR(got[1].variance_rad2ps2[2500], 2000.0, 200.0);
}

// Outliers in a recording: none of them is in what is smoothed.

// One sample in two hundred, each to the same side; never two together.
bool struck(std::size_t i) { return i % 200 == 77; }

TEST(SmoothedOutliers, AreNotInItAtRest) {
  constexpr std::size_t kLength = 60'000;
  constexpr double kRatio = 1e-8;
  for (const double height : {30.0, 50.0, 300.0}) {
    double struck_square = 0.0, clean_square = 0.0, causal_square = 0.0;
    for (std::uint64_t seed = 61; seed < 64; ++seed) {
      Record r = record(seed, kLength, kRatio);
      clean_square += mean_square_error(smooth_one(told(kRatio), r.measured).rate_radps, r.truth, 0);
      for (std::size_t i = 0; i < kLength; ++i)
        if (struck(i)) r.measured[i] += height;
      struck_square += mean_square_error(smooth_one(told(kRatio), r.measured).rate_radps, r.truth, 0);
      causal_square += mean_square_error(run(told(kRatio), r.measured).denoised, r.truth, 0);
    }
    EXPECT_LT(struck_square, 1.3 * clean_square) << height;
    EXPECT_LT(struck_square, causal_square) << height;
  }
}

// In motion the shortest parabola that averages predicts to 2 sigma, and both directions have to reject an outlier.
// None of those of 20 sigma stay in, some of those of 15 do.
TEST(SmoothedOutliers, AreNotInItInMotion) {
  constexpr std::size_t kLength = 40'000;
  constexpr double kRatio = 1e-8;
  for (const double height : {20.0, 30.0, 50.0, 300.0}) {
    Record r = record(65, kLength, kRatio, [](int i) { return 1280.0 * std::sin(0.003 * i); });
    for (std::size_t i = 0; i < kLength; ++i)
      if (struck(i)) r.measured[i] += height;
    const ifog::Smoothed got = smooth_one(told(kRatio), r.measured);
    double square = 0.0, normalised = 0.0;
    int count = 0;
    for (std::size_t i = 1000; i < kLength; ++i) {
      if (!struck(i)) continue;
      const double apart = got.rate_radps[i] - r.truth[i];
      square += apart * apart;
      normalised += apart * apart / got.variance_rad2ps2[i];
      ++count;
    }
    EXPECT_LT(std::sqrt(square / count), 0.5) << height;
    EXPECT_LT(normalised / count, 2.0) << height;
    EXPECT_LT(mean_square_error(got.rate_radps, r.truth, 1000), 0.1) << height;
  }
}

}  // namespace
