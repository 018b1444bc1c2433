// SPDX-License-Identifier: Apache-2.0
// The measured ramp: an IFOG at rest whose feedback ramp was recorded with it (blueseis_bs1_ramp). Fitted on
// the first half of the record, judged on the second, by the code the daemon runs. Skipped, with the reason,
// where the capture is not there.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "filters/effects/compensator.h"
#include "filters/units/field_units.h"
#include "tests/unit/diagnosis/measured/blueseis.h"

namespace ifog {
namespace {

constexpr double kPerCount = -79.2e-9;  // rad/s per count per sample: the loop's own measure of rotation
constexpr double kRampHz = 4.17;        // of the Earth's rate

using MeasuredRamp = MeasuredHalf<true>;

const Measured* measured() { return measured_half<true>(); }

const std::vector<double>& ramp() {
  for (const CaptureColumn& column : measured()->capture.channels) {
    if (column.name == "ramp_counts") return column.values;
  }
  throw std::logic_error("the capture has no ramp_counts");
}

// Of the second half, with `rotation` (rad/s by sample) added to the rate and, in proportion, to the ramp.
std::vector<double> compensated(const std::vector<double>* rotation) {
  const Capture& capture = measured()->capture;
  const std::vector<double>& counts = ramp();
  Compensator compensator(measured()->model, {""});
  CompensatorInput in;
  CompensatorOutput out;
  std::vector<double> left;
  double turned = 0.0;
  for (std::size_t i = capture.size() / 2; i < capture.size(); ++i) {
    const double w = rotation ? (*rotation)[left.size()] : 0.0;
    turned += w / kPerCount;
    const double position = std::floor(counts[i] + turned);
    const std::vector<double> channel = {position - kRampPeriod * std::floor(position / kRampPeriod)};
    in.dt_s = capture.time_s[i] - capture.time_s[i - 1];
    in.rate_radps[0] = capture.rate_radps[0][i] + w;
    in.channels = channel;
    compensator.step(in, out);
    left.push_back(out.compensated_radps[0]);
  }
  return left;
}

std::vector<double> raw_second_half() {
  const std::vector<double>& rate = measured()->capture.rate_radps[0];
  return {rate.begin() + static_cast<std::ptrdiff_t>(rate.size() / 2), rate.end()};
}

// Power within 0.3 Hz of a frequency over that of its neighbours, 0.3 to 1 Hz away on either side, both per
// Hz.
std::vector<double> harmonics(std::vector<double> x) {
  const double rate_hz = 200.0;
  double mean = 0.0;
  for (const double v : x) mean += v / static_cast<double>(x.size());
  for (double& v : x) v -= mean;
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, x);
  std::vector<double> ratios;
  for (double f = kRampHz; f <= 50.0; f += kRampHz) {
    double near = 0.0;
    double beside = 0.0;
    double near_n = 0.0;
    double beside_n = 0.0;
    for (std::size_t k = 1; k < x.size() / 2; ++k) {
      const double away = std::abs(static_cast<double>(k) * rate_hz / static_cast<double>(x.size()) - f);
      if (away <= 0.3) {
        near += std::norm(spectrum[k]);
        near_n += 1.0;
      } else if (away <= 1.0) {
        beside += std::norm(spectrum[k]);
        beside_n += 1.0;
      }
    }
    ratios.push_back(near / near_n / (beside / beside_n));
  }
  return ratios;
}

TEST_F(MeasuredRamp, IsFoundWithoutAHintAndAlone) {
  const std::vector<FoundEffect>& effects = measured()->diagnosis.effects;
  ASSERT_FALSE(effects.empty());
  int of_ramp = 0;
  for (const FoundEffect& found : effects) {
    of_ramp += found.effect.channel == "ramp_counts" && found.effect.form == "lookup" && found.effect.angle;
  }
  EXPECT_EQ(of_ramp, 1);
}

TEST_F(MeasuredRamp, LeavesWhatIsPromisedOnTheSecondHalf) {
  const std::vector<double> left = compensated(nullptr);
  EXPECT_LE(deviation(left), 440e-9);
  EXPECT_LE(allan(left, 20), 0.0108 * kDegreePerHour);
  EXPECT_LE(allan(left, 200), 0.0036 * kDegreePerHour);
  // And the record is the one whose raw figures are known.
  EXPECT_NEAR(deviation(raw_second_half()), 635.4e-9, 1e-9);
}

TEST_F(MeasuredRamp, TakesTheHarmonicsOutOfTheSpectrum) {
  const std::vector<double> before = harmonics(raw_second_half());
  const std::vector<double> after = harmonics(compensated(nullptr));
  double strongest = 0.0;
  for (std::size_t k = 0; k < after.size(); ++k) {
    strongest = std::max(strongest, before[k]);
    EXPECT_LE(after[k], 1.5) << "harmonic " << k + 1 << ", before " << before[k];
  }
  EXPECT_GT(strongest, 10.0);
}

// Rotation that is added keeps its size and its phase, whatever the ramp does meanwhile: at the Earth's rate,
// at a stall, turning back, and wrapping several times a sample.
TEST_F(MeasuredRamp, IsTransparentToRotation) {
  const double earth = kRampHz * kRampPeriod / 200.0 * kPerCount;  // rad/s
  expect_transparent(compensated, kStep_s,
                     {0.0, -earth, -2.0 * earth, 20.0 * earth, 3.3 * kRampPeriod * kPerCount});
}

}  // namespace
}  // namespace ifog
