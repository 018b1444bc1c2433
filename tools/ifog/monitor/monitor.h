// SPDX-License-Identifier: Apache-2.0
// Receives and shows messages for `ifog monitor`: on an interactive screen, as lines, as a page, or as JSON.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "drivers/capture/files/output_file.h"
#include "tools/ifog/captures/lcm/lcm_listener.h"
#include "tools/ifog/field/field.h"
#include "tools/ifog/monitor/known_here.h"
#include "tools/ifog/monitor/screen.h"
#include "tools/ifog/monitor/sensor_view.h"
#include "tools/ifog/monitor/web_monitor.h"

namespace ifog::tools {

struct MonitorOptions {
  std::string sensor, url = "udpm://239.255.76.67:7667?ttl=0", json, web;
  FieldOptions field;
  double seconds = 0.0;  // 0: until interrupted
  bool once = false, plain = false;
};

class Monitor {
 public:
  explicit Monitor(const MonitorOptions& options);
  // False: no message was received.
  bool run();
  [[nodiscard]] std::string who_publishes() const;

 private:
  using Clock = std::chrono::steady_clock;
  // Limits the memory, because anybody on the network can publish names.
  static constexpr std::size_t kMostSensors = 256;
  static double seconds_since(Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  }
  void take(const lcm_recv_buf_t& buffer, const std::string& channel);
  template <typename Message>
  void take_message(const lcm_recv_buf_t& buffer, const std::string& name);
  void tell(const std::string& line);
  [[nodiscard]] bool reader_gone() const;
  void end_interval(double seconds);
  void say_what_is_waited_for();
  bool obey(int key);  // false: quit
  void draw();
  [[nodiscard]] std::vector<ShownLine> lines(const LineStyle& style) const;
  [[nodiscard]] std::vector<std::string> waiting() const;
  [[nodiscard]] bool wanted(const std::string& name) const;
  [[nodiscard]] std::string foot() const;
  [[nodiscard]] bool all_shown() const;
  [[nodiscard]] bool received_any() const;

  const MonitorOptions& options_;
  LcmListener listener_;
  std::optional<OutputFile> json_;
  std::optional<Screen> screen_;
  std::map<std::string, SensorView> sensors_;
  std::set<std::string> others_;  // publishing but not selected
  std::uint64_t refused_ = 0;     // messages that are not of their channel's type
  Clock::time_point start_ = Clock::now(), last_data_ = start_, last_look_ = start_;
  std::uint64_t crowded_ = 0;  // messages of sensors beyond kMostSensors
  bool waiting_reported_ = false;
  struct {
    LineStyle style{};
    std::string only{};                                         // only this sensor; empty: all
    std::optional<std::map<std::string, SensorView>> paused{};  // copy that is shown while paused
    bool help = false;
    std::size_t lines_drawn = 0;
  } look_;  // of the screen
  KnownHere known_;
  std::unique_ptr<WebMonitor> web_;
};

}  // namespace ifog::tools
