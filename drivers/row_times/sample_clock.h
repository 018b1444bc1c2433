// SPDX-License-Identifier: Apache-2.0
// Sample time and missing samples from a record's time column, and the times at which its rows were measured, used by
// every command.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

struct SampleClock {
  double period_s = 0.0;        // mean of the steps without gaps
  double worst_jitter_s = 0.0;  // largest difference between such a step and period_s
  std::size_t gaps = 0;         // steps with missing samples
  std::size_t missing = 0;      // samples
  // standard deviation of the stamps in periods, from the steps' median distance from period_s
  double scatter = 0.0;
  // True if the stamps are too irregular to recognise single steps; then the sample's number gives its time
  // better.
  [[nodiscard]] bool scatters() const { return scatter >= 0.1; }
  std::size_t first_gap = 0;  // index of the sample before the first gap; meaningful when gaps > 0
};

// Throws std::invalid_argument unless time_s is strictly increasing and has two samples or more. An even clock
// with late stamps is assumed where their delay returns. Else the median step defines a gap, so up to half of the
// steps may be gaps. Coarsely rounded stamps alternate between k and k + 1 ticks; so a step is a gap only if later
// stamps stay late.
[[nodiscard]] SampleClock sample_clock(std::span<const double> time_s);

struct Hole {
  std::size_t after = 0;  // the last sample before it
  std::size_t lost = 0;
};

// In order of time.
[[nodiscard]] std::vector<Hole> holes(std::span<const double> time_s, const SampleClock& clock);

// The time stamps themselves, or, if they scatter (SampleClock::scatters), an even clock that counts the
// missing samples of each gap.
class RowTimes {
 public:
  // clock: sample_clock(time_s). Needs at least one row.
  RowTimes(std::span<const double> time_s, const SampleClock& clock);

  // Time of the next row, in seconds since the first row.
  double next(double stamp_s);

 private:
  double period_s_, first_s_;
  bool scatters_;
  std::vector<Hole> holes_;
  std::size_t row_ = 0, at_ = 0;
  double even_s_ = 0.0;
};

// Sample rate in Hz, rounded to nine digits; the period from time stamps carries their rounding.
[[nodiscard]] double rounded_rate(double period_s);

}  // namespace ifog
