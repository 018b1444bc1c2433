// SPDX-License-Identifier: Apache-2.0
// When a channel was read that is polled more slowly than the rows are written. Its rows hold the last
// reading, and taken for the channel they are a staircase that is late by half the poll's period on the mean:
// a regressor that is wrong by that, for an effect which follows the channel itself.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ifog {

struct Reading {
  double step;  // of the fine grid, fractional between two steps
  double value;
};

struct PolledReadings {
  double period = 1.0;  // steps between two readings
  std::vector<Reading> readings;
};

// values: at even steps, without gaps. Nothing where they change at other than multiples of one period of
// three steps at least; a reading that repeats the one before is one, too. Lines, which stand for holes, are
// not looked into.
std::optional<PolledReadings> polled_readings(std::span<const double> values);

// The channel at step `at`, on a straight line between the readings beside it: what is to be expected there
// of a random walk. Held before the first and behind the last.
double on_line(std::span<const Reading> readings, double at);

}  // namespace ifog
