// SPDX-License-Identifier: Apache-2.0
// Delay between two noisy measurements of one motion.
#pragma once

#include <optional>
#include <span>

#include "filters/series/samples.h"

namespace ifog {

// Two measurements of one rate. NaN: missing.
struct SameMotion {
  std::span<const double> series, late;
};

struct CrossDelay {
  double steps = 0.0, error = 0.0;  // in samples; positive: `late` is late
};

// Maximum likelihood for series with independent noise (Hannan and Thomson, Biometrika 60, 1973; Carter, Proc. IEEE
// 75, 1987): the slope of the cross spectrum's phase, each frequency weighted by γ²/(1 − γ²), with the coherence γ.
// Noise of either series lowers the coherence and leaves the phase. The error is that of the theory, enlarged if the
// phases scatter more about the line (a filter in one of the series). All axes have one delay and are of one length;
// each may be reversed. Of the delays of a motion that repeats, the nearest to zero. nullopt if nothing is certainly
// coherent within ±longest samples, or there are fewer than 200.
[[nodiscard]] std::optional<CrossDelay> cross_delay(std::span<const SameMotion> axes, std::size_t longest);

// values at k + steps + growth k: cubic interpolation, linear next to gaps; NaN where nothing can be interpolated. A
// jump disturbs the two samples on either side, not more.
[[nodiscard]] Samples shifted(std::span<const double> values, double steps, double growth = 0.0);

}  // namespace ifog
