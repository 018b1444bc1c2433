// SPDX-License-Identifier: Apache-2.0
// How late a device's frames come, from the first that is to the one that is not any more: whether that
// drains, as what was held up on its way does, or has come to stand.
#pragma once

#include <algorithm>

#include "drivers/ifog/arrivals.h"

namespace ifog {

class Lateness {
 public:
  static constexpr double kStands_s = 1.5;  // it has come to stand when for so long it has not become less

  // Of the last frame, s; 0: it was not, or that has been told.
  [[nodiscard]] double now_s() const noexcept { return now_s_; }
  // Whether it has come to stand: for some time of arrival it has not become less. What drains from a line
  // that is but little faster than the sensor still becomes less.
  // held_again: behind another silence; how that drains is still to be seen.
  [[nodiscard]] bool stands(double late_s, double elapsed_s, bool held_again) const noexcept {
    return now_s_ > 0.0 && !held_again && late_s >= window_late_s_ - kShrinks_s &&
           window_s_ + elapsed_s >= kStands_s;
  }
  // Nothing is to be told of it any more: it has drained, or will not stand.
  [[nodiscard]] bool over(double late_s, double elapsed_s) const noexcept {
    return late_s < kPrompt_s || episode_s_ + elapsed_s >= kLongest_s;
  }
  void follow(double late_s, double elapsed_s, bool held_again) noexcept {
    const double passed_s = std::max(0.0, elapsed_s);
    if (now_s_ == 0.0 || held_again || late_s < window_late_s_ - kShrinks_s) {
      window_late_s_ = late_s;
      window_s_ = 0.0;
    } else {
      window_s_ += passed_s;
    }
    episode_s_ = now_s_ == 0.0 ? 0.0 : episode_s_ + passed_s;
    now_s_ = late_s;
  }
  void forget() noexcept { now_s_ = 0.0; }
  // Another time to show what becomes of it: of a cable that is pulled again and again no line is left alone
  // for long enough, and what was lost is to be told all the same.
  void begin_again() noexcept { episode_s_ = 0.0; }

 private:
  static constexpr double kShrinks_s = 0.03;  // by more than this it becomes less
  static constexpr double kLongest_s = 60.0;  // and what does not come to stand is left at that

  double now_s_ = 0.0;
  double window_late_s_ = 0.0, window_s_ = 0.0;  // since it last became less
  double episode_s_ = 0.0;                       // since it began
};

}  // namespace ifog
