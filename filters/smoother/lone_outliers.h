// SPDX-License-Identifier: Apache-2.0
// Outliers of a recording in motion: a measurement by itself that a cubic through those on both sides of it
// is far from, while it goes through them.
//
// A jump, a corner, a blow of two samples and a vibration are none: of these no cubic goes through what is
// about them. Others near by that are alone, too, may be left out for it to do so.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

// rate: rad/s, NaN where missing; steps: time to each from the one before it, nominal samples; noise: R.
// Appends the places of outliers in [begin, end), in order.
void find_lone_outliers(std::span<const double> rate, std::span<const double> steps, double noise,
                        std::size_t begin, std::size_t end, std::vector<std::size_t>& places);

}  // namespace ifog
