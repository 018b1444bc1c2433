// SPDX-License-Identifier: Apache-2.0
// What a running filter has learned of its sensor's noise, and what another one may begin with.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "filters/settings/axes.h"

namespace ifog {

struct LearnedNoise {
  double process_noise = 0.0;      // of a random walk, (rad/s)^2/s
  double measurement_noise = 0.0;  // per sample, mean over the axes, (rad/s)^2
  Axes noise{};                    // the same of each axis
  double samples = 0.0;            // at rest, that the walk stands on
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
