#include "drivers/plugins/kvh1750/frame.h"

#include <bit>

#include "drivers/plugins/kvh1750/crc32_mpeg2.h"

namespace ifog::kvh {
namespace {

constexpr std::size_t kCrcLength = 4;

// Walks through the big-endian fields of a frame.
class Reader {
 public:
  explicit Reader(const std::uint8_t* at) : at_(at) {}
  std::uint8_t u8() { return *at_++; }
  std::uint16_t u16() {
    const unsigned high = u8();
    return static_cast<std::uint16_t>(high << 8U | u8());
  }
  std::uint32_t u32() {
    const std::uint32_t high = u16();
    return high << 16U | u16();
  }
  float f32() { return std::bit_cast<float>(u32()); }

 private:
  const std::uint8_t* at_;
};

class Writer {
 public:
  explicit Writer(std::uint8_t* at) : at_(at) {}
  void u8(std::uint8_t value) { *at_++ = value; }
  void u16(std::uint16_t value) {
    u8(static_cast<std::uint8_t>(value >> 8U));
    u8(static_cast<std::uint8_t>(value & 0xFFU));
  }
  void u32(std::uint32_t value) {
    u16(static_cast<std::uint16_t>(value >> 16U));
    u16(static_cast<std::uint16_t>(value & 0xFFFFU));
  }
  void f32(float value) { u32(std::bit_cast<std::uint32_t>(value)); }

 private:
  std::uint8_t* at_;
};

}  // namespace

std::optional<Format> header_at(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes[0] != 0xFE || bytes[1] != 0x81 || bytes[2] != 0xFF || bytes[3] < 0x55 || bytes[3] > 0x57)
    return {};
  return static_cast<Format>(bytes[3]);
}

bool crc_fits(std::span<const std::uint8_t> frame) noexcept {
  const std::size_t covered = frame.size() - kCrcLength;
  return crc32_mpeg2(frame.first(covered)) == Reader(frame.data() + covered).u32();
}

Frame unpack(Format format, std::span<const std::uint8_t> frame) noexcept {
  Reader in(frame.data() + kHeaderLength);
  Frame out;
  out.format = format;
  for (float& value : out.gyro) value = in.f32();
  for (float& value : out.accelerometer) value = in.f32();
  if (format == Format::kB) out.time_stamp_us = in.u32();
  if (format == Format::kC) out.slow = in.f32();
  out.status = in.u8();
  out.sequence = in.u8();
  if (format != Format::kC) out.temperature = static_cast<std::int16_t>(in.u16());
  return out;
}

std::size_t pack(const Frame& frame, std::span<std::uint8_t, kLongestFrame> bytes) noexcept {
  Writer out(bytes.data());
  out.u32(0xFE81FF00U | static_cast<std::uint32_t>(frame.format));
  for (const float value : frame.gyro) out.f32(value);
  for (const float value : frame.accelerometer) out.f32(value);
  if (frame.format == Format::kB) out.u32(frame.time_stamp_us);
  if (frame.format == Format::kC) out.f32(frame.slow);
  out.u8(frame.status);
  out.u8(frame.sequence);
  if (frame.format != Format::kC) out.u16(static_cast<std::uint16_t>(frame.temperature));
  const std::size_t length = length_of(frame.format);
  out.u32(crc32_mpeg2(bytes.first(length - kCrcLength)));
  return length;
}

}  // namespace ifog::kvh
