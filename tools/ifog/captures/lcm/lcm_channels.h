// SPDX-License-Identifier: Apache-2.0
// Environment channels in LCM messages as columns: the channels in the sensor's status, once per second, and
// ifog.channel_t. The first pass over the log finds their names, the second reads the rows.
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
  // rates: LCM channel of the sensor's rates; its status is on the same name with _STATUS appended.
  explicit LcmChannels(const std::string& rates) : status_(rates + "_STATUS") {}

  // First pass: any message except rates. A status is preferred to an ifog.channel_t of the same name,
  // because its values are scaled and limited. Names that a capture cannot have are dropped.
  void look_at(const std::string& channel, std::span<const std::uint8_t> message);
  void saw_row() { ++rows_; }
  // Columns with a value in some row, except those in `without`.
  std::vector<std::string> settle(const std::vector<std::string>& without);

  // Second pass: values since the previous row, in the order of the names; NaN if there is none.
  void take(const std::string& channel, std::span<const std::uint8_t> message);
  void end_row(std::vector<double>& values);

 private:
  struct Said {
    const std::string& name;
    double value;
    double measured_s;  // infinite if the message does not contain it
    bool of_status;
  };
  struct Channel {
    bool of_status = false, known = false;
    std::size_t first_row = 0;
    double last = 0.0, measured_s = 0.0;
    std::optional<double> now;
  };
  // Calls `sink` for each value in the message.
  void unpack(const std::string& channel, std::span<const std::uint8_t> message,
              const std::function<void(const Said&)>& sink) const;

  std::string status_;
  std::map<std::string, Channel> channels_;
  std::size_t rows_ = 0;
};

}  // namespace ifog::tools
