// SPDX-License-Identifier: Apache-2.0
// Whether a sensor's status comes beside its rates, as it does once a second: nothing else on LCM says what
// its environment channels were.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "drivers/ifog/quoted.h"
#include "msgs/channel_name.h"

namespace ifog::tools {

class StatusBeside {
 public:
  // came_utime: when the message was received, as the computer's clock had it: a recording may be played
  // faster than its sensor measured, and a status comes once a second all the same.
  void rate(std::int64_t came_utime) {
    if (!first_) first_ = came_utime;
    rates_us_ = std::max(rates_us_, came_utime - *first_);
  }
  void status() { heard_ = true; }
  // Rates for longer than any of three statuses may take, and none of them.
  [[nodiscard]] bool missing() const { return !heard_ && rates_us_ > kLong_us; }
  // What to say of it: the whole line but for whose it is.
  [[nodiscard]] std::string complaint(const std::string& rates) const {
    return "rates on " + printable(rates) + " for " + std::to_string(rates_us_ / 1'000'000) +
           " s and nothing on " + printable(rates + std::string(kStatusEnding)) +
           ", which says once a second what the sensor's environment channels are: none of them is in it";
  }

 private:
  static constexpr std::int64_t kLong_us = 3'000'000;
  std::optional<std::int64_t> first_;
  std::int64_t rates_us_ = 0;
  bool heard_ = false;
};

}  // namespace ifog::tools
