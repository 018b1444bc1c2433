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

// One line: the channel, its source, the fault, what was expected.
std::string describe(const ChannelConfig& channel, const ChannelFault& fault);

class ChannelWatch {
 public:
  struct News {
    bool good = false;
    std::string words;
  };

  // channels: names of all channels, those from outside the sensor's frames at the end.
  ChannelWatch(const SensorConfig& sensor, const std::vector<std::string>& channels);

  // Sources that do not exist before anything is opened (files, CAN interfaces); they may appear later.
  [[nodiscard]] std::vector<std::string> absent();
  // status: of this second, with the channels' ages. outside: the channels from outside the frames.
  [[nodiscard]] std::vector<News> look(const status_t& status, const ChannelTable& outside);

 private:
  struct Watched {
    ChannelConfig config{};
    bool configured = false;                // else one of the frames, with the default age
    double looked_s = 0.0, faulty_s = 0.0;  // since the sensor's first sample; since a reason is known
    bool reported = false, behind_reported = false;
  };
  std::vector<Watched> channels_;
};

}  // namespace ifog
