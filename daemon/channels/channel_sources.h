// SPDX-License-Identifier: Apache-2.0
// Reads environment channels from outside a sensor's frames and stores their latest values for the sensor's
// reader thread. One ordinary thread for each CAN bus, and one for all else.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/channels/channel_table.h"
#include "daemon/config/config.h"
#include "drivers/transport/can/can.h"

namespace ifog {

class ChannelSources {
 public:
  struct Wanted {
    ChannelConfig config;
    std::shared_ptr<ChannelTable> table;
    int index = 0;  // index in the table
  };

  using CanOpener = std::function<std::unique_ptr<Transport>(const CanSettings&)>;

  // Opens nothing. Throws std::runtime_error with one line: a missing DBC file or signal, an unknown field.
  // make_can: for tests without CAN.
  ChannelSources(std::vector<Wanted> wanted, const std::string& lcm_url,
                 const CanOpener& make_can = make_can_transport);
  ~ChannelSources();  // stops

  // Opens the sources; missing ones are retried, and their channels are stale. Throws std::runtime_error with
  // one line if LCM is not available.
  void start();
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ifog
