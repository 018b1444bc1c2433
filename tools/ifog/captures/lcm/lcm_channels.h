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

// What messages say of channels, one value at a time.
class LcmChannelMessages {
 public:
  struct Said {
    const std::string& name;
    double value;
    double measured_s;  // infinite where the message does not tell
    bool of_status;
  };
  // rates: the LCM channel that carries the sensor's rates; its status is on that with _STATUS behind it.
  explicit LcmChannelMessages(const std::string& rates) : status_(rates + "_STATUS") {}

  // Takes the channels of any message of the log. Others are dropped, and so are names that no capture's column may
  // have as well.
  void take(const std::string& channel, std::span<const std::uint8_t> message,
            const std::function<void(const Said&)>& sink) const;

 private:
  std::string status_;
};

// The first look.
class LcmChannelNames {
 public:
  explicit LcmChannelNames(const std::string& rates) : messages_(rates) {}
  void take(const std::string& channel, std::span<const std::uint8_t> message);
  // A row of rates came.
  void end_row() { ++rows_; }

  // For each column that has a value in some row: whether it is the status's. The status's view of a channel is
  // scaled and held to its limits, so it stands over a message of that name.
  [[nodiscard]] std::map<std::string, bool> of_status() const;

 private:
  struct Channel {
    bool of_status = false;
    std::size_t first_row = 0;
  };
  LcmChannelMessages messages_;
  std::map<std::string, Channel> channels_;
  std::size_t rows_ = 0;
};

// The second.
class LcmChannelRows {
 public:
  LcmChannelRows(const std::string& rates, const std::map<std::string, bool>& of_status);

  [[nodiscard]] std::vector<std::string> names() const;
  void take(const std::string& channel, std::span<const std::uint8_t> message);
  // What has come since the row before, by name: NaN where nothing new had. values: one for each.
  void end_row(std::span<double> values);

 private:
  struct Channel {
    bool of_status = false, known = false;
    double last = 0.0, measured_s = 0.0;
    std::optional<double> now;
  };
  LcmChannelMessages messages_;
  std::map<std::string, Channel> channels_;
};

}  // namespace ifog::tools
