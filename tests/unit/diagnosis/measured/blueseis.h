// SPDX-License-Identifier: Apache-2.0
// An IFOG at rest (blueseis_bs1_ramp), diagnosed on the first half of its record, with its feedback ramp or as if
// nobody had logged that, and what is asked of either correction.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <memory>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/diagnosis/diagnose.h"
#include "filters/units/field_units.h"

namespace ifog {

constexpr const char* kBlueseis = IFOG_SHARED_DATA "/blueseis_bs1_ramp.csv.gz";
constexpr double kRampPeriod = 32768.0;  // counts
constexpr double kStep_s = 0.005;

struct Measured {
  Capture capture;
  Diagnosis diagnosis;
  Model model;
};

// Empty where there is no capture.
inline std::unique_ptr<Measured> diagnosed_first_half(bool with_ramp) {
  if (!std::filesystem::exists(kBlueseis)) return nullptr;
  auto made = std::make_unique<Measured>();
  made->capture = read_capture(kBlueseis);
  Record record;
  record.name = kBlueseis;
  record.time_s = made->capture.time_s;
  record.rate_radps = made->capture.rate_radps[0];
  for (const CaptureColumn& column : made->capture.channels)
    if (with_ramp) record.channels.push_back({column.name, column.values});
  DiagnoseOptions options;
  options.fit_to = 0.5;
  made->diagnosis = diagnose({record}, options);
  add_to_model(made->diagnosis, "", made->model);
  return made;
}

// Rotation that is added keeps its size within 2 % and its phase within 2 degrees, from a tenth of a hertz to 0.8
// of half the sample rate, about each of these mean rates. compensated: of the second half, with a rotation (rad/s
// by sample) added to it, or with none.
template <class Compensated>
void expect_transparent(Compensated&& compensated, std::initializer_list<double> mean_rates) {
  const std::vector<double> still = compensated(nullptr);
  double worst_gain = 0.0, worst_phase = 0.0;
  for (const double mean : mean_rates) {
    for (const double frequency : {0.1, 1.0, 5.0, 20.0, 50.0, 80.0}) {
      const double amplitude = 2e-5;
      std::vector<double> rotation(still.size());
      for (std::size_t i = 0; i < rotation.size(); ++i)
        rotation[i] = mean + amplitude * std::sin(2.0 * M_PI * frequency * kStep_s * static_cast<double>(i));
      const std::vector<double> turning = compensated(&rotation);
      std::complex<double> in = 0.0, out = 0.0;
      for (std::size_t i = 0; i < rotation.size(); ++i) {
        const std::complex<double> carrier =
            std::polar(1.0, -2.0 * M_PI * frequency * kStep_s * static_cast<double>(i));
        in += (rotation[i] - mean) * carrier;
        out += (turning[i] - still[i] - mean) * carrier;
      }
      EXPECT_NEAR(std::abs(out / in), 1.0, 0.02) << mean << " rad/s, " << frequency << " Hz";
      EXPECT_NEAR(std::arg(out / in), 0.0, 2.0 * kDegree) << mean << " rad/s, " << frequency << " Hz";
      worst_gain = std::max(worst_gain, std::abs(std::abs(out / in) - 1.0));
      worst_phase = std::max(worst_phase, std::abs(std::arg(out / in)));
    }
  }
  std::printf("gain within %.3f %%, phase within %.3f degrees\n", 100.0 * worst_gain, worst_phase / kDegree);
}

// Figures of a record straight from their definitions: a second method next to the project's own.
inline double deviation(const std::vector<double>& x) {
  double mean = 0.0;
  double square = 0.0;
  for (const double v : x) mean += v / static_cast<double>(x.size());
  for (const double v : x) square += (v - mean) * (v - mean);
  return std::sqrt(square / static_cast<double>(x.size()));
}

// Overlapping Allan deviation, straight from its definition.
inline double allan(const std::vector<double>& x, std::size_t m) {
  double square = 0.0;
  double n = 0.0;
  for (std::size_t i = 0; i + 2 * m <= x.size(); ++i) {
    double d = 0.0;
    for (std::size_t k = 0; k < m; ++k) d += (x[i + m + k] - x[i + k]) / static_cast<double>(m);
    square += d * d;
    n += 1.0;
  }
  return std::sqrt(0.5 * square / n);
}

}  // namespace ifog
