// SPDX-License-Identifier: Apache-2.0
// Of frames that are late where whole rounds of their counter may have been lost: what has been seen since
// that began. What was lost does not drain; frames that come at the pace at which they were taken show it
// soonest.
#pragma once

#include <algorithm>
#include <cmath>

#include "drivers/ifog/arrivals.h"

namespace ifog {

class RoundDoubt {
 public:
  struct Seen {
    double late_s = 0.0;
    double quiet_s = 0.0;  // since any frame came; negative: not known
    double took_s = 0.0;   // by the count
    bool rounds = false;   // some may have been lost just here
    bool counts = false;   // by the count, too, frames are missing, or nobody saw how it began
    bool gap = false;      // one is told
  };

  void forget() noexcept { *this = {}; }
  // paced_s: so long frames have to come at their pace.
  void follow(const Seen& seen, double paced_s) noexcept {
    rounds_ = rounds_ || seen.rounds;
    counts_ = counts_ || seen.counts;
    gap_ = gap_ || seen.gap;
    since_s_ += std::max(0.0, seen.quiet_s);
    if (seen.quiet_s > seen.took_s + kPrompt_s) quiet_s_ += seen.quiet_s - seen.took_s;
    const bool drains = std::abs(seen.late_s - late_s_) > kDrains * paced_s;
    if (drains) late_s_ = seen.late_s;
    frames_ = drains ? 0 : frames_ + 1;
    paced_s_ = drains ? 0.0 : paced_s_ + std::max(0.0, seen.quiet_s);
  }
  // With one more, so late and so much after the last.
  [[nodiscard]] bool at_pace(double late_s, double elapsed_s, double paced_s) const noexcept {
    return frames_ >= kPaceFrames && std::abs(late_s - late_s_) <= kDrains * paced_s &&
           paced_s_ + elapsed_s >= paced_s;
  }

  [[nodiscard]] bool rounds() const noexcept { return rounds_; }
  [[nodiscard]] bool counts() const noexcept { return counts_; }
  [[nodiscard]] bool gap() const noexcept { return gap_; }
  // Silent in all, beside what was counted.
  [[nodiscard]] double quiet_s() const noexcept { return quiet_s_; }
  [[nodiscard]] double since_s() const noexcept { return since_s_; }

 private:
  static constexpr double kDrains = 0.02;  // of the time: what was held up drains by more
  static constexpr int kPaceFrames = 8;

  bool rounds_ = false, counts_ = false, gap_ = false;
  double quiet_s_ = 0.0, since_s_ = 0.0;
  double late_s_ = 0.0, paced_s_ = 0.0;  // since it last became less or more; so long
  int frames_ = 0;                       // likewise
};

}  // namespace ifog
