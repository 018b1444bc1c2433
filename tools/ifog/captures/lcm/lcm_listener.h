// SPDX-License-Identifier: Apache-2.0
// Messages of LCM as they come, for commands that show or keep what the daemon publishes.
#pragma once

#include <lcm/lcm.h>

#include <exception>
#include <functional>
#include <string>

namespace ifog::tools {

class LcmListener {
 public:
  using Handler = std::function<void(const lcm_recv_buf_t& message, const std::string& channel)>;

  // Throws std::runtime_error where LCM cannot use the URL.
  LcmListener(const std::string& url, Handler handler);
  ~LcmListener();
  LcmListener(const LcmListener&) = delete;
  LcmListener& operator=(const LcmListener&) = delete;

  // Channels that match a regular expression, whole. Throws std::runtime_error for what is none.
  void listen_to(const std::string& pattern);
  // Rates and status of a sensor of the daemon, by its name in the configuration; empty: of every one.
  void listen_to_sensor(const std::string& name);

  // To be polled for reading.
  [[nodiscard]] int descriptor() const;
  // Waits for one message and hands it over; to be called when there is something to be read. Throws what
  // the handler threw.
  void take();

 private:
  static void received(const lcm_recv_buf_t* message, const char* channel, void* user) noexcept;

  Handler handler_;
  lcm_t* lcm_;
  std::exception_ptr failure_;
};

}  // namespace ifog::tools
