// SPDX-License-Identifier: Apache-2.0
// How quickly an axis walks at rest, by all of a recording: for one whose filter was told nothing of it.
//
// Second differences of block means over octaves, as start_up.h and rest_noise.h have them, of every stretch
// at rest. Those want the quickest walk that fits, as a filter online must never be too slow; a smoother is
// to be as far off as it says, and takes the mean of all walks by how well they fit.
#pragma once

#include <array>
#include <vector>

namespace ifog {

class RecordWalk {
 public:
  // The next measurement at rest; break_off() where what lies between is not rest.
  void take(double rate);
  void break_off() { octaves_.clear(); }
  // Variance the level walks by in a nominal sample, (rad/s)^2; 0: too little rest to say.
  [[nodiscard]] double variance() const;

 private:
  struct Octave {
    std::array<double, 2> means{};  // of the last two blocks
    double half = 0.0;              // mean of the first half of the block under way
    int blocks = 0;                 // whole ones since the stretch began, up to two
    bool has_half = false;
  };
  std::vector<Octave> octaves_;
  std::vector<double> squares_, counts_;
  double samples_ = 0.0;
};

}  // namespace ifog
