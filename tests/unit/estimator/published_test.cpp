// SPDX-License-Identifier: Apache-2.0
// What is published of a model with a colour or a line: the level alone. The rest of the model is the noise
// it was tuned on.
#include <Eigen/Dense>

#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog::test;

// The settled Kalman filter of x(k+1) = A x(k) + w, z = x0 + x1 + … + noise of variance one, written by its
// textbook form: the error that its first state, the level, keeps.
double level_error(const Eigen::MatrixXd& transition, const Eigen::MatrixXd& driving,
                   const Eigen::VectorXd& h) {
  const auto n = transition.rows();
  Eigen::MatrixXd p = 100.0 * Eigen::MatrixXd::Identity(n, n);
  for (int i = 0; i < 200'000; ++i) {
    p = transition * p * transition.transpose() + driving;
    const Eigen::VectorXd gain = p * h / (h.dot(p * h) + 1.0);
    p = (Eigen::MatrixXd::Identity(n, n) - gain * h.transpose()) * p;
    p = 0.5 * (p + p.transpose()).eval();
  }
  return std::sqrt(p(0, 0));
}

double root_mean_square(const std::vector<double>& estimate, const std::vector<double>& truth,
                        std::size_t from) {
  return std::sqrt(mean_square_error(estimate, truth, from));
}

constexpr double kWalkStep = 1e-6;
constexpr int kLength = 60'000;
constexpr std::size_t kSettled = 10'000;

// AR(1) of 0.9 as loud as the white noise. The level is known to some 0.1 sigma, the colour to 0.5: with the
// colour in the output the error would be the colour's.
TEST(Published, LeavesTheColourInside) {
  constexpr double kPhi = 0.9, kShock = 0.19;  // unit variance
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Record made = record(12, kLength, kWalkStep);
  double colour = normal(random);
  for (double& z : made.measured) {
    z += colour;
    colour = kPhi * colour + std::sqrt(kShock) * normal(random);
  }
  ifog::FilterSettings settings = told(kWalkStep);
  settings.state = "random-walk + ar(1)";
  settings.state_parameters = {kPhi, kShock / kWalkStep};
  const double ideal =
      level_error(Eigen::Vector2d(1.0, kPhi).asDiagonal(), Eigen::Vector2d(kWalkStep, kShock).asDiagonal(),
                  Eigen::Vector2d(1.0, 1.0));
  for (const char* rule : {"ckf", "irwe-akfg", "mmae"}) {
    settings.rule = rule;
    EXPECT_LT(root_mean_square(run(settings, made.measured).denoised, made.truth, kSettled), 1.6 * ideal)
        << rule;
  }
  settings.rule = "ckf";
  settings.follow_manoeuvres = settings.conserve_angle = false;
  const Filtered plain = run(settings, made.measured);
  EXPECT_NEAR(root_mean_square(plain.denoised, made.truth, kSettled) / ideal, 1.0, 0.25);
}

// A line of ten sigma: the output moves by less than a thousandth of it.
TEST(Published, LeavesALineInside) {
  constexpr double kFrequency = 4.17;
  Record made = record(5, kLength, kWalkStep);
  for (int i = 0; i < kLength; ++i)
    made.measured[static_cast<std::size_t>(i)] +=
        10.0 * std::sin(2.0 * std::numbers::pi * kFrequency * kPeriod * i + 0.3);
  ifog::FilterSettings settings = told(kWalkStep);
  settings.rule = "ckf";
  settings.state = "random-walk + harmonic";
  settings.state_parameters = {kFrequency, 1e-3};
  const std::vector<double> denoised = run(settings, made.measured).denoised;
  double in_phase = 0.0, quadrature = 0.0;
  for (std::size_t i = kSettled; i < denoised.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * kFrequency * kPeriod * static_cast<double>(i);
    in_phase += denoised[i] * std::cos(angle);
    quadrature += denoised[i] * std::sin(angle);
  }
  const double amplitude = 2.0 * std::hypot(in_phase, quadrature) / static_cast<double>(kLength - kSettled);
  EXPECT_LT(amplitude, 0.01);
}

// The error that the filter announces is the level's, too; the doubt whether a change has begun adds a percent.
TEST(Published, VarianceIsTheLevels) {
  constexpr double kPhi = 0.5, kShock = 0.75;
  ifog::FilterSettings settings = told(kWalkStep);
  settings.rule = "ckf";
  settings.state = "random-walk + ar(1)";
  settings.state_parameters = {kPhi, kShock / kWalkStep};
  Fed filter(settings);
  Noise normal(3);
  double colour = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    filter.step({normal() + colour});
    colour = kPhi * colour + std::sqrt(kShock) * normal();
  }
  const double ideal =
      level_error(Eigen::Vector2d(1.0, kPhi).asDiagonal(), Eigen::Vector2d(kWalkStep, kShock).asDiagonal(),
                  Eigen::Vector2d(1.0, 1.0));
  EXPECT_NEAR(std::sqrt(filter.out.variance_rad2ps2[0]) / ideal, 1.0, 2e-2);
}

// A sensor with an output filter, as in a flight controller's log: all its noise at rest is the model's colour, and R is
// at the bound of the fit, or a walk. The motion and its angle are published, also if a recording begins with it.
TEST(Published, FollowsMotionThoughAllNoiseIsColour) {
  struct Case {
    const char* what;
    double phi, noise, walk, amplitude, cycles;  // cycles a sample
  };
  constexpr int kEnds = 12'000;
  for (const int moves : {6000, 0})
    for (const Case& c :
         {Case{"turned", 0.28, 1e-7, 1e-6, 300.0, 0.005}, Case{"shaken", 0.28, 1e-7, 1e-6, 100.0, 0.21},
          Case{"slow colour", 0.9, 1e-7, 1e-6, 300.0, 0.005},
          Case{"some white noise", 0.28, 0.1, 1e-6, 300.0, 0.005},
          Case{"a walk", 0.0, 1e-7, 1.0, 300.0, 0.005}}) {
      SCOPED_TRACE(c.what);
      std::mt19937_64 random(5);
      std::normal_distribution<double> normal;
      ifog::FilterSettings settings = told(c.walk, c.noise);
      const double shock = c.phi > 0.0 ? std::sqrt(1.0 - c.phi * c.phi) : 0.0;
      if (c.phi > 0.0) {
        settings.state = "random-walk + ar(1)";
        settings.state_parameters = {c.phi, shock * shock / c.walk};
      }
      double colour = 0.0, walk = 0.0, square = 0.0, apart = 0.0;
      Fed filter(settings, 3);
      for (int i = 0; i < kEnds; ++i) {
        const double moved = i < moves ? 0.0 : c.amplitude * std::sin(2.0 * std::numbers::pi * c.cycles * i);
        colour = c.phi * colour + shock * normal(random);
        walk += std::sqrt(c.walk) * normal(random);
        const double rate = moved + walk + colour + std::sqrt(c.noise) * normal(random);
        filter.step({rate, -0.5 * rate, 0.0});
        const double off = filter.out.denoised_radps[0] - rate;
        if (i >= moves) square += off * off / (kEnds - moves);
        apart += off * kPeriod;
      }
      EXPECT_LT(std::sqrt(square), 1.5);
      EXPECT_LT(std::abs(apart), 1.0);
    }
}

// A dithered ring laser, as ln100_x_up, whose rate starts to grow by 1/3000 of its dither each sample. The model of the dither
// would absorb the turn, and the published rate was late by half of the dither for thousands of samples. Half of the time it
// is now within 0.06; where the motion is detected again, the measured rate is published for a while.
TEST(Published, FollowsASlowTurnInADither) {
  constexpr double kRadius = 0.97, kTurn = 2.4, kWhite = 1e-3, kSlope = 3.4e-4;
  constexpr int kMoves = 10'000, kEnds = 20'000;
  const double phi1 = 2.0 * kRadius * std::cos(kTurn), phi2 = -kRadius * kRadius;
  // Yule and Walker: the variance that a shock of one gives.
  const double variance = (1.0 - phi2) / ((1.0 + phi2) * (std::pow(1.0 - phi2, 2) - phi1 * phi1));
  ifog::FilterSettings settings = told(1e-9, kWhite);
  settings.state = "random-walk + ar(2)";
  settings.state_parameters = {phi1, phi2, 1.0 / variance / 1e-9};
  for (const unsigned seed : {1U, 2U, 3U}) {
    Noise normal(seed);
    Fed filter(settings);
    double dither = 0.0, before = 0.0;
    std::vector<double> off;
    for (int i = 0; i < kEnds; ++i) {
      const double next = phi1 * dither + phi2 * before + normal() / std::sqrt(variance);
      before = std::exchange(dither, next);
      const double turn = kSlope * std::max(0, i - kMoves);
      filter.step({turn + dither + std::sqrt(kWhite) * normal()});
      if (i >= kMoves) off.push_back(std::abs(filter.out.denoised_radps[0] - turn));
    }
    std::ranges::nth_element(off, off.begin() + off.size() / 2);
    EXPECT_LT(off[off.size() / 2], 0.06) << seed;
  }
}

}  // namespace
