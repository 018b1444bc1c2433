// SPDX-License-Identifier: Apache-2.0
// What a running filter has learned of its sensor's noise, and what another one may begin with.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

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
  // Identity of the model whose corrections were in; empty: none. What another one corrects
  // is no part of this noise.
  std::array<char, 16> model{};

  void set_model(std::string_view identity) noexcept {
    model.fill('\0');
    std::copy_n(identity.begin(), std::min(identity.size(), model.size() - 1), model.begin());
  }
  [[nodiscard]] bool is_of(std::string_view identity) const noexcept {
    LearnedNoise other;
    other.set_model(identity);
    return model == other.model;
  }
};

}  // namespace ifog
