// SPDX-License-Identifier: Apache-2.0
// What can-utils' candump writes, one frame a line, in both its formats.
//   candump -l, -L   "(1436509052.249713) can0 123#1122AABB". CAN FD: "123##5AABB", the digit being the flags
//                    (1 bit-rate switch, 2 error state)
//   on the screen    "  can0  123   [4]  11 22 AA BB", with a time in front (-t a, d, z, and A, a date, taken
//                    for UTC as it does not say its zone), "RX - -" behind the interface (-x), the bytes as
//                    bits (-i), last first with "`" between them (-S), or as characters, too, at the end
//                    (-a). CAN FD: the length has two digits, "[08]"
// Extended ids have 8 digits. Remote frames ("123#R4", "remote request") and error frames (id with bit 29
// set) are distinguished from data.
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

// drops: frames that the kernel lost before candump could read them, of candump -d.
enum class CandumpLine { frame, remote, error, drops, blank, malformed };

inline constexpr const char* kCandumpExpected =
    "expected '(seconds.micros) interface id#data' or 'interface id [length] bytes'";

// candump -t d (since the frame before) and -t z (since the first) look alike: short, of 3 digits for the
// seconds.
enum class CandumpStamp { none, since, absolute };
// The arrival time of a short stamp of zero, because an arrival of 0 means no time.
inline constexpr std::int64_t kShortStampsFrom_ns = 1'000'000'000;

struct CandumpEntry {
  ifog_can_frame frame{};  // arrival_ns is the line's time, 0 without one
  CandumpStamp stamp = CandumpStamp::none;
  std::string_view interface;  // into the line
  std::uint64_t dropped = 0;   // frames, on a line that reports drops
};

// One line without its end; blank and '#' lines are `blank`. Does not allocate. `entry` is set unless blank
// or malformed.
CandumpLine parse_candump_line(std::string_view line, CandumpEntry& entry) noexcept;

// The longest line format_candump_line writes: 64 bytes of data, a time, an interface name of 15.
inline constexpr std::size_t kCandumpLineMax = 224;

// Writes the line with '\n', returns its length. Time is cut to µs, as canplayer reads no more digits. `out`
// holds kCandumpLineMax bytes. Does not allocate.
std::size_t format_candump_line(const ifog_can_frame& frame, std::string_view interface, char* out) noexcept;

// Turns the times on the lines into increasing times. Lines without one get 0. Short ones are times since the
// first frame, or differences that add up: from where one is smaller than that before, which times since the
// first never are.
class CandumpClock {
 public:
  // differences: where a log's beginning shows them.
  explicit CandumpClock(bool differences = false) : differences_(differences) {}
  std::int64_t time_ns(const CandumpEntry& entry) noexcept;
  [[nodiscard]] bool differences() const { return differences_; }

 private:
  bool differences_;
  std::int64_t last_stamp_ns_ = 0;
  std::int64_t now_ns_ = 0;
};

// Whether a log that begins so has differences for times: one is smaller than that before, or all are the same.
bool times_are_differences(std::string_view beginning) noexcept;

// On which interface each id was seen first: the same id on another is another device's. Of the first 64 ids.
// Names are cut to 15 characters, as an interface's are, for which std::string does not allocate.
class CandumpBuses {
 public:
  // The interface on which frames of this id were received before, or "".
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

// What of a log was no frame of data.
struct CandumpLosses {
  std::size_t remote = 0, error = 0;  // frames not decoded
  std::uint64_t dropped = 0;          // that the kernel lost before candump
  bool cut_off = false;               // the last line has no end and is no whole frame: it was dropped
};

// A frame, and the interface on which it was received.
using CandumpSink = std::function<void(const ifog_can_frame&, std::string_view)>;

// Reads a log of any length, plain or gzip, frames of one interface only unless `interface` is empty. Throws
// std::runtime_error with one line: file, line, what was expected. It may come behind frames that were handed
// on.
CandumpLosses for_each_candump_frame(InputFile& file, std::string_view interface, const CandumpSink& sink);

// The arrival time, ns, that frames of a log that begins so have at a stamp of zero; nothing where its lines
// have no times.
std::optional<std::int64_t> zero_of_stamps(std::string_view beginning);

// The interface of the first frame that is wanted, of a log's beginning; "" where none is in it.
std::string first_interface(std::string_view beginning,
                            const std::function<bool(const ifog_can_frame&)>& wanted);

}  // namespace ifog
