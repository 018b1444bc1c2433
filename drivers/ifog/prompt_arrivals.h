// SPDX-License-Identifier: Apache-2.0
// Whether a device's clock is ahead of the times of arrival, which none can be: nothing comes before it was
// taken. So one that is has been set forwards.
#pragma once

#include <algorithm>

namespace ifog {

class PromptArrivals {
 public:
  static constexpr double kDoubt = 0.01;  // clocks are off by less

  void forget() noexcept { *this = {}; }
  // elapsed_s: by arrival, not negative; dt_s: what the sample took.
  void came(double elapsed_s, double dt_s) noexcept {
    behind_s_ = std::max(0.0, behind_s_ + (1.0 - kDoubt) * elapsed_s - dt_s);
    elapsed_sum_s_ = kForgets * elapsed_sum_s_ + elapsed_s;
    dt_sum_s_ = kForgets * dt_sum_s_ + dt_s;
  }
  // The last sample, against the promptest of late: what else may come at once.
  [[nodiscard]] double behind_s() const noexcept { return behind_s_; }
  // They come as fast as they were taken: else times of arrival say nothing of when that was.
  [[nodiscard]] bool at_its_pace() const noexcept {
    return dt_sum_s_ > 0.0 && elapsed_sum_s_ > kPace * dt_sum_s_;
  }
  // A step by its clock puts the next sample before its time by more than slack_s. Of what is read at another
  // pace than it was taken nobody knows.
  [[nodiscard]] bool ahead(double passed_s, double elapsed_s, double slack_s) const noexcept {
    return at_its_pace() && passed_s > elapsed_s + behind_s_ + slack_s;
  }

 private:
  static constexpr double kPace = 0.5, kForgets = 0.998;

  double behind_s_ = 0.0;
  double elapsed_sum_s_ = 0.0, dt_sum_s_ = 0.0;  // of late
};

}  // namespace ifog
