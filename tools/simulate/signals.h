// SPDX-License-Identifier: Apache-2.0
// Time series of the parts of a scenario, one value per sample.
#pragma once

#include <span>
#include <vector>

#include "tools/simulate/draw.h"
#include "tools/simulate/recipe.h"

namespace ifog::simulate {

struct Grid {
  double rate_hz = 0.0;
  std::size_t samples = 0;
  [[nodiscard]] double period() const { return 1.0 / rate_hz; }
  [[nodiscard]] double time(std::size_t i) const { return static_cast<double>(i) / rate_hz; }
  [[nodiscard]] double duration() const { return static_cast<double>(samples) / rate_hz; }
};

// The true channel, and the logged one with its sensor's noise, resolution and update interval.
struct ChannelSignal {
  std::vector<double> physical, logged;
};
// true_rate: of the channel's axis; used by a feedback ramp only.
[[nodiscard]] ChannelSignal channel_signal(const Recipe& recipe, const Grid& grid,
                                           std::span<const double> true_rate, Draw draw);

[[nodiscard]] std::vector<double> motion_signal(const Recipe& recipe, const Grid& grid, Draw draw);

// Contribution of an effect to the rate, from the true channel. Zero for `quantisation`, which acts on the
// sum.
[[nodiscard]] std::vector<double> effect_signal(const Recipe& recipe, const Grid& grid,
                                                std::span<const double> channel,
                                                std::span<const double> with_channel,
                                                std::span<const double> true_rate, Draw draw);

}  // namespace ifog::simulate
