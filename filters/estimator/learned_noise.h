// SPDX-License-Identifier: Apache-2.0
// Noise of a sensor as learned by a running filter, and used as start values by another one.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "filters/settings/axes.h"

namespace ifog {

struct LearnedNoise {
  double process_noise = 0.0;      // of a random walk, (rad/s)^2/s
  double measurement_noise = 0.0;  // per sample, mean of the axes, (rad/s)^2
  Axes noise{};                    // of each axis
  double samples = 0.0;            // number of samples at rest for the walk
  // Identity of the model that corrected the rate; empty: none. Noise learned with another model is not
  // valid.
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
