// SPDX-License-Identifier: Apache-2.0
// What the page shows, kept and answered as JSON: of every sensor its name, of one its lines, figures, last minute and Allan
// deviation so far.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <ifog/rate_t.hpp>
#include <limits>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/ifog/monitor/known_here.h"
#include "tools/ifog/monitor/page/page_server.h"
#include "tools/ifog/monitor/sensor_view.h"

namespace ifog::tools {

// Of one axis the last minute, in bins of a fifth of a second by the time of arrival. What did not come is NaN.
class AxisTrace {
 public:
  static constexpr double kBin_s = 0.2;
  static constexpr std::int64_t kBins = 300;
  struct Bin {
    std::int64_t number = -1;
    double low, high, denoised;  // low and high of raw, denoised the last
  };
  void take(double now_s, double raw, double denoised);
  // Oldest first, to the last bin that is over; the place is empty where nothing came.
  [[nodiscard]] std::vector<Bin> last_minute(double now_s) const;

 private:
  std::array<Bin, kBins> bins_{};
};

class WebMonitor {
 public:
  static constexpr std::size_t kMostAxes = 3;

  // `waiting`: what is waited for, while there is no sensor. All three are read under the guard. Throws as PageServer does.
  WebMonitor(const PageAddress& address, const std::map<std::string, SensorView>& sensors,
             const KnownHere& known, std::function<std::string()> waiting);

  // To be held by who changes the sensors or calls the following.
  [[nodiscard]] std::mutex& guard() { return guard_; }
  void take(const std::string& sensor, const rate_t& message);
  void end_interval() { interval_ended_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] std::string data(const std::string& wanted);
  [[nodiscard]] nlohmann::ordered_json of_sensor(const std::string& name, const SensorView& sensor) const;
  [[nodiscard]] double now_s() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  const std::map<std::string, SensorView>& sensors_;
  const KnownHere& known_;
  std::function<std::string()> waiting_;
  std::map<std::string, std::array<AxisTrace, kMostAxes>> traces_;
  Clock::time_point start_ = Clock::now(), interval_ended_ = start_;
  std::mutex guard_;
  PageServer server_;  // last: it calls data() from its first moment to its end
};

}  // namespace ifog::tools
