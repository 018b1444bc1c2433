// SPDX-License-Identifier: Apache-2.0
// Reports channels without new values, once by name at the beginning and once at the end. Called by
// housekeeping once a second.
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

  // Sources that do not exist before anything is opened (files, CAN interfaces); they may appear later.
  [[nodiscard]] std::vector<std::string> absent();
  // status: of this second, with names and ages of the sensor's channels. outside: the channels from outside
  // its frames, which are the last ones.
  [[nodiscard]] std::vector<News> look(const status_t& status, const ChannelTable& outside);

 private:
  struct Seen {
    double looked_s = 0.0, faulty_s = 0.0;  // since the sensor's first sample; since a reason is known
    bool reported = false, behind_reported = false;
  };

  [[nodiscard]] bool is_configured(const std::string& name) const;

  std::vector<ChannelConfig> configured_, outside_;
  std::vector<bool> absent_;  // of the outside channels, reported by absent()
  std::vector<Seen> seen_;
};

}  // namespace ifog
