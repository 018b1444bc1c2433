// SPDX-License-Identifier: Apache-2.0
// Detects a closed-loop sensor's feedback ramp among the channels: a counter that wraps and whose slope
// measures the rotation. Its nonlinearity is an angle error f(ramp), so the rate error is the difference of f
// divided by dt. f is bounded, so this correction cannot remove rotation. A function of the ramp's slope
// could.
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

// Period, a power of two, if the values are in [0, period) and jump by about a period; else 0.
double wrap_period(std::span<const double> values);

struct RampFit {
  // Angle lookup whose table ends may differ, as the flyback is not exactly 2 pi. Its likelihood ratio is for
  // white noise.
  FoundEffect found;
  std::vector<Samples> correction;  // by record and sample, rad/s
};

// Fits the ramp of one channel. nullopt if the table gains less than its cost, or if its p-value exceeds
// `significance`.
std::optional<RampFit> fit_ramp(const std::vector<Record>& records, const std::string& channel,
                                double significance);

}  // namespace ifog
