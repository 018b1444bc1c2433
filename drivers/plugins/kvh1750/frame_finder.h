// Finds the intact frames in a byte stream, whatever is between, before or inside them.
//
// At each position that holds a header the frame's bytes are awaited and its CRC checked. A frame that fails
// is passed over by ONE byte, not by its length: so a frame whose header lies inside a damaged one is found,
// and a header pattern that occurs inside an intact frame is never looked at. Two headers cannot overlap and
// differ by at least four bytes, and the longest frame is four bytes longer than the shortest; so an intact
// frame comes out with its own last byte, never later, even behind the torso of another.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "drivers/plugins/kvh1750/frame.h"

namespace ifog::kvh {

class FrameFinder {
 public:
  struct Counters {
    std::uint64_t intact = 0;
    std::uint64_t crc_failed = 0;     // a header, but the checksum of what follows does not fit
    std::uint64_t bytes_skipped = 0;  // bytes that are part of no intact frame
    std::uint64_t bytes_framed = 0;   // bytes of intact frames
  };

  // Calls found(const Frame&) for each intact frame, in order. No allocation.
  template <typename Found>
  void feed(std::span<const std::uint8_t> bytes, Found&& found) noexcept {
    while (!bytes.empty()) {
      bytes = bytes.subspan(take(bytes));
      Frame frame;
      while (next(frame)) found(static_cast<const Frame&>(frame));
    }
  }

  // Forgets what is half read; the bytes count as skipped.
  void reset() noexcept;

  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t waiting() const { return end_ - begin_; }  // bytes that may yet begin a frame

 private:
  std::size_t take(std::span<const std::uint8_t> bytes) noexcept;
  bool next(Frame& frame) noexcept;

  // Large against a frame, so that the remainder is moved to the front seldom.
  static constexpr std::size_t kBuffer = 4096;
  std::array<std::uint8_t, kBuffer> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  Counters counters_;
};

}  // namespace ifog::kvh
