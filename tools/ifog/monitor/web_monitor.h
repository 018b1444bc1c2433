// SPDX-License-Identifier: Apache-2.0
// Data of the page as JSON: the sensors' names, and for one sensor its lines, figures, last two minutes and
// Allan deviation.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "tools/ifog/monitor/known_here.h"
#include "tools/ifog/monitor/page/page_server.h"
#include "tools/ifog/monitor/sensor_view.h"

namespace ifog::tools {

class WebMonitor {
 public:
  // `waiting`: text while there is no sensor. All three are read under the guard. Throws as PageServer does.
  WebMonitor(const PageAddress& address, const std::map<std::string, SensorView>& sensors,
             const KnownHere& known, std::function<std::string()> waiting);

  // Lock it to change the sensors or what is known of them, and to call the following functions.
  [[nodiscard]] std::mutex& guard() { return guard_; }
  void end_interval() { interval_ended_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] std::string data(const std::string& wanted);

  const std::map<std::string, SensorView>& sensors_;
  const KnownHere& known_;
  std::function<std::string()> waiting_;
  Clock::time_point interval_ended_ = Clock::now();
  std::mutex guard_;
  PageServer server_;  // last, because it calls data() during its whole life
};

}  // namespace ifog::tools
