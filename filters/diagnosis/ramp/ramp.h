// SPDX-License-Identifier: Apache-2.0
// The feedback ramp of a closed-loop sensor, if a channel is one: a counter that wraps and whose slope is the
// closed loop's own measure of the rotation. Its nonlinearity is an error of the angle, f(ramp), so that of
// the rate is the difference of f from sample to sample over dt. f is bounded: this correction cannot swallow
// rotation, whatever the ramp's speed, which no function of the ramp's slope could promise.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"
#include "filters/series/samples.h"

namespace ifog {

// The period, a power of two, when the values lie in [0, period) and jump by about a period; 0 otherwise.
double wrap_period(std::span<const double> values);

struct RampFit {
  // The effect is an angle lookup, whose table's ends may differ: the flyback is not exactly 2 pi. Its
  // likelihood ratio is that in white noise.
  FoundEffect found;
  std::vector<Samples> correction;  // by record and sample, rad/s
};

// Fits the ramp of one channel. Nothing if the table does not gain what its angles cost, or if chance would do as
// well more often than `significance`.
std::optional<RampFit> fit_ramp(const std::vector<Record>& records, const std::string& channel,
                                double significance);

}  // namespace ifog
