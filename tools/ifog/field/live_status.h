// SPDX-License-Identifier: Apache-2.0
// What the daemon that works with a state folder says of its sensors, asked by the socket in that folder.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <ifog/status_t.hpp>
#include <map>
#include <string>

#include "daemon/state/state_file.h"

namespace ifog::tools {

class LiveStatus {
 public:
  // The process that holds the folder's mark. Throws std::runtime_error with one line: it cannot be asked.
  LiveStatus(const std::string& folder, pid_t daemon);

  // Until enough() or the time is over, the user interrupts or the daemon has gone. False: not enough.
  bool listen(std::chrono::milliseconds most, const std::function<bool()>& enough);
  // Asks for a reload and waits for the answer. Throws std::runtime_error with what was refused, or when none comes.
  void reload(std::chrono::milliseconds most);

  // The latest of each, by the sensor's name as the daemon spells it.
  [[nodiscard]] const std::map<std::string, status_t>& all() const { return all_; }
  // Null: nothing was said of it.
  [[nodiscard]] const status_t* of(const std::string& sensor) const;
  // All sensors have been said.
  [[nodiscard]] bool complete() const { return complete_; }
  [[nodiscard]] bool gone() const { return gone_; }
  // Called with every message.
  std::function<void(const status_t&)> each;

 private:
  void take(std::string_view packet);

  std::string who_;
  Fd fd_;
  std::map<std::string, status_t> all_;
  bool complete_ = false, gone_ = false;
  std::optional<std::string> answer_;
};

}  // namespace ifog::tools
