// SPDX-License-Identifier: Apache-2.0
// Finds intact frames in a byte stream with any other bytes between, before or inside them.
//
// At each position with a header, the frame's bytes are awaited and its checksum is tested. A failed frame is
// skipped by one byte, so a frame that starts inside a damaged one is found. While a frame is incomplete
// later positions are tested too, so a false header delays nothing: an intact frame is delivered with its
// last byte. Drawback: a complete frame inside another's payload is accepted and the outer one lost; no
// device sends that. Of overlapping frames the one that ends first is accepted, even if all bytes arrive at
// once, so the result does not depend on portions.
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

// Information of a header.
struct Announced {
  enum class Is { none, unknown_yet, frame };
  Is is = Is::none;        // unknown_yet: the bytes so far may begin a header
  std::size_t length = 0;  // of the whole frame
};

// A Protocol has
//   static constexpr std::size_t kLongest;                         of a frame, bytes
//   Announced at(std::span<const std::uint8_t>) const noexcept;    of the header there; at least a byte
//   bool intact(std::span<const std::uint8_t>) const noexcept;     checksum of a whole frame
// and, if every header starts with the same byte,
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

  // Discards an incomplete frame; its bytes count as skipped.
  void reset() noexcept {
    pass_over(end_);
    forget();
  }

  // Counters for the host. unused: intact frames that the driver ignores by configuration.
  void copy_to(ifog_driver_counters& out, std::uint64_t unused = 0) const noexcept {
    out = counters_;
    out.frames_good -= unused;
    out.frames_format = unused;
    out.bytes_pending = waiting();
  }
  // A wrong checksum is not counted within an intact frame, whose payload may look like a header.
  [[nodiscard]] const ifog_driver_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t waiting() const { return end_ - begin_; }  // bytes that may begin a frame

 private:
  struct Place {
    std::size_t at, length;
  };

  std::size_t take(std::span<const std::uint8_t> bytes) noexcept {
    // next() leaves less than a frame, so there is always enough space after this.
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

  // Next intact frame; without one, skips bytes that cannot begin a frame.
  std::optional<Place> next() noexcept {
    std::size_t keep = end_;  // first position that may begin a frame
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

  // Unconsumed bytes before it are part of no intact frame.
  void pass_over(std::size_t upto) noexcept {
    counters_.bytes_skipped += upto - begin_;
    if (!any_failed_) return;
    for (std::size_t at = begin_; at < upto; ++at) counters_.frames_crc += sum_failed_.test(at) ? 1 : 0;
  }
  void fail(std::size_t at) noexcept {
    failed_.set(at);
    any_failed_ = true;
  }
  void forget() noexcept {
    begin_ = end_ = 0;
    // If the bytes come frame by frame there is seldom anything to clear.
    if (!std::exchange(any_failed_, false)) return;
    failed_.reset();
    sum_failed_.reset();
  }

  // A frame's checksum is computed once, for any portions.
  bool intact(std::size_t at, std::size_t length) noexcept {
    if (protocol_.intact({buffer_.data() + at, length})) return true;
    sum_failed_.set(at);
    fail(at);
    return false;
  }

  // For an intact frame and those inside it: the frame that would have been found byte by byte.
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

  // First position from `at` on that may hold a header; `end` if there is none.
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
    ++counters_.frames_good;
  }

  // Large compared with a frame, so the remainder is rarely moved.
  static constexpr std::size_t kBuffer = 2 * Protocol::kLongest + 4096;
  Protocol protocol_;
  std::array<std::uint8_t, kBuffer> buffer_{};
  std::bitset<kBuffer> failed_;      // positions that begin no frame
  std::bitset<kBuffer> sum_failed_;  // of these, positions with a header
  bool any_failed_ = false;
  std::size_t begin_ = 0, end_ = 0;
  ifog_driver_counters counters_{};
};

}  // namespace ifog::framing
