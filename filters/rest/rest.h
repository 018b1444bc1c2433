// SPDX-License-Identifier: Apache-2.0
// Finds the part of a record in which the sensor was at rest. Noise figures and filter tuning are valid only
// there.
//
// Two kinds of windows of about half a second are not rest:
//   - turned: the mean departs from the running median of the seconds around it, or steps, by more than 20
//   times the usual step of quiet windows or five times the noise of any gyro, and more than 0.001 rad/s
//   (0.06 °/s, 14 times the Earth's rate). The time between two such steps is turned too, if the level there
//   differs from that of the longest rest, and every rest whose means scatter more than those of any gyro.
//   - shaken: the scatter within the window is more than four times that of the record's quietest windows, and
//   more than a step of the converter.
// Single outliers, drift, flicker and random walks are not motion. A step of the bias counts only at the step.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

struct Rest {
  std::vector<Stretch> at_rest;  // in order; the whole record if there was no motion
  std::size_t samples = 0;       // of the record
  std::size_t turned = 0;        // samples not used
  std::size_t shaken = 0;
  // At rest, but the rate steps by more than its noise and less than a certain turn. Of the largest one.
  struct SlowTurns {
    std::size_t count = 0, first = 0;  // first: sample
    double largest_radps = 0.0;
  } slow_turns;
  std::string wrapped;  // nothing is at rest, because signed counts were read as unsigned: the fault's text

  [[nodiscard]] std::size_t resting() const { return samples - turned - shaken; }
};

// Stretches in which all axes are at rest. Records of fewer than 16 windows are judged by the noise of any gyro
// alone; records with more than 2 s per sample are assumed to be at rest. axes: rates of one sensor, rad/s,
// equally long, NaN where missing. references: other measurements of the same rates; may be none. With them,
// samples more than 1 s apart may be dwells of a rate table. Then only the references decide: turned is where
// one departs by more than 0.001 rad/s from its median.
[[nodiscard]] Rest find_rest(std::span<const std::span<const double>> axes,
                             std::span<const std::span<const double>> references, double period_s);

// "moving in 37 of 60 s (turned 30 s, shaken 7 s), at rest 5 … 12 s, 40 … 56 s"; empty without motion.
// first_s: time of the first sample.
[[nodiscard]] std::string in_words(const Rest& rest, double period_s, double first_s);

// "the rate leaps by up to 118 °/h, 4 times, first at 35 s: …"; empty if it does not.
[[nodiscard]] std::string slow_turns_in_words(const Rest& rest, double period_s, double first_s);

// Throws std::invalid_argument with a message unless the sensor was longer at rest than it was turned, and for a tenth
// of the record. Of a record that was only shaken the quieter part can be used.
void require_rest(const Rest& rest, double period_s, double first_s);

// Intersection of two lists of stretches, each in order.
[[nodiscard]] std::vector<Stretch> common(std::span<const Stretch> a, std::span<const Stretch> b);

}  // namespace ifog
