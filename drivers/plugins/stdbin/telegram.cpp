// SPDX-License-Identifier: Apache-2.0
#include "drivers/plugins/stdbin/telegram.h"

#include <numeric>

#include "drivers/plugins/framing/fields.h"

namespace ifog::stdbin {
namespace {

using Reader = framing::FieldReader<std::endian::big>;
using Writer = framing::FieldWriter<std::endian::big>;

// Lengths by bit of the mask; 0: not published.
using Lengths = std::array<std::uint8_t, 32>;
constexpr Lengths kNavigation{12, 12, 16, 8,  12, 12, 12, 21, 16, 12, 12, 8,  8,  4,  8,  16,
                              12, 4,  4,  12, 4,  12, 12, 12, 8,  12, 16, 12, 12, 12, 12, 0};
constexpr Lengths kExtended{12, 12, 12, 12, 12, 21, 16};
constexpr Lengths kExternal{5,  46, 46, 46, 13, 13, 49, 49, 49, 12, 37, 33, 8,  8,
                            41, 41, 41, 41, 9,  9,  9,  37, 33, 0,  16, 17, 17, 12};

constexpr unsigned kRate = 5, kSensorStatus = 14, kTemperatures = 25, kRawAcceleration = 28;  // navigation
constexpr unsigned kRawRate = 2;                                                              // extended

struct Header {
  std::uint8_t version = 0;
  std::uint32_t navigation = 0, extended = 0, external = 0;
  std::size_t navigation_length = 0;  // version 4 and later
  std::size_t length = 0;
  std::uint32_t validity_100us = 0, counter = 0;
};

constexpr std::size_t header_length(unsigned version) { return version == 2 ? 21 : version == 3 ? 25 : 27; }

Header read_header(const std::uint8_t* bytes) noexcept {
  Reader in(bytes + 2);
  Header out;
  out.version = static_cast<std::uint8_t>(in.number(1));
  out.navigation = in.number(4);
  if (out.version > 2) out.extended = in.number(4);
  out.external = in.number(4);
  if (out.version > 3) out.navigation_length = in.number(2);
  out.length = in.number(2);
  out.validity_100us = in.number(4);
  out.counter = in.number(4);
  return out;
}

struct Sum {
  std::size_t length = 0;
  bool exact = true;  // the length of every bit is known
};

Sum sum_of(std::uint32_t mask, const Lengths& lengths) noexcept {
  Sum out;
  for (unsigned bit = 0; bit < 32; ++bit) {
    if ((mask >> bit & 1U) == 0) continue;
    out.length += lengths[bit];
    out.exact = out.exact && lengths[bit] != 0;
  }
  return out;
}

bool agrees(std::size_t stated, std::size_t length, bool exact) {
  return exact ? stated == length : stated >= length;
}

// Offset of a block after the header; nullopt if it is absent or undeterminable.
std::optional<std::size_t> place_of(unsigned wanted, std::uint32_t mask, const Lengths& lengths) noexcept {
  if ((mask >> wanted & 1U) == 0) return std::nullopt;
  const Sum before = sum_of(mask & ((1U << wanted) - 1U), lengths);
  if (!before.exact) return std::nullopt;
  return before.length;
}

std::uint32_t sum_of_bytes(std::span<const std::uint8_t> bytes) noexcept {
  return std::accumulate(bytes.begin(), bytes.end(), std::uint32_t{0});
}

std::optional<Triad> triad_at(std::optional<std::size_t> place, const std::uint8_t* blocks) noexcept {
  if (!place) return std::nullopt;
  Reader in(blocks + *place);
  Triad out{};
  for (float& each : out) each = in.real();
  return out;
}

}  // namespace

Telegram unpack(std::span<const std::uint8_t> bytes) noexcept {
  const Header header = read_header(bytes.data());
  const std::uint8_t* const blocks = bytes.data() + header_length(header.version);
  const auto navigation = [&](unsigned bit) { return place_of(bit, header.navigation, kNavigation); };
  Telegram out;
  out.version = header.version;
  out.validity_100us = header.validity_100us;
  out.counter = header.counter;
  out.rate_degps = triad_at(navigation(kRate), blocks);
  out.temperature_degC = triad_at(navigation(kTemperatures), blocks);
  out.raw_acceleration_mps2 = triad_at(navigation(kRawAcceleration), blocks);
  if (const auto place = navigation(kSensorStatus)) out.sensor_status = Reader(blocks + *place).number(4);
  const Sum before = sum_of(header.navigation, kNavigation);
  if (before.exact)
    out.raw_rate_degps = triad_at(place_of(kRawRate, header.extended, kExtended), blocks + before.length);
  return out;
}

std::size_t pack(const Telegram& telegram, std::span<std::uint8_t, kLongestTelegram> bytes) {
  const bool extended = telegram.version > 2 && telegram.raw_rate_degps.has_value();
  std::uint32_t mask = 0;
  const auto mark = [&](bool there, unsigned bit) { mask |= there ? 1U << bit : 0U; };
  mark(telegram.rate_degps.has_value(), kRate);
  mark(telegram.sensor_status.has_value(), kSensorStatus);
  mark(telegram.temperature_degC.has_value(), kTemperatures);
  mark(telegram.raw_acceleration_mps2.has_value(), kRawAcceleration);
  const std::size_t blocks = sum_of(mask, kNavigation).length + (extended ? kExtended[kRawRate] : 0U);
  const std::size_t length = header_length(telegram.version) + blocks + kChecksum;
  Writer out(bytes);
  out.number('I', 1);
  out.number('X', 1);
  out.number(telegram.version, 1);
  out.number(mask, 4);
  if (telegram.version > 2) out.number(extended ? 1U << kRawRate : 0U, 4);
  out.number(0, 4);
  if (telegram.version > 3) out.number(static_cast<std::uint32_t>(blocks), 2);
  out.number(static_cast<std::uint32_t>(length), 2);
  out.number(telegram.validity_100us, 4);
  out.number(telegram.counter, 4);
  const auto triad = [&](const std::optional<Triad>& values) {
    if (!values) return;
    for (const float each : *values) out.real(each);
  };
  triad(telegram.rate_degps);
  if (telegram.sensor_status) {
    out.number(*telegram.sensor_status, 4);
    out.number(0, 4);
  }
  triad(telegram.temperature_degC);
  triad(telegram.raw_acceleration_mps2);
  if (extended) triad(telegram.raw_rate_degps);
  out.number(sum_of_bytes(bytes.first(length - kChecksum)), 4);
  return length;
}

framing::Announced Protocol::at(std::span<const std::uint8_t> bytes) noexcept {
  using Is = framing::Announced::Is;
  if (bytes[0] != 'I' || (bytes.size() > 1 && bytes[1] != 'X')) return {};
  if (bytes.size() > 2 && (bytes[2] < 2 || bytes[2] > 5)) return {};
  if (bytes.size() < 3 || bytes.size() < header_length(bytes[2])) return {Is::unknown_yet};
  const Header header = read_header(bytes.data());
  const Sum navigation = sum_of(header.navigation, kNavigation);
  const Sum extended = sum_of(header.extended, kExtended);
  const Sum external = sum_of(header.external, kExternal);
  const std::size_t inner = navigation.length + extended.length;
  const bool inner_exact = navigation.exact && extended.exact;
  if (header.version > 3 && !agrees(header.navigation_length, inner, inner_exact)) return {};
  const std::size_t whole = header_length(header.version) + inner + external.length + kChecksum;
  if (header.length > kLongestTelegram || !agrees(header.length, whole, inner_exact && external.exact))
    return {};
  return {Is::frame, header.length};
}

bool Protocol::intact(std::span<const std::uint8_t> telegram) noexcept {
  const std::size_t covered = telegram.size() - kChecksum;
  return sum_of_bytes(telegram.first(covered)) == Reader(telegram.data() + covered).number(4);
}

}  // namespace ifog::stdbin
