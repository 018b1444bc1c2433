#include "drivers/plugins/stim300/datagram.h"

#include <boost/crc.hpp>

#include "drivers/plugins/framing/fields.h"

namespace ifog::stim300 {
namespace {

using Reader = framing::FieldReader<std::endian::big>;
using Writer = framing::FieldWriter<std::endian::big>;

constexpr std::size_t kCrcLength = 4;

// Table 5-21, then those with AUX.
constexpr std::array<Content, 24> kContents{
    {{0x90, false, false, false, false, false}, {0x91, true, false, false, false, false},
     {0x92, false, true, false, false, false},  {0x93, true, true, false, false, false},
     {0x94, false, false, true, false, false},  {0xA5, true, false, true, false, false},
     {0xA6, false, true, true, false, false},   {0xA7, true, true, true, false, false},
     {0xF0, false, false, false, true, false},  {0xF1, true, false, false, true, false},
     {0xF2, false, true, false, true, false},   {0xF3, true, true, false, true, false},
     {0xF4, false, false, true, true, false},   {0xF5, true, false, true, true, false},
     {0xF6, false, true, true, true, false},    {0xF7, true, true, true, true, false},
     {0x98, false, false, false, false, true},  {0x99, true, false, false, false, true},
     {0x9A, false, true, false, false, true},   {0x9B, true, true, false, false, true},
     {0x9C, false, false, true, false, true},   {0xAD, true, false, true, false, true},
     {0xAE, false, true, true, false, true},    {0xAF, true, true, true, false, true}}};

// Each triad of the datagram in its order, with the bytes of a count.
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

std::uint32_t crc_of(std::span<const std::uint8_t> bytes) noexcept {
  boost::crc_optimal<32, 0x04C11DB7U, 0xFFFFFFFFU, 0U, false, false> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  for (std::size_t n = bytes.size(); n % 4 != 0; ++n) crc.process_byte(0);
  return crc.checksum();
}

}  // namespace

std::optional<Content> content_of(std::uint8_t identifier) noexcept {
  for (const Content& content : kContents)
    if (content.identifier == identifier) return content;
  return std::nullopt;
}

std::size_t length_of(const Content& content) noexcept {
  const std::size_t triads = 1U + (content.acceleration ? 1U : 0U) + (content.inclination ? 1U : 0U);
  return 1 + triads * (10 + (content.temperature ? 7U : 0U)) + (content.pps || content.aux ? 4U : 0U) + 3 +
         kCrcLength;
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

std::size_t pack(const Datagram& datagram, std::span<std::uint8_t, kLongestDatagram> bytes) noexcept {
  const Content& content = datagram.content;
  Writer out(bytes.data());
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
  out.number(crc_of(bytes.first(length - kCrcLength)), 4);
  return length;
}

bool crc_fits(std::span<const std::uint8_t> datagram) noexcept {
  const std::size_t covered = datagram.size() - kCrcLength;
  return crc_of(datagram.first(covered)) == Reader(datagram.data() + covered).number(4);
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
