// SPDX-License-Identifier: Apache-2.0
#include "drivers/plugins/sbgecom/message.h"

#include <algorithm>
#include <boost/crc.hpp>
#include <cmath>

#include "drivers/plugins/framing/fields.h"

namespace ifog::sbgecom {
namespace {

using Reader = framing::FieldReader<std::endian::little>;
using Writer = framing::FieldWriter<std::endian::little>;

constexpr std::array<std::uint8_t, 2> kSync{0xFF, 0x5A};
constexpr std::uint8_t kEnd = 0x33;

// Counts of IMU_SHORT.
constexpr double kAccelerationCounts = 1048576.0;                         // per m/s²
constexpr double kRateCounts = 67108864.0, kHighRateCounts = 12304174.0;  // per rad/s
constexpr double kTemperatureCounts = 256.0;                              // per °C
constexpr double kMostAtStandardScale_radps = 0x1p31 / kRateCounts;       // 1833 °/s

// Frame classes that a device sends; the highest bit marks a page of a large frame.
bool is_class(std::uint8_t value) {
  const unsigned kind = value & 0x7FU;
  return kind <= 5 || kind == 0x10;
}

void unpack_short(Reader& in, Imu& imu) noexcept {
  for (double& each : imu.acceleration_mps2) each = in.whole(4) / kAccelerationCounts;
  const double counts = (imu.status & kHighScale) != 0 ? kHighRateCounts : kRateCounts;
  for (double& each : imu.rate_radps) each = in.whole(4) / counts;
  imu.temperature_degC = in.whole(2) / kTemperatureCounts;
}

void unpack_data(Reader& in, Imu& imu) noexcept {
  in.skip(24);  // instantaneous rates and accelerations
  imu.temperature_degC = static_cast<double>(in.real());
  for (double& each : imu.acceleration_mps2) each = static_cast<double>(in.real());
  for (double& each : imu.rate_radps) each = static_cast<double>(in.real());
}

void pack_short(const Imu& imu, Writer& out) {
  const double counts = (imu.status & kHighScale) != 0 ? kHighRateCounts : kRateCounts;
  for (const double each : imu.acceleration_mps2)
    out.whole(framing::count_of(each * kAccelerationCounts, 32, "acceleration"), 4);
  for (const double each : imu.rate_radps) out.whole(framing::count_of(each * counts, 32, "rate"), 4);
  out.whole(framing::count_of(imu.temperature_degC * kTemperatureCounts, 16, "temperature"), 2);
}

void pack_data(const Imu& imu, Writer& out) {
  const auto triad = [&](const std::array<double, 3>& values, const char* what) {
    for (const double each : values) out.real(framing::float_of(each, what));
  };
  triad(imu.acceleration_mps2, "acceleration");
  triad(imu.rate_radps, "rate");
  out.real(framing::float_of(imu.temperature_degC, "temperature"));
  triad(imu.acceleration_mps2, "acceleration");
  triad(imu.rate_radps, "rate");
}

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> bytes) noexcept {
  boost::crc_optimal<16, 0x1021, 0, 0, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

bool unpack(std::span<const std::uint8_t> frame, Imu& imu) noexcept {
  // The finder has checked the length of these messages.
  if (frame[3] != 0 || (frame[2] != kImuShort && frame[2] != kImuData)) return false;
  Reader in(frame.data() + kHeader);
  imu.message = frame[2];
  imu.time_stamp_us = in.number(4);
  imu.status = static_cast<std::uint16_t>(in.number(2));
  imu.message == kImuShort ? unpack_short(in, imu) : unpack_data(in, imu);
  return true;
}

std::size_t pack(const Imu& given, std::span<std::uint8_t, kLongestImuFrame> bytes) {
  Imu imu = given;
  const bool brief = imu.message == kImuShort;
  imu.status = static_cast<std::uint16_t>(imu.status & ~kHighScale);
  const bool high = std::ranges::any_of(
      imu.rate_radps, [](double rate) { return std::abs(rate) >= kMostAtStandardScale_radps; });
  if (brief && high) imu.status = static_cast<std::uint16_t>(imu.status | kHighScale);
  const std::size_t length = brief ? kImuShortLength : kImuDataLength;
  Writer out(bytes);
  for (const std::uint8_t each : kSync) out.number(each, 1);
  out.number(imu.message, 1);
  out.number(0, 1);
  out.number(static_cast<std::uint32_t>(length), 2);
  out.number(imu.time_stamp_us, 4);
  out.number(imu.status, 2);
  brief ? pack_short(imu, out) : pack_data(imu, out);
  out.number(crc16(bytes.subspan(kSync.size(), kHeader - kSync.size() + length)), 2);
  out.number(kEnd, 1);
  return kHeader + length + kTrailer;
}

framing::Announced Protocol::at(std::span<const std::uint8_t> bytes) noexcept {
  using Is = framing::Announced::Is;
  const std::size_t n = std::min(bytes.size(), kSync.size());
  if (!std::equal(kSync.begin(), kSync.begin() + static_cast<std::ptrdiff_t>(n), bytes.begin())) return {};
  if (bytes.size() >= 4 && !is_class(bytes[3])) return {};
  if (bytes.size() < kHeader) return {Is::unknown_yet};
  const std::size_t length = bytes[4] | static_cast<std::size_t>(bytes[5]) << 8U;
  const bool log = bytes[3] == 0;
  if (length > kMostData || (log && bytes[2] == kImuShort && length != kImuShortLength) ||
      (log && bytes[2] == kImuData && length != kImuDataLength))
    return {};
  return {Is::frame, kHeader + length + kTrailer};
}

bool Protocol::intact(std::span<const std::uint8_t> frame) noexcept {
  const std::size_t end = frame.size() - kTrailer;
  return frame.back() == kEnd &&
         crc16(frame.subspan(kSync.size(), end - kSync.size())) == Reader(frame.data() + end).number(2);
}

}  // namespace ifog::sbgecom
