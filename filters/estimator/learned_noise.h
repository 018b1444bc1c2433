// SPDX-License-Identifier: Apache-2.0
// What a running filter has learned of its sensor's noise, and what another one may begin with.
#pragma once

#include <array>
#include <cstddef>

#include "filters/settings/axes.h"

namespace ifog {

// Sums of squares of second differences of means over 2^k samples, and how many independent ones: from them
// the random walk is fitted, and to them later rest is added.
struct OctaveSums {
  static constexpr std::size_t kOctaves = 20;
  std::array<double, kOctaves> squares{}, counts{};  // (rad/s)^2
  double samples = 0.0;                              // at rest, of each axis
};

struct LearnedNoise {
  double process_noise = 0.0;      // of a random walk, (rad/s)^2/s
  double measurement_noise = 0.0;  // per sample, (rad/s)^2: what a filter's gain is to stand on
  Axes colour{1.0, 1.0, 1.0};      // variance of innovations over that of white noise as rough as they are
  OctaveSums octaves;
};

}  // namespace ifog
