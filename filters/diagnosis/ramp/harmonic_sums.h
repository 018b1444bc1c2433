// SPDX-License-Identifier: Apache-2.0
// What harmonics of an angle's error explain of a rate, for k cycles a radian close to one given: the rate is
// summed against each harmonic over short pieces once, and another k costs the pieces only.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "filters/diagnosis/ramp/unbroken_part.h"

namespace ifog {

class HarmonicSums {
 public:
  // angle: in place of the part's. A harmonic h of the angle's error is cos and sin of 2 pi h k angle, of the
  // rate the differences of these over the step.
  HarmonicSums(const UnbrokenPart& part, const std::vector<double>& angle_rad, double cycles_per_rad,
               std::size_t harmonics);

  [[nodiscard]] std::size_t harmonics() const { return norm_.size(); }
  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] double square() const { return square_; }  // of the error, (rad/s)^2
  // Energy that cosine and sine of that harmonic, from 1, take out of the error; 0 of a
  // stroboscopic one.
  [[nodiscard]] double explained(std::size_t harmonic, double cycles_per_rad) const;
  // Length of the mean of its carrier, at the k given: 1 where the angle only ever takes values that are
  // whole cycles apart, as a sensor's does that counts pulses; near 0 where it turns through all of them.
  [[nodiscard]] double standing(std::size_t harmonic) const;

 private:
  double cycles_per_rad_;
  std::size_t samples_ = 0;
  double square_ = 0.0;
  std::vector<std::complex<double>> sums_;     // harmonic after harmonic
  std::vector<double> middle_rad_;             // of each piece
  std::vector<std::complex<double>> carrier_;  // mean
  std::vector<double> norm_;                   // energy of a harmonic of one radian
};

}  // namespace ifog
