// SPDX-License-Identifier: Apache-2.0
// The pauses between the portions in which a line delivers: an adapter, a server or a modem collects frames
// and hands them on together. A pause of that length is the line's, whatever was lost around it.
#pragma once

#include <algorithm>

namespace ifog {

class Portions {
 public:
  // Of a frame that goes on with the one before, behind such a time by arrival, s.
  void came(double elapsed_s, double period_s) noexcept {
    pause_s_ *= kForgets;
    if (elapsed_s > kPauses * period_s && elapsed_s > pause_s_)
      pause_s_ = std::min(elapsed_s, std::max(kGrows * pause_s_, kPauses * period_s));
  }
  // No longer than the line's own, as they are; of a line that delivers each frame by itself there is none.
  [[nodiscard]] bool is_usual(double time_s) const noexcept { return time_s <= kBeside * pause_s_; }

 private:
  static constexpr double kPauses = 4.0;          // periods: shorter ones are scatter
  static constexpr double kGrows = 8.0;           // a single long pause is no usual one
  static constexpr double kForgets = 1.0 - 5e-4;  // a frame
  static constexpr double kBeside = 1.5;

  double pause_s_ = 0.0;
};

}  // namespace ifog
