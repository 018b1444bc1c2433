// SPDX-License-Identifier: Apache-2.0
// Data of `ifog replay`: blocks of bytes or CAN frames with their recorded times, all in memory, so that
// nothing delays sending.
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
  // For writing a log: the interfaces, and the interface of each frame; without it the first one.
  std::vector<std::string> interfaces{"can0"};
  std::vector<std::uint16_t> on;
  std::uint32_t baud = 0;  // baud rate that the driver prescribes; 0: unknown

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
  std::size_t block_bytes{};    // raw bytes: one frame of the device, sent together
  double rate_hz{};             // raw bytes: blocks per second
  // csv: driver of the frames to encode. Raw bytes: driver that finds frames and times instead of the two
  // above. Its channel is an interface: the one to send from a candump log, or the one to write into a log.
  CaptureInput input;
  std::string axis;
  bool prefer_can = false;  // csv: for a driver of both bytes and CAN
};

// Throws std::runtime_error with one line: missing data in the file, or a missing option for its format.
// Prints warnings on standard error, e.g. columns that the frames cannot contain.
ReplayTimeline read_timeline(const ReplaySource& source);

}  // namespace ifog::tools
