// SPDX-License-Identifier: Apache-2.0
// How loud an axis is at rest and how quickly it walks there, by the likelihood of a whole recording.
//
// Online a walk is taken for the quickest that fits (walk.h), as a filter must never be too slow. A
// smoother is to be as far off as it says: its walk is the mean of all, each weighted by its likelihood, and
// where the recording is too short to show one that is one it would just hide. Means of blocks are judged, as
// long as the walk allows, so that the colour of the noise is none; an innovation counts for three sigma at
// most and the ends of a stretch for nothing, as motion that is about to be found is none either.
#pragma once

#include <cstddef>
#include <vector>

#include "filters/series/samples.h"

namespace ifog {

struct RestOfRecord {
  double noise = 0.0;  // R of the white noise that long blocks have, (rad/s)^2; 0: too little rest to say
  double walk = 0.0;   // variance the level walks by in a sample
};

class RestLikelihood {
 public:
  // The next measurement at rest.
  void take(double rate);
  // The stretch is over: motion comes.
  void break_off() { end(true); }
  // So is the record.
  void finish() { end(false); }
  // walk: known already; 0: to be found.
  [[nodiscard]] RestOfRecord fit(double walk) const;

 private:
  // Blocks: of either end of a stretch a part is left out, of the record's own nothing.
  static constexpr std::size_t kTrim = 8;
  void end(bool motion_comes);

  Samples blocks_;
  std::vector<std::size_t> ends_;  // of stretches, in blocks
  double sum_ = 0.0;
  int in_block_ = 0;
  bool moved_ = false;  // before this stretch
};

}  // namespace ifog
