// SPDX-License-Identifier: Apache-2.0
// Fields of frames in either byte order: reading and writing, numbers limited to a field, checksums, time stamps.
#pragma once

#include <bit>
#include <boost/crc.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

namespace ifog::framing {

// Reads from bytes whose number has been checked.
template <std::endian kOrder>
class FieldReader {
 public:
  explicit FieldReader(const std::uint8_t* at) : at_(at) {}
  // Unsigned number of up to four bytes.
  std::uint32_t number(unsigned bytes) {
    std::uint32_t out = 0;
    for (unsigned i = 0; i < bytes; ++i)
      out |= std::uint32_t{at_[i]} << 8U * (kOrder == std::endian::big ? bytes - 1 - i : i);
    at_ += bytes;
    return out;
  }
  // Two's complement number.
  std::int32_t whole(unsigned bytes) {
    const unsigned unused = 32U - 8U * bytes;
    return std::bit_cast<std::int32_t>(number(bytes) << unused) >> unused;
  }
  float real() { return std::bit_cast<float>(number(4)); }
  void skip(std::size_t bytes) { at_ += bytes; }

 private:
  const std::uint8_t* at_;
};

// Writes into a frame's bytes. Throws std::length_error if the field does not fit.
template <std::endian kOrder>
class FieldWriter {
 public:
  explicit FieldWriter(std::span<std::uint8_t> room) : room_(room) {}
  // The lowest bytes of the value.
  void number(std::uint32_t value, unsigned bytes) {
    if (bytes > room_.size()) throw std::length_error("the frame has no room for what is to go into it");
    for (unsigned i = 0; i < bytes; ++i)
      room_[i] = static_cast<std::uint8_t>(value >> 8U * (kOrder == std::endian::big ? bytes - 1 - i : i));
    room_ = room_.subspan(bytes);
  }
  void whole(std::int32_t value, unsigned bytes) { number(std::bit_cast<std::uint32_t>(value), bytes); }
  void real(float value) { number(std::bit_cast<std::uint32_t>(value), 4); }

 private:
  std::span<std::uint8_t> room_;
};

// CRC-32/MPEG-2 of the bytes and of zeros that make them a multiple of `block`.
[[nodiscard]] inline std::uint32_t crc32_mpeg2(std::span<const std::uint8_t> bytes, std::size_t block = 1) {
  boost::crc_optimal<32, 0x04C11DB7U, 0xFFFFFFFFU, 0U, false, false> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  for (std::size_t n = bytes.size(); n % block != 0; ++n) crc.process_byte(0);
  return crc.checksum();
}

// Nearest count in two's complement of `bits`. Throws std::invalid_argument if out of range.
inline std::int32_t count_of(double value, unsigned bits, const std::string& what) {
  const double most = std::ldexp(1.0, static_cast<int>(bits) - 1);
  const double count = std::round(value);
  if (!(count >= -most && count < most))
    throw std::invalid_argument(what + " is " + std::to_string(value) + " counts, expected what " +
                                std::to_string(bits) + " bits hold");
  return static_cast<std::int32_t>(count);
}

// Throws std::invalid_argument for a number too large; non-finite values are kept.
inline float float_of(double value, const std::string& what) {
  if (std::isfinite(value) && std::abs(value) > static_cast<double>(std::numeric_limits<float>::max()))
    throw std::invalid_argument(what + " is " + std::to_string(value) +
                                ", expected what a 32-bit float holds");
  return static_cast<float>(value);
}

// Time stamp in ticks.
class Stamp {
 public:
  // tick_ns: nanoseconds per tick.
  explicit constexpr Stamp(std::int64_t tick_ns) : tick_ns_(tick_ns) {}
  [[nodiscard]] constexpr std::int64_t time_ns(std::int64_t ticks) const noexcept { return ticks * tick_ns_; }
  // Stamp that a device sends at this time, rolling over after `modulus` ticks. Times before the origin stay
  // in order.
  [[nodiscard]] std::uint32_t stamp_at(std::int64_t time_ns, std::int64_t modulus) const noexcept {
    const std::int64_t ticks = time_ns / tick_ns_ - (time_ns % tick_ns_ < 0 ? 1 : 0);
    const std::int64_t stamp = ticks % modulus;
    return static_cast<std::uint32_t>(stamp < 0 ? stamp + modulus : stamp);
  }

 private:
  std::int64_t tick_ns_;
};

}  // namespace ifog::framing
