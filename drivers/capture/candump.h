// The log of can-utils' candump -l: "(1436509052.249713) can0 123#1122AABB", one frame a line.
// CAN FD: "123##5AABB", the digit being the flags (1 bit-rate switch, 2 error state). Extended ids have 8
// digits. Remote frames ("123#R4") and error frames (id with bit 29 set) are told apart from data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/ifog/driver.h"

namespace ifog {

enum class CandumpLine { frame, remote, error, blank, malformed };

inline constexpr const char* kCandumpExpected = "expected '(seconds.micros) interface id#data'";

struct CandumpEntry {
  ifog_can_frame frame{};      // arrival_ns is the log's time
  std::string_view interface;  // into the line
};

// One line without its end; blank and '#' lines are `blank`. Does not allocate. `entry` is set unless blank
// or malformed.
CandumpLine parse_candump_line(std::string_view line, CandumpEntry& entry) noexcept;

// The longest line format_candump_line writes: 64 bytes of data, a time, an interface name of 15.
inline constexpr std::size_t kCandumpLineMax = 224;

// Writes the line with '\n', returns its length. Time is cut to µs, as canplayer reads no more digits. `out`
// holds kCandumpLineMax bytes. Does not allocate.
std::size_t format_candump_line(const ifog_can_frame& frame, std::string_view interface, char* out) noexcept;

struct Candump {
  std::vector<ifog_can_frame> frames;  // data frames, as in the log
  std::string interface;               // of the first of them
  std::size_t remote = 0, error = 0;   // frames passed over
};

// Reads a whole log, plain or gzip, frames of one interface only unless `interface` is empty. Throws
// std::runtime_error with one line: file, line, what was expected.
Candump read_candump(const std::string& path, std::string_view interface = {});

}  // namespace ifog
