// SPDX-License-Identifier: Apache-2.0
// What the daemon that works with a state folder says of its sensors, asked by the socket in that folder.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <ifog/status_t.hpp>
#include <map>
#include <string>

namespace ifog::tools {

// By the sensor's name as the daemon spells it.
using Statuses = std::map<std::string, status_t>;

class LiveStatus {
 public:
  LiveStatus(std::string folder, pid_t daemon) : folder_(std::move(folder)), daemon_(daemon) {}

  // Asks twice a second until enough(), or the time is over, or the user interrupts. False: not enough. Throws
  // std::runtime_error with one line: the daemon cannot be asked or does not answer.
  bool ask(std::chrono::milliseconds most, const std::function<bool(const Statuses&)>& enough);
  // Throws likewise, and with what was refused.
  void reload(std::chrono::milliseconds most) const;

  [[nodiscard]] const Statuses& all() const { return all_; }
  // Null: the daemon has no such sensor.
  [[nodiscard]] const status_t* of(const std::string& sensor) const;

 private:
  std::string folder_;
  pid_t daemon_;
  Statuses all_;
};

}  // namespace ifog::tools
