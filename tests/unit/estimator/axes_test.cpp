// SPDX-License-Identifier: Apache-2.0
// Axes that are not alike and share one gain: what is said of each is its own, whichever it is.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "tests/unit/estimator/drive.h"

namespace ifog {
namespace {

using test::kPeriod;

constexpr std::size_t kAxes = 3;
constexpr Axes kLoud{1.0, 3.0, 10.0};  // standard deviations
constexpr int kStartUp = 5000, kSettledAt = 20'000, kEnd = 80'000;

struct Said {
  Axes squares{};  // mean of error^2 over the published variance
  Axes errors{};   // mean square
  EstimatorHealth health;
};

// walk: of each axis over the white noise of the first, a sample.
Said filtered(std::uint64_t seed, const Axes& walk) {
  std::array<test::Record, kAxes> axes;
  for (std::size_t a = 0; a < kAxes; ++a) {
    axes[a] = test::record(100 * seed + a, kEnd, walk[a] / (kLoud[a] * kLoud[a]));
    for (double& rate : axes[a].measured) rate *= kLoud[a];
    for (double& rate : axes[a].truth) rate *= kLoud[a];
  }
  Axes noise{}, share{}, walk_share{};
  double mean_noise = 0.0, mean_walk = 0.0;
  for (std::size_t a = 0; a < kAxes; ++a) {
    noise[a] = kLoud[a] * kLoud[a];
    mean_noise += noise[a] / kAxes;
    mean_walk += walk[a] / kAxes;
  }
  for (std::size_t a = 0; a < kAxes; ++a) {
    share[a] = noise[a] / mean_noise;
    walk_share[a] = walk[a] / mean_walk;
  }
  FilterSettings settings;
  settings.process_noise = mean_walk / kPeriod;
  settings.measurement_noise = mean_noise;
  test::Fed filter(settings, kAxes, kPeriod, {.share = share, .walk_share = walk_share});
  filter.in.sequence = kStartUp;
  Said said;
  for (std::size_t i = kStartUp; i < kEnd; ++i) {
    const EstimatorOutput& out = filter.step({axes[0].measured[i], axes[1].measured[i], axes[2].measured[i]});
    for (std::size_t a = 0; i >= kSettledAt && a < kAxes; ++a) {
      const double square = std::pow(out.denoised_radps[a] - axes[a].truth[i], 2) / (kEnd - kSettledAt);
      said.errors[a] += square;
      said.squares[a] += square / out.variance_rad2ps2[a];
    }
  }
  said.health = filter.estimator.health();
  return said;
}

// The filters of the three axes differ in nothing but their scale, or the walks are the same, and the loud
// axis' gain is far too small for the quiet one.
TEST(UnlikeAxes, EachVarianceIsThatOfItsOwnAxis) {
  for (const Axes& walk : {Axes{1e-4, 9e-4, 1e-2}, Axes{1e-4, 1e-4, 1e-4}, Axes{1e-2, 1e-3, 1e-4}}) {
    constexpr int kSeeds = 6;
    Axes squares{};
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const Said said = filtered(seed, walk);
      for (std::size_t a = 0; a < kAxes; ++a) {
        squares[a] += said.squares[a] / kSeeds;
        // What the gain is too small for is in the innovations, and no noise.
        EXPECT_GT(said.health.nis_mean[a], 0.7) << "axis " << a << ", seed " << seed;
        EXPECT_LT(said.health.nis_mean[a], 1.8) << "axis " << a << ", seed " << seed;
        EXPECT_NEAR(said.health.measurement_noise[a] / (kLoud[a] * kLoud[a]), 1.0, 0.3) << "axis " << a;
      }
    }
    for (std::size_t a = 0; a < kAxes; ++a) {
      EXPECT_GT(squares[a], 0.3) << "axis " << a << ", walks " << walk[0] << ' ' << walk[2];
      EXPECT_LT(squares[a], 1.6) << "axis " << a << ", walks " << walk[0] << ' ' << walk[2];
    }
  }
}

// One axis that is five times as loud as the two others is no louder than it was where it comes alone: the
// gain, which is one for all, is the same for it.
TEST(UnlikeAxes, TheLoudOneAloneHasNotBecomeLouder) {
  test::Fed filter(test::told(1e-4, 9.0), kAxes);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double alone = 0.0, together = 0.0;
  for (std::size_t i = 0; i < 40'000; ++i) {
    filter.in.valid_axes = i % 4 == 3 ? 4U : 7U;
    Axes rate{};
    for (std::size_t a = 0; a < kAxes; ++a) rate[a] = (a == 2 ? 5.0 : 1.0) * normal(random);
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

}  // namespace
}  // namespace ifog
