// SPDX-License-Identifier: Apache-2.0
// Parses and writes candump's formats (can-utils), one frame per line:
//   candump -l, -L   "(1436509052.249713) can0 123#1122AABB". CAN FD: "123##5AABB", the digit being the flags
//   (1 bit-rate switch, 2 error state)
//   on the screen    "  can0  123   [4]  11 22 AA BB", optionally after a time (-t a, d, z, and A, a date,
//   assumed to be UTC), "RX - -" after the interface (-x), characters behind the bytes (-a). CAN FD: the length has
//   two digits, "[08]"
// Extended ids have 8 digits. Remote frames ("123#R4", "remote request") and error frames (id with bit 29
// set) are recognised.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/capture/files/input_file.h"
#include "drivers/ifog/driver.h"

namespace ifog {

// drops: frames lost by the kernel, reported by candump -d.
enum class CandumpLine { frame, remote, error, drops, blank, malformed };

inline constexpr const char* kCandumpExpected =
    "expected '(seconds.micros) interface id#data' or 'interface id [length] bytes'";

// since: short times with 3 digits for the seconds, of candump -t d (since the previous frame) or -t z (since
// the first one).
enum class CandumpStamp { none, since, absolute };
// Arrival time of a short stamp of zero, since an arrival of 0 means no time.
inline constexpr std::int64_t kShortStampsFrom_ns = 1'000'000'000;

struct CandumpEntry {
  ifog_can_frame frame{};  // arrival_ns is the line's time, 0 without one
  CandumpStamp stamp = CandumpStamp::none;
  std::string_view interface;  // refers to the line
  std::uint64_t dropped = 0;   // number of frames, on a line that reports drops
};

// Parses a line without its end; empty and '#' lines are `blank`. `entry` is set unless blank or malformed.
// Does not allocate.
CandumpLine parse_candump_line(std::string_view line, CandumpEntry& entry) noexcept;

// Longest line of format_candump_line(): 64 bytes of data, a time, an interface name of 15.
inline constexpr std::size_t kCandumpLineMax = 224;

// Writes the line with '\n' and returns its length. The time is truncated to µs, as canplayer reads no more
// digits. `out` has kCandumpLineMax bytes. Does not allocate.
std::size_t format_candump_line(const ifog_can_frame& frame, std::string_view interface, char* out) noexcept;

// Converts the lines' times to increasing times. Lines without a time get 0. Short times are since the first
// frame, or differences: after one is smaller than the one before they must be differences.
class CandumpClock {
 public:
  // differences: known from the log's beginning.
  explicit CandumpClock(bool differences = false) : differences_(differences) {}
  std::int64_t time_ns(const CandumpEntry& entry) noexcept;
  [[nodiscard]] bool differences() const { return differences_; }

 private:
  bool differences_;
  std::int64_t last_stamp_ns_ = 0;
  std::int64_t now_ns_ = 0;
};

// True if the log's short times are differences: one is smaller than the one before, or all are equal.
bool times_are_differences(std::string_view beginning) noexcept;

// First interface of each id, for up to 64 ids: the same id on another interface is another device. Names are
// cut to 15 characters, for which std::string does not allocate.
class CandumpBuses {
 public:
  // The interface on which this id was received first, if it is another one, else "".
  std::string_view other(const ifog_can_frame& frame, std::string_view interface) noexcept;

 private:
  static constexpr std::size_t kLongestName = 15, kMost = 64;
  struct Seen {
    std::uint32_t id = 0;
    bool extended = false;
    std::string interface;
  };
  std::array<Seen, kMost> seen_{};
  std::size_t count_ = 0;
};

// Frames of a log that were not decoded.
struct CandumpLosses {
  std::size_t remote = 0, error = 0;  // frames
  std::uint64_t dropped = 0;          // lost by the kernel before candump
  bool cut_off = false;               // the last line has no end and is no complete frame: it was dropped
};

// A frame and its interface.
using CandumpSink = std::function<void(const ifog_can_frame&, std::string_view)>;

// Reads a log of any length, plain or gzip. interface: only its frames, "" for all. wanted: frames of one device, of
// which no id may come from two interfaces. Throws std::runtime_error with one line: file, line, what was expected;
// frames may have been passed before.
using WantedFrame = std::function<bool(const ifog_can_frame&)>;
CandumpLosses for_each_candump_frame(InputFile& file, std::string_view interface, const WantedFrame& wanted,
                                     const CandumpSink& sink);

// Arrival time, ns, of a stamp of zero in a log with this beginning; nullopt if its lines have no times.
std::optional<std::int64_t> zero_of_stamps(std::string_view beginning);

// Interface of the first wanted frame in the log's beginning, or "".
std::string first_interface(std::string_view beginning, const WantedFrame& wanted);

}  // namespace ifog
