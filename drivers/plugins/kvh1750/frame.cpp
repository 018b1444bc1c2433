// SPDX-License-Identifier: Apache-2.0
#include "drivers/plugins/kvh1750/frame.h"

#include <algorithm>
#include <bit>

#include "drivers/plugins/framing/fields.h"

namespace ifog::kvh {
namespace {

constexpr std::size_t kCrcLength = 4;

using Reader = framing::FieldReader<std::endian::big>;
using Writer = framing::FieldWriter<std::endian::big>;

}  // namespace

Frame unpack(std::span<const std::uint8_t> frame) noexcept {
  Reader in(frame.data() + kHeaderLength);
  Frame out;
  const auto format = static_cast<Format>(frame[kHeaderLength - 1]);
  out.format = format;
  for (float& value : out.gyro) value = in.real();
  for (float& value : out.accelerometer) value = in.real();
  if (format == Format::kB) out.time_stamp_us = in.number(4);
  if (format == Format::kC) out.slow = in.real();
  out.status = static_cast<std::uint8_t>(in.number(1));
  out.sequence = static_cast<std::uint8_t>(in.number(1));
  if (format != Format::kC) out.temperature = static_cast<std::int16_t>(in.whole(2));
  return out;
}

std::size_t pack(const Frame& frame, std::span<std::uint8_t, kLongestFrame> bytes) {
  Writer out(bytes);
  out.number(0xFE81FF00U | static_cast<std::uint32_t>(frame.format), 4);
  for (const float value : frame.gyro) out.real(value);
  for (const float value : frame.accelerometer) out.real(value);
  if (frame.format == Format::kB) out.number(frame.time_stamp_us, 4);
  if (frame.format == Format::kC) out.real(frame.slow);
  out.number(frame.status, 1);
  out.number(frame.sequence, 1);
  if (frame.format != Format::kC) out.whole(frame.temperature, 2);
  const std::size_t length = length_of(frame.format);
  out.number(framing::crc32_mpeg2(bytes.first(length - kCrcLength)), 4);
  return length;
}

framing::Announced Protocol::at(std::span<const std::uint8_t> bytes) noexcept {
  using Is = framing::Announced::Is;
  constexpr std::array<std::uint8_t, kHeaderLength - 1> kBegin{kFirst, 0x81, 0xFF};
  const std::size_t n = std::min(bytes.size(), kBegin.size());
  if (!std::equal(kBegin.begin(), kBegin.begin() + n, bytes.begin())) return {};
  if (bytes.size() < kHeaderLength) return {Is::unknown_yet};
  const std::uint8_t last = bytes[kHeaderLength - 1];
  return last >= 0x55 && last <= 0x57 ? framing::Announced{Is::frame, length_of(static_cast<Format>(last))}
                                      : framing::Announced{};
}

bool Protocol::intact(std::span<const std::uint8_t> frame) noexcept {
  const std::size_t covered = frame.size() - kCrcLength;
  return framing::crc32_mpeg2(frame.first(covered)) == Reader(frame.data() + covered).number(4);
}

}  // namespace ifog::kvh
