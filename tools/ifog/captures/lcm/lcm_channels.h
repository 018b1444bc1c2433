// SPDX-License-Identifier: Apache-2.0
// Environment channels out of LCM messages, as columns beside a sensor's rates: what the sensor's own status
// says of its channels once a second, and ifog.channel_t of other names. Which there are only the whole log
// tells, so it is looked through first; then its rows are read, and nothing of them is kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ifog::tools {

class LcmChannels {
 public:
  // rates: the LCM channel that carries the sensor's rates; its status is on that with _STATUS behind it.
  explicit LcmChannels(const std::string& rates) : status_(rates + "_STATUS") {}

  // The first look: any message of the log but the rates, and that a row of rates came. The status's view of a channel
  // is scaled and held to its limits, so it stands over a message of that name. Names that no capture's column may have
  // are dropped.
  void look_at(const std::string& channel, std::span<const std::uint8_t> message);
  void saw_row() { ++rows_; }
  // The columns that have a value in some row, without those that come by another way.
  std::vector<std::string> settle(const std::vector<std::string>& without);

  // The second: what has come since the row before, by name, is appended: NaN where nothing new had.
  void take(const std::string& channel, std::span<const std::uint8_t> message);
  void end_row(std::vector<double>& values);

 private:
  struct Said {
    const std::string& name;
    double value;
    double measured_s;  // infinite where the message does not tell
    bool of_status;
  };
  struct Channel {
    bool of_status = false, known = false;
    std::size_t first_row = 0;
    double last = 0.0, measured_s = 0.0;
    std::optional<double> now;
  };
  // Each channel of a message, one value at a time.
  void unpack(const std::string& channel, std::span<const std::uint8_t> message,
              const std::function<void(const Said&)>& sink) const;

  std::string status_;
  std::map<std::string, Channel> channels_;
  std::size_t rows_ = 0;
};

}  // namespace ifog::tools
