// SPDX-License-Identifier: Apache-2.0
// Finds the intact frames in a byte stream, whatever is between, before or inside them.
//
// At each position that holds a header the frame's bytes are awaited and its checksum is tried. A frame that
// fails is skipped by ONE byte, not by its length: so a frame whose header lies inside a damaged one is
// found. While a frame is not yet whole the positions behind its header are tried too: a header that damage
// or chance has made, and that announces bytes which never come, holds back nothing. So an intact frame comes
// out with its own last byte, never later. The price is that a whole frame, checksum and all, inside another
// one's payload is accepted and the outer one lost; no device sends that. Of frames that overlap the
// one that ends first is accepted, also where all bytes arrive at once: a recording gives the frames that the
// line gave, however either was cut into portions.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <utility>

#include "ifog/driver.h"

namespace ifog::framing {

struct FrameCounters {
  std::uint64_t intact = 0;
  // A header, but the checksum of what follows does not fit. Within an intact frame it is none: payload may
  // look like one.
  std::uint64_t checksum_failed = 0;
  std::uint64_t bytes_skipped = 0;  // bytes that are part of no intact frame
  std::uint64_t bytes_framed = 0;   // bytes of intact frames
};

// What a header says.
struct Announced {
  enum class Is { none, unknown_yet, frame };
  Is is = Is::none;        // unknown_yet: the bytes so far may begin a header
  std::size_t length = 0;  // of the whole frame
};

// A Protocol has
//   static constexpr std::size_t kLongest;                         of a frame, bytes
//   Announced at(std::span<const std::uint8_t>) const noexcept;    of the header there; at least a byte
//   bool intact(std::span<const std::uint8_t>) const noexcept;     checksum of a whole frame
// and, where every header begins with the same byte,
//   static constexpr std::uint8_t kFirst;
template <typename Protocol>
class FrameFinder {
 public:
  explicit FrameFinder(Protocol protocol = {}) : protocol_(protocol) {}

  // Calls found(std::span<const std::uint8_t>) for each intact frame, in order. No allocation.
  template <typename Found>
  void feed(std::span<const std::uint8_t> bytes, Found&& found) noexcept {
    while (!bytes.empty()) {
      bytes = bytes.subspan(take(bytes));
      while (const std::optional<Place> place = next()) {
        found(std::span<const std::uint8_t>(buffer_.data() + place->at, place->length));
        begin_ = place->at + place->length;
      }
    }
  }

  // Forgets what is half read; the bytes count as skipped.
  void reset() noexcept {
    pass_over(end_);
    forget();
  }

  // As the host wants them. `unused`: of the intact frames, those that the driver was configured to ignore.
  void copy_to(ifog_driver_counters& out, std::uint64_t unused = 0) const noexcept {
    out = {};
    out.frames_good = counters_.intact - unused;
    out.frames_crc = counters_.checksum_failed;
    out.frames_format = unused;
    out.bytes_skipped = counters_.bytes_skipped;
    out.bytes_framed = counters_.bytes_framed;
    out.bytes_pending = waiting();
  }
  [[nodiscard]] const FrameCounters& counters() const { return counters_; }
  [[nodiscard]] std::size_t waiting() const { return end_ - begin_; }  // bytes that may yet begin a frame

 private:
  struct Place {
    std::size_t at, length;
  };

  std::size_t take(std::span<const std::uint8_t> bytes) noexcept {
    // next() leaves less than a frame behind, so there is always room after this.
    if (kBuffer - end_ < bytes.size() && begin_ != 0) {
      std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
      failed_ >>= begin_;
      sum_failed_ >>= begin_;
      end_ -= begin_;
      begin_ = 0;
    }
    const std::size_t n = std::min(kBuffer - end_, bytes.size());
    std::memcpy(buffer_.data() + end_, bytes.data(), n);
    end_ += n;
    return n;
  }

  // The next intact frame; without one, bytes that can begin none any more are skipped.
  std::optional<Place> next() noexcept {
    std::size_t keep = end_;  // the first position that may yet begin a frame
    for (std::size_t at = begin_; at < end_; ++at) {
      if (failed_.test(at)) continue;
      const std::span<const std::uint8_t> rest(buffer_.data() + at, end_ - at);
      const Announced announced = protocol_.at(rest);
      if (announced.is == Announced::Is::frame && rest.size() >= announced.length) {
        if (intact(at, announced.length)) {
          const Place first = ends_first({at, announced.length});
          accept(first.at, first.length);
          return first;
        }
      } else if (announced.is == Announced::Is::none) {
        fail(at);
      } else {
        keep = std::min(keep, at);
      }
    }
    pass_over(keep);
    begin_ = keep;
    if (begin_ == end_) forget();
    return std::nullopt;
  }

  // Bytes before it that are not yet consumed are part of no intact frame.
  void pass_over(std::size_t upto) noexcept {
    counters_.bytes_skipped += upto - begin_;
    if (!any_failed_) return;
    for (std::size_t at = begin_; at < upto; ++at) counters_.checksum_failed += sum_failed_.test(at) ? 1 : 0;
  }
  void fail(std::size_t at) noexcept {
    failed_.set(at);
    any_failed_ = true;
  }
  void forget() noexcept {
    begin_ = end_ = 0;
    // Frame by frame, as from a line, there is seldom anything to clear.
    if (!std::exchange(any_failed_, false)) return;
    failed_.reset();
    sum_failed_.reset();
  }

  // The sum of a frame is tried once, however the stream comes in portions.
  bool intact(std::size_t at, std::size_t length) noexcept {
    if (protocol_.intact({buffer_.data() + at, length})) return true;
    sum_failed_.set(at);
    fail(at);
    return false;
  }

  // For an intact frame and those inside it: what would have come out had the bytes come one by one.
  Place ends_first(Place outer) noexcept {
    std::size_t end = outer.at + outer.length;
    Place first = outer;
    for (std::size_t at = candidate(outer.at + 1, end); at < end; at = candidate(at + 1, end)) {
      if (failed_.test(at)) continue;
      const Announced announced = protocol_.at({buffer_.data() + at, end - at});
      if (announced.is != Announced::Is::frame || at + announced.length >= end) continue;
      if (!intact(at, announced.length)) continue;
      first = {at, announced.length};
      end = at + announced.length;
    }
    return first;
  }

  // The first position from `at` on that may hold a header; `end` for none before it.
  [[nodiscard]] std::size_t candidate(std::size_t at, std::size_t end) const noexcept {
    if constexpr (requires { Protocol::kFirst; }) {
      const auto* const found =
          static_cast<const std::uint8_t*>(std::memchr(buffer_.data() + at, Protocol::kFirst, end - at));
      return found != nullptr ? static_cast<std::size_t>(found - buffer_.data()) : end;
    } else {
      return at;
    }
  }

  void accept(std::size_t at, std::size_t length) noexcept {
    pass_over(at);
    counters_.bytes_framed += length;
    ++counters_.intact;
  }

  // Large against a frame, so that the remainder is moved to the front seldom.
  static constexpr std::size_t kBuffer = 2 * Protocol::kLongest + 4096;
  Protocol protocol_;
  std::array<std::uint8_t, kBuffer> buffer_{};
  std::bitset<kBuffer> failed_;      // positions known to begin no frame
  std::bitset<kBuffer> sum_failed_;  // those of them with a header
  bool any_failed_ = false;
  std::size_t begin_ = 0, end_ = 0;
  FrameCounters counters_;
};

}  // namespace ifog::framing
