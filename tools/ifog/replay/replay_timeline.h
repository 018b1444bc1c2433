// SPDX-License-Identifier: Apache-2.0
// What `ifog replay` sends: blocks of bytes or CAN frames, each with its recorded time, all in memory so that
// nothing but the sending happens between two deadlines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/ifog/driver.h"
#include "tools/ifog/captures/capture_input.h"

namespace ifog::tools {

struct ReplayTimeline {
  struct Block {
    std::int64_t time_ns;
    std::size_t end;  // one past its last byte in `bytes`
  };
  std::vector<ifog_can_frame> frames;  // arrival_ns is the recorded time
  std::vector<std::uint8_t> bytes;     // either these or frames
  std::vector<Block> blocks;
  // For writing a log again: the log's, and of each frame which of them, or else the first of all.
  std::vector<std::string> interfaces{"can0"};
  std::vector<std::uint16_t> on;
  std::uint32_t baud = 0;  // what the driver's maker prescribes; 0: unknown

  [[nodiscard]] bool is_can() const { return blocks.empty() && !frames.empty(); }
  [[nodiscard]] std::size_t size() const { return is_can() ? frames.size() : blocks.size(); }
  [[nodiscard]] const std::string& interface(std::size_t i) const {
    return interfaces[on.empty() ? 0 : on[i]];
  }
  [[nodiscard]] std::int64_t time_ns(std::size_t i) const {
    return is_can() ? frames[i].arrival_ns : blocks[i].time_ns;
  }
};

struct ReplaySource {
  std::string path;
  std::string format = "auto";  // or "candump", "bytes", "csv"
  std::size_t block_bytes{};    // raw bytes: sent together, one frame of the device
  double rate_hz{};             // raw bytes: blocks a second
  // csv: whose frames the rows become; raw bytes: whose frames and times they are, instead of the two above;
  // the channel is the interface: of a candump log that which is sent, of others that which a log is to name.
  CaptureInput input;
  std::string axis;
  bool prefer_can = false;  // csv: for a driver that speaks both
};

// Throws std::runtime_error with one line: what the file lacks, or which setting a format needs. Notices
// (columns without a place in the frames, …) go to stderr.
ReplayTimeline read_timeline(const ReplaySource& source);

}  // namespace ifog::tools
