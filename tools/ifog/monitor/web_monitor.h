// SPDX-License-Identifier: Apache-2.0
// A read-only page over HTTP for a browser, and its data as JSON: the sensors' names, and for one sensor its
// lines, figures, last two minutes and Allan deviation.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "tools/ifog/monitor/known_here.h"
#include "tools/ifog/monitor/sensor_view.h"

namespace ifog::tools {

struct PageAddress {
  std::string host;
  int port = 0;
};
// Parses [ADDRESS:]PORT: numeric address, IPv6 in brackets, or localhost; default 127.0.0.1.
std::optional<PageAddress> page_address(const std::string& text);

// The page's server. Ends at once, regardless of clients.
class WebMonitor {
 public:
  // `waiting`: text while there is no sensor. All three are read under the guard. Throws std::runtime_error with
  // one line: port in use, no such address here, no permission.
  WebMonitor(const PageAddress& address, const std::map<std::string, SensorView>& sensors,
             const KnownHere& known, std::function<std::string()> waiting);
  ~WebMonitor();
  WebMonitor(const WebMonitor&) = delete;
  WebMonitor& operator=(const WebMonitor&) = delete;

  // Lock it to change the sensors or what is known of them, and to call the following functions.
  [[nodiscard]] std::mutex& guard() { return guard_; }
  void end_interval() { interval_ended_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  class Server;
  // JSON of a sensor for the page; called by several threads.
  [[nodiscard]] std::string data(const std::string& wanted);

  const std::map<std::string, SensorView>& sensors_;
  const KnownHere& known_;
  std::function<std::string()> waiting_;
  Clock::time_point interval_ended_ = Clock::now();
  std::mutex guard_;
  std::unique_ptr<Server> server_;  // last, because it calls data() during its whole life
};

}  // namespace ifog::tools
