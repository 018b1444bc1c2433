// SPDX-License-Identifier: Apache-2.0
// Listens to the sources of environment channels that do not come in a sensor's frames, and keeps the latest
// value of each where the sensor's reader thread looks. One ordinary thread for all of them.
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
    int index = 0;  // in the table
  };

  using CanOpener = std::function<std::unique_ptr<Transport>(const CanSettings&)>;

  // Opens nothing. Throws std::runtime_error with one line: a DBC file or a signal that is not there, a field
  // nobody knows.
  // `make_can` is there for tests, on machines without CAN.
  ChannelSources(std::vector<Wanted> wanted, const std::string& lcm_url,
                 const CanOpener& make_can = make_can_transport);
  ~ChannelSources();  // stops

  // Opens what there is; what is not may come yet, and until then its channels are stale. Throws
  // std::runtime_error with one line when LCM cannot be had.
  void start();
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ifog
