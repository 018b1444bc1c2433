// Noise of a sensor from its first seconds, for a filter that was told neither Q nor R. A few seconds show
// the white noise well and the random walk badly; `ifog tune` on an hour at rest is the better way.
#pragma once

#include <span>

namespace ifog {

struct StartupNoise {
  double process_noise = 0.0;      // spectral density of the rate's random walk, (rad/s)^2/s
  double measurement_noise = 0.0;  // variance at one sample, (rad/s)^2
};

// Allan variances at m = 1, 2, 4, … samples, fitted by R/m + Q T (2m^2 + 1)/(6m) (white noise and a random
// walk sampled at T; IEEE Std 952 annex C in discrete time), weighted by their own spread, neither negative.
// rates: rad/s, the axes one after the other, `axes` × n values, NaN allowed (taken as the sample before). n
// ≥ 16. Axes are averaged: they share one gain. Allocates.
StartupNoise startup_noise(std::span<const double> rates, int axes, double period_s);

}  // namespace ifog
