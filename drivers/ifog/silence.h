// SPDX-License-Identifier: Apache-2.0
// Of a device with neither counter nor clock: whether what comes late ends a hole in what was measured, or
// was held up on its way. It was held up where more comes at once than usual, and then until what follows
// comes at its pace: from there on it is a hole.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "drivers/ifog/arrivals.h"

namespace ifog {

class Silence {
 public:
  enum class Ends : std::uint8_t { none, hole, hold_up };
  struct Next {
    double elapsed_s = -1.0;  // since the sample before, by arrival; negative: not known
    double late_s = 0.0;      // later than the next sample is due
    std::uint32_t at_once = 0;
  };

  void forget() noexcept { *this = {}; }
  // What the next sample ends; changes nothing.
  [[nodiscard]] Ends look(const Next& next, double period_s) const noexcept {
    if (next.elapsed_s < 0.0 || next.late_s <= std::max(kLate_s, kLatePeriods * period_s)) return Ends::none;
    const bool alone = next.at_once > 0 && next.at_once <= kFew &&
                       next.at_once <= kUsual * usually_at_once_ &&
                       next.at_once * period_s <= kPrompt_s + period_s;
    // Over a while, as an adapter's portions come at their own times.
    const double came_s = came_s_ + next.elapsed_s;
    const bool at_pace = came_s >= std::max(kWhile_s, kPace * (came_ + 1.0) * period_s);
    return (held_ ? at_pace : alone) ? Ends::hole : Ends::hold_up;
  }
  void take(const Next& next, Ends ends) noexcept {
    const bool goes_on = std::exchange(held_, ends == Ends::hold_up) && held_;
    const bool judged = came_s_ + next.elapsed_s >= kWhile_s;  // and the next while begins
    came_s_ = goes_on && !judged ? came_s_ + next.elapsed_s : 0.0;
    came_ = goes_on && !judged ? came_ + 1.0 : 0.0;
    const auto at_once = static_cast<double>(next.at_once);
    usually_at_once_ += (usually_at_once_ > 0.0 ? kFollows : 1.0) * (at_once - usually_at_once_);
  }

 private:
  static constexpr double kLate_s = 0.25, kLatePeriods = 20.0;  // less is scheduling's
  static constexpr double kPace = 0.75;  // of the period, and samples are not held up any more
  static constexpr double kWhile_s = kPrompt_s;
  // What comes at once when nothing was held up: adapters hand on what was in portions of more than so few.
  static constexpr std::uint32_t kFew = 2;
  static constexpr double kUsual = 1.5, kFollows = 0.05;

  bool held_ = false;
  double came_s_ = 0.0, came_ = 0.0;  // in the present while
  double usually_at_once_ = 0.0;      // so many come in one portion
};

}  // namespace ifog
