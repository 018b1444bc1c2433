// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "filters/effects/compensator.h"
#include "tests/unit/diagnosis/findings.h"
#include "tests/unit/diagnosis/made_capture.h"

namespace ifog {
namespace {

constexpr double kPeriod = 32768.0;
constexpr double kStep_s = 0.005;
constexpr double kPerCount = 79.2e-9;  // rad/s of one count a sample

double gaussian(std::uint32_t counter) { return gaussian_deviate(counter, 9, 3, 1); }

double nonlinearity(double ramp) {
  const double x = ramp / kPeriod;
  return 3e-9 * std::sin(2.0 * M_PI * x) + 1e-9 * std::sin(6.0 * M_PI * x) + 2e-9 * x;
}

struct Loop {
  std::vector<double> time, rate, ramp;
};

// A loop at rest under the Earth's rate, whose ramp has the nonlinearity above.
Loop loop(std::uint32_t n, double rate, double noise) {
  Loop made;
  double position = 1000.0;
  double before = nonlinearity(position);
  for (std::uint32_t i = 0; i < n; ++i) {
    position = std::fmod(position + rate / kPerCount, kPeriod);
    const double ramp = std::floor(position);
    const double now = nonlinearity(ramp);
    made.time.push_back(kStep_s * i);
    made.ramp.push_back(ramp);
    made.rate.push_back(rate + noise * gaussian(i) + (now - before) / kStep_s);
    before = now;
  }
  return made;
}

Record record_of(const Loop& made) {
  return made_record("loop", made.time, made.rate, {{"ramp_counts", made.ramp}});
}

// Rotation put into the rate and, as the loop would, into the ramp's slope comes out with its gain and phase,
// from a stalled ramp to many wraps a sample.
TEST(Ramp, TheCorrectionIsTransparentToRotation) {
  const auto fit = fit_ramp({record_of(loop(40000, 5.4e-5, 4e-7))}, "ramp_counts", 0.01);
  ASSERT_TRUE(fit.has_value());
  Model model;
  model.effects = {fit->found.effect};
  const auto compensated = [&](const std::vector<double>* rotation) {
    Compensator compensator(model, {""});
    std::vector<double> left;
    double position = 500.0;
    for (std::size_t i = 0; i < 8000; ++i) {
      const double w = rotation != nullptr ? (*rotation)[i] : 0.0;
      position += w / kPerCount;
      position -= kPeriod * std::floor(position / kPeriod);
      CompensatorInput in;
      in.dt_s = kStep_s;
      in.rate_radps[0] = w;
      const std::vector<double> channel = {std::floor(position)};
      in.channels = channel;
      CompensatorOutput out;
      compensator.step(in, out);
      left.push_back(out.compensated_radps[0]);
    }
    return left;
  };
  expect_transparent(compensated, kStep_s, {0.0, 5.4e-5, 2.6e-3, 9.7e-3});
}

}  // namespace
}  // namespace ifog
