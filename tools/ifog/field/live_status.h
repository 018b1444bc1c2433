// SPDX-License-Identifier: Apache-2.0
// What the daemon says of its sensors while somebody listens.
#pragma once

#include <chrono>
#include <functional>
#include <ifog/status_t.hpp>
#include <map>
#include <string>

#include "tools/ifog/captures/lcm_listener.h"

namespace ifog::tools {

class LiveStatus {
 public:
  // Throws std::runtime_error with one line: an address that LCM cannot use.
  explicit LiveStatus(const std::string& lcm_url);

  // Until enough() or the time is over or the user interrupts. False: not enough.
  bool listen(std::chrono::milliseconds most, const std::function<bool()>& enough);

  // The latest of each, by the sensor's name as the daemon spells it.
  [[nodiscard]] const std::map<std::string, status_t>& all() const { return all_; }
  // Null: not heard.
  [[nodiscard]] const status_t* of(const std::string& sensor) const;
  // Called with every message.
  std::function<void(const status_t&)> each;

 private:
  std::map<std::string, status_t> all_;
  LcmListener listener_;
};

}  // namespace ifog::tools
