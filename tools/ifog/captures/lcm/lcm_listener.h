// SPDX-License-Identifier: Apache-2.0
// Receives LCM messages, for commands that show or record what the daemon publishes.
#pragma once

#include <lcm/lcm.h>

#include <exception>
#include <functional>
#include <string>

namespace ifog::tools {

class LcmListener {
 public:
  using Handler = std::function<void(const lcm_recv_buf_t& message, const std::string& channel)>;

  // Throws std::runtime_error if LCM cannot use the URL.
  LcmListener(const std::string& url, Handler handler);
  ~LcmListener();
  LcmListener(const LcmListener&) = delete;
  LcmListener& operator=(const LcmListener&) = delete;

  // Subscribes to channels whose whole name matches the regular expression. Throws std::runtime_error if it
  // is not valid.
  void listen_to(const std::string& pattern);
  // Subscribes to rates and status of a sensor by its configured name; empty: of every sensor.
  void listen_to_sensor(const std::string& name);

  // For poll().
  [[nodiscard]] int descriptor() const;
  // Waits for one message and passes it on; call it when the descriptor is readable. Throws what the handler
  // throws.
  void take();

 private:
  static void received(const lcm_recv_buf_t* message, const char* channel, void* user) noexcept;

  Handler handler_;
  lcm_t* lcm_;
  std::exception_ptr failure_;
};

}  // namespace ifog::tools
