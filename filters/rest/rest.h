// SPDX-License-Identifier: Apache-2.0
// Which part of a record a sensor was at rest in. Noise figures, a heading forecast or a filter's tuning
// of a sensor that was being turned or shaken say nothing about the sensor.
//
// Two kinds of window of about half a second do not count as rest:
//   - turned: the mean departs from the running median of the seconds around it, or steps, by 20 times what
//     neighbouring quiet windows do, and by more than 0.001 rad/s (0.06 °/s, fourteen times the Earth's
//     rate); and what lies between two such steps at a rate of its own;
//   - shaken: the scatter within is more than four times that of the record's quieter part.
// Single outliers do neither.
// A drift, flicker or a random walk of any size are not motion, nor is a step of the bias but for the step
// itself.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

struct Rest {
  std::vector<Stretch> at_rest;  // in order; all of the record when nothing moved
  std::size_t samples = 0;       // of the record
  std::size_t turned = 0;        // samples not used
  std::size_t shaken = 0;
  // Rest, but the rate leaps there by more than noise does and less than is surely a turn; of the largest.
  struct SlowTurns {
    std::size_t count = 0, first = 0;  // first: sample
    double largest_radps = 0.0;
  } slow_turns;

  [[nodiscard]] std::size_t resting() const { return samples - turned - shaken; }
};

// axes: rates of one sensor, rad/s, equally long, NaN where missing; it rests when all of them do. Records of
// fewer than 16 windows, or slower than a sample in two seconds, are assumed to be at rest.
[[nodiscard]] Rest find_rest(std::span<const std::span<const double>> axes, double period_s);
// references: what else measured rates of the same axes, as long as these; may be none. Samples more than a
// second apart with one may be the dwells of a rate table, each at a rate of its own: there the references
// alone say where the sensor was turned, where one departs by more than 0.001 rad/s from its own median.
[[nodiscard]] Rest find_rest(std::span<const SeriesView> axes, std::span<const SeriesView> references,
                             double period_s);

// "moving in 37 of 60 s (turned 30 s, shaken 7 s), at rest 5 … 12 s, 40 … 56 s"; empty when nothing moved.
// first_s: time of the first sample.
[[nodiscard]] std::string in_words(const Rest& rest, double period_s, double first_s);

// "the rate leaps by up to 118 °/h, 4 times, first at 35 s: …"; empty where it does not.
[[nodiscard]] std::string slow_turns_in_words(const Rest& rest, double period_s, double first_s);

// Throws std::invalid_argument with one line for people when the sensor was turned and less than half of the
// record is at rest. One that was only shaken has its quieter part.
void require_rest(const Rest& rest, double period_s, double first_s);

// What two lists of stretches, each in order, have in common.
[[nodiscard]] std::vector<Stretch> common(std::span<const Stretch> a, std::span<const Stretch> b);

}  // namespace ifog
