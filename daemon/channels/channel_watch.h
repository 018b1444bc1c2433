// SPDX-License-Identifier: Apache-2.0
// Which channels of a sensor are without a new value, reported once by name when it begins and once when it is
// over. Housekeeping's, once a second.
#pragma once

#include <ifog/status_t.hpp>
#include <string>
#include <vector>

#include "daemon/channels/channel_table.h"
#include "daemon/config/config.h"

namespace ifog {

class ChannelWatch {
 public:
  struct News {
    bool good = false;
    std::string words;
  };

  explicit ChannelWatch(const SensorConfig& sensor);

  // What is not there before anything is opened: files, CAN interfaces. It may come yet.
  [[nodiscard]] std::vector<std::string> absent();
  // status: this second's, with names and ages of the sensor's channels. outside: those that do not come in
  // its frames, the last of them.
  [[nodiscard]] std::vector<News> look(const status_t& status, const ChannelTable& outside);

 private:
  struct Seen {
    double looked_s = 0.0, faulty_s = 0.0;  // since the sensor has sent, and since there is a known reason
    bool reported = false, behind_reported = false;
  };

  [[nodiscard]] bool is_configured(const std::string& name) const;

  std::vector<ChannelConfig> configured_, outside_;
  std::vector<bool> absent_;  // of the outside ones, reported by absent()
  std::vector<Seen> seen_;
};

}  // namespace ifog
