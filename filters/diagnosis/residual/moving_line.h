// SPDX-License-Identifier: Apache-2.0
// A line whose frequency moves with the rate: of the closed loop's own making, like the harmonics of a
// feedback ramp that was not logged. Its phase follows the angle turned, so that a carrier driven by the
// integrated rate gathers more of it than any fixed frequency.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "filters/diagnosis/residual/lines.h"

namespace ifog {

struct MovingLine {
  double frequency_hz = 0.0;    // of the fundamental, at the mean rate
  double cycles_per_rad = 0.0;  // of the angle turned
  double gain = 0.0;            // power gathered beyond the best fixed frequency, over the noise's
};

// Whether find_moving_line() follows any of these peaks of so many samples.
bool any_to_follow(std::size_t samples, double period_s, const std::vector<SpectralLine>& peaks);

// error: what is left; rate: as measured, both at even steps of period_s, NaN missing. peaks: of the error's
// spectrum.
std::optional<MovingLine> find_moving_line(std::span<const double> error, std::span<const double> rate,
                                           double period_s, const std::vector<SpectralLine>& peaks);

}  // namespace ifog
