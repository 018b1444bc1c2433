// SPDX-License-Identifier: Apache-2.0
// Asks the daemon for the status of its sensors through the socket in its state folder.
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

  // Asks twice per second until enough(), a timeout or an interrupt; false in the last two cases. Throws
  // std::runtime_error with one line if the daemon does not answer.
  bool ask(std::chrono::milliseconds most, const std::function<bool(const Statuses&)>& enough);
  // Throws likewise, also with the reasons for which the daemon rejects the configuration.
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
