// SPDX-License-Identifier: Apache-2.0
// IMU messages of the SBG Systems sbgECom protocol. Little-endian. Source: SBG Systems, sbgECom binary
// protocol and binary messages (firmware reference manual), "Standard Frame", "CRC Definition",
// SBG_ECOM_LOG_IMU_DATA (03), SBG_ECOM_LOG_IMU_SHORT (44).
//
//   FF 5A, message, class, uint16 length of the data, data, CRC, 33
//
// The CRC has the polynomial 0x8408 (0x1021 reflected), initial value 0, over message, class, length and
// data.
//
//   IMU_SHORT, 32 bytes: uint32 time stamp in µs, uint16 status, three int32 accelerations, three int32
//   rates, int16 temperature, in counts
//   IMU_DATA, 58 bytes:  time stamp and status likewise, then floats: three accelerations (m/s²), three rates
//   (rad/s), temperature (°C), three velocity and three angle increments over the interval, divided by it
//   (m/s², rad/s)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/plugins/framing/frame_finder.h"

namespace ifog::sbgecom {

inline constexpr std::uint8_t kImuData = 3, kImuShort = 44;  // of class 0
inline constexpr std::size_t kImuDataLength = 58, kImuShortLength = 32;
inline constexpr std::size_t kHeader = 6, kTrailer = 3,
                             kLongestImuFrame = kHeader + kImuDataLength + kTrailer;
inline constexpr std::size_t kMostData = 4086;

// Status bits of both messages.
inline constexpr std::uint16_t kComOk = 0x001, kImuOk = 0x002, kAccelerationOk = 0x004, kGyroOk = 0x020,
                               kAccelerationsInRange = 0x100, kGyrosInRange = 0x200;
inline constexpr std::uint16_t kHighScale = 0x400;  // IMU_SHORT only: of the rates

struct Imu {
  std::uint8_t message = kImuShort;
  std::uint32_t time_stamp_us = 0;
  std::uint16_t status = 0;
  std::array<double, 3> acceleration_mps2{}, rate_radps{};  // mean over the interval
  double temperature_degC = 0.0;
};

// Reads an IMU message from an intact frame; false: it is another message.
bool unpack(std::span<const std::uint8_t> frame, Imu& imu) noexcept;
// Returns the frame's length. IMU_SHORT uses the scale that its rates need, with the status bit. Throws
// std::invalid_argument for values that do not fit.
std::size_t pack(const Imu& imu, std::span<std::uint8_t, kLongestImuFrame> out);

// CRC-16/KERMIT.
std::uint16_t crc16(std::span<const std::uint8_t> bytes) noexcept;

// For the finder of intact frames.
struct Protocol {
  static constexpr std::size_t kLongest = kHeader + kMostData + kTrailer;
  static constexpr std::uint8_t kFirst = 0xFF;

  [[nodiscard]] static framing::Announced at(std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] static bool intact(std::span<const std::uint8_t> frame) noexcept;
};

}  // namespace ifog::sbgecom
