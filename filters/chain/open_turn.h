// SPDX-License-Identifier: Apache-2.0
// What an axis turned over a silence whose length is not decided yet, of a device that sends its angle. By
// the counter alone it may be 18 ms or 10 s, so no rate is made of it until the frames that follow have told:
// then it is in the sum together with the turn of the sample that decides, over the time of both.
#pragma once

#include <algorithm>

#include "filters/chain/plausibility.h"

namespace ifog {

class OpenTurn {
 public:
  [[nodiscard]] bool open() const noexcept { return turned_.covered_s > 0.0; }
  // silence_s: what the silence was longer than the turn's time, at most. known: also then it is known which
  // way round it went.
  void begin(const Turn& turned, double silence_s, bool known) noexcept {
    turned_ = turned;
    silence_s_ = silence_s;
    known_ = known;
  }
  // So much of the silence was time in which samples were lost.
  void lost(double time_s) noexcept {
    if (!open() || !(time_s > 0.0)) return;
    turned_.covered_s += time_s;
    silence_s_ = std::max(0.0, silence_s_ - time_s);
    if (!known_) forget();
  }
  // The rest was a pause of the device: it measured nothing, and turned all the same. Else a hold-up.
  void rest_was(bool pause) noexcept {
    if (!pause)
      silence_s_ = 0.0;
    else if (!known_)
      forget();
  }
  // Into `turned`, a good one behind it. Returns the mean rate of both and of a pause between them, which is
  // in no sample's time.
  [[nodiscard]] double close(Turn& turned) noexcept {
    turned.angle_rad += turned_.angle_rad;
    turned.covered_s += turned_.covered_s;
    const double rate_radps = turned.angle_rad / (turned.covered_s + silence_s_);
    forget();
    return rate_radps;
  }
  void forget() noexcept {
    turned_ = {};
    silence_s_ = 0.0;
  }

 private:
  Turn turned_;
  double silence_s_ = 0.0;
  bool known_ = true;
};

}  // namespace ifog
