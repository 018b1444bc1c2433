// SPDX-License-Identifier: Apache-2.0
// Environment channels out of LCM messages, as columns beside a sensor's rates: what the sensor's own status
// says of its channels once a second, and ifog.channel_t of other names.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"

namespace ifog::tools {

class LcmChannels {
 public:
  // rates: the LCM channel that carries the sensor's rates; its status is on that with _STATUS behind it.
  explicit LcmChannels(const std::string& rates) : status_(rates + "_STATUS") {}

  // Any message of the log; what carries no channels is passed over.
  void take(const std::string& channel, std::span<const std::uint8_t> message);
  // A row of rates came: what has come since the row before stands in it.
  void end_row();

  // NaN in rows where nothing new had come. Names that no capture's column may have are left out.
  [[nodiscard]] std::vector<CaptureColumn> columns() const;

 private:
  struct Channel {
    std::map<std::size_t, double> by_row;
    bool known = false, of_status = false;
    double last = 0.0;
    double measured_s = 0.0;
  };
  void put(const std::string& name, double value, double measured_s, bool of_status);

  std::string status_;
  std::map<std::string, Channel> channels_;
  std::size_t row_ = 0;
};

}  // namespace ifog::tools
