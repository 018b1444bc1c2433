// SPDX-License-Identifier: Apache-2.0
// What the times of arrival say of the line that labels are made by. Nothing comes before it was taken: a
// line that is ahead of them is wrong, at once. What comes late is held up on its way, until it has not
// become less for Lateness::kStands_s: then the device stood still, and the line goes on from there.
#pragma once

#include <algorithm>
#include <cstdint>

#include "drivers/ifog/arrivals.h"
#include "drivers/ifog/lateness.h"

namespace ifog {

class LabelLateness {
 public:
  enum class Says : std::uint8_t { follow, wait, ahead, stood };

  void forget() noexcept { late_.forget(); }
  // late_s: of the next sample against the line; spread_s: what they scatter by about it; elapsed_s: since
  // the sample before, by arrival.
  Says next(double late_s, double spread_s, double elapsed_s) noexcept {
    const double usual_s = kScatters * spread_s;
    if (late_s < -(kPrompt_s + usual_s)) {
      late_.forget();
      return Says::ahead;
    }
    const bool held = late_.now_s() > 0.0;
    if (held ? late_.over(late_s, elapsed_s) : late_s <= std::max(kLate_s, usual_s)) {
      late_.forget();
      return Says::follow;
    }
    const bool again = elapsed_s > kAgain_s;
    const bool stood = late_.stands(late_s, elapsed_s, again);
    late_.follow(stood ? 0.0 : late_s, elapsed_s, again);
    return stood ? Says::stood : Says::wait;
  }

 private:
  static constexpr double kLate_s = 2.0 * kPrompt_s;  // less is scheduling's
  static constexpr double kScatters = 4.0;            // times the mean is not by chance
  static constexpr double kAgain_s = 0.25;            // a silence of more is another one

  Lateness late_;
};

}  // namespace ifog
