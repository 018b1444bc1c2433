// SPDX-License-Identifier: Apache-2.0
// Finds the channel of the file that explains most of a rate's slow noise. An effect of temperature looks
// like a rate random walk.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "filters/allan/noise/noise_coefficients.h"
#include "filters/allan/stretches.h"
#include "filters/rest/channel_outline.h"

namespace ifog {

struct FollowedChannel {
  std::string name;
  // of the variance of the rate's slow means, explained by a straight line over the channel
  double share = 0.0;
};

// Channel that the slow means of the rate follow most, or nullopt. Then B, K and R are estimated again
// without its effect, and their error bars are widened by the difference. rate: rad/s, starts at row
// `first_row` of the outlines; parts: its stretches at rest.
std::optional<FollowedChannel> followed_channel(std::span<const double> rate, std::span<const Stretch> parts,
                                                std::size_t first_row, double period_s,
                                                std::span<const ChannelOutline> channels,
                                                NoiseCoefficients& found);

}  // namespace ifog
