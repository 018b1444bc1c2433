// SPDX-License-Identifier: Apache-2.0
#include "drivers/plugins/stim300/datagram.h"

#include "drivers/plugins/framing/fields.h"

namespace ifog::stim300 {
namespace {

using Reader = framing::FieldReader<std::endian::big>;
using Writer = framing::FieldWriter<std::endian::big>;

// Calls use for each triad of the datagram in order, with the bytes per count.
template <typename Fields, typename Use>
void each_triad(const Content& content, Fields& fields, Use&& use) {
  use(fields.gyro, 3U);
  if (content.acceleration) use(fields.acceleration, 3U);
  if (content.inclination) use(fields.inclination, 3U);
  if (!content.temperature) return;
  use(fields.gyro_temperature, 2U);
  if (content.acceleration) use(fields.acceleration_temperature, 2U);
  if (content.inclination) use(fields.inclination_temperature, 2U);
}

constexpr std::size_t kWord = 4;  // bytes

bool crc_fits(std::span<const std::uint8_t> datagram) noexcept {
  const std::size_t covered = datagram.size() - kCrcLength;
  return framing::crc32_mpeg2(datagram.first(covered), kWord) == Reader(datagram.data() + covered).number(4);
}

}  // namespace

std::optional<Content> content_of(std::uint8_t identifier) noexcept {
  for (const Content& content : kContents)
    if (content.identifier == identifier) return content;
  return std::nullopt;
}

Datagram unpack(const Content& content, std::span<const std::uint8_t> bytes) noexcept {
  Reader in(bytes.data() + 1);
  Datagram out;
  out.content = content;
  each_triad(content, out, [&](Triad& triad, unsigned width) {
    for (std::int32_t& count : triad.count) count = in.whole(width);
    triad.status = static_cast<std::uint8_t>(in.number(1));
  });
  if (content.pps || content.aux) {
    out.extra = in.whole(3);
    out.extra_status = static_cast<std::uint8_t>(in.number(1));
  }
  out.counter = static_cast<std::uint8_t>(in.number(1));
  out.latency_us = static_cast<std::uint16_t>(in.number(2));
  return out;
}

std::size_t pack(const Datagram& datagram, std::span<std::uint8_t, kLongestDatagram> bytes) {
  const Content& content = datagram.content;
  Writer out(bytes);
  out.number(content.identifier, 1);
  each_triad(content, datagram, [&](const Triad& triad, unsigned width) {
    for (const std::int32_t count : triad.count) out.whole(count, width);
    out.number(triad.status, 1);
  });
  if (content.pps || content.aux) {
    out.whole(datagram.extra, 3);
    out.number(datagram.extra_status, 1);
  }
  out.number(datagram.counter, 1);
  out.number(datagram.latency_us, 2);
  const std::size_t length = length_of(content);
  out.number(framing::crc32_mpeg2(bytes.first(length - kCrcLength), kWord), 4);
  return length;
}

framing::Announced Protocol::at(std::span<const std::uint8_t> bytes) const noexcept {
  const auto content = content_of(bytes[0]);
  if (!content) return {};
  return {framing::Announced::Is::frame, length_of(*content) + (terminated ? kTermination : 0)};
}

bool Protocol::intact(std::span<const std::uint8_t> frame) const noexcept {
  if (!terminated) return crc_fits(frame);
  const std::size_t length = frame.size() - kTermination;
  return frame[length] == '\r' && frame[length + 1] == '\n' && crc_fits(frame.first(length));
}

}  // namespace ifog::stim300
