// SPDX-License-Identifier: Apache-2.0
// Whether slow noise of a rate is what a channel of the file does: a temperature's effect passes for a rate
// random walk.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "filters/allan/noise/noise_coefficients.h"
#include "filters/allan/stretches.h"
#include "filters/rest/channel_outline.h"
#include "filters/series/series_view.h"

namespace ifog {

struct FollowedChannel {
  std::string name;
  double share = 0.0;  // of the variance of the rate's slow means that is linear in the channel
};

// rate: rad/s of the rows from `first_row` of the outlines' on; parts: its stretches at rest. The channel that
// most of the slow means of the rate follow, if any. Then B, K and R are estimated again without it, and the
// error bar of each holds the difference.
std::optional<FollowedChannel> followed_channel(const SeriesView& rate, std::span<const Stretch> parts,
                                                std::size_t first_row, double period_s,
                                                std::span<const ChannelOutline> channels,
                                                NoiseCoefficients& found);

}  // namespace ifog
