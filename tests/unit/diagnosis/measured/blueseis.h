// SPDX-License-Identifier: Apache-2.0
// An IFOG at rest (blueseis_bs1_ramp), diagnosed on the first half of its record, with its feedback ramp or as if
// nobody had logged that, and what is asked of either correction.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <vector>

#include "filters/diagnosis/diagnose.h"
#include "filters/units/field_units.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/diagnosis/findings.h"

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

// Read and diagnosed once for all tests of a program.
template <bool with_ramp>
const Measured* measured_half() {
  static const std::unique_ptr<Measured> once = diagnosed_first_half(with_ramp);
  return once.get();
}

template <bool with_ramp>
class MeasuredHalf : public testing::Test {
 protected:
  void SetUp() override {
    if (measured_half<with_ramp>() == nullptr)
      GTEST_SKIP() << "no " << kBlueseis
                   << ": the measured captures belong beside the project, in ../shared/data";
  }
};

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
