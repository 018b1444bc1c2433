// SPDX-License-Identifier: Apache-2.0
// The samples that a driver makes of bytes, bytes as manuals print them, their check, and what a driver says of settings
// that it refuses.
#pragma once

#include "drivers/host/driver_instance.h"
#include "tests/unit/test.h"

namespace ifog {

inline std::vector<ifog_sample> decoded(DriverInstance& driver, std::span<const std::uint8_t> bytes,
                                        std::int64_t arrival_ns = 42, std::size_t portion = 0) {
  std::vector<ifog_sample> samples;
  const std::size_t step = portion == 0 ? std::max<std::size_t>(bytes.size(), 1) : portion;
  for (std::size_t at = 0; at < bytes.size(); at += step)
    driver.decode_bytes(bytes.subspan(at, std::min(step, bytes.size() - at)), arrival_ns,
                        [&](const ifog_sample& sample) { samples.push_back(sample); });
  return samples;
}

inline std::vector<ifog_sample> decoded(DriverInstance& driver, const std::string& text,
                                        std::size_t portion = 0) {
  return decoded(driver, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, 42, portion);
}

inline std::string refusal(const std::string& driver, const DriverSettings& settings,
                           const std::vector<std::string>& folders = plugin_folders()) {
  return test::refusal([&] { make_driver(driver, settings, folders); });
}

// The sample of bytes that are one.
inline ifog_sample one_sample(DriverInstance& driver, std::span<const std::uint8_t> bytes) {
  const std::vector<ifog_sample> samples = decoded(driver, bytes);
  EXPECT_EQ(samples.size(), 1U);
  return samples.empty() ? ifog_sample{} : samples[0];
}

// A sample's values or channels from the first on; NaN where none is expected. within: 0: to the last digits.
inline void expect_numbers(const double* found, std::initializer_list<double> expected, double within = 0.0) {
  for (const double each : expected) {
    const double number = *found++;
    if (std::isnan(each))
      EXPECT_TRUE(std::isnan(number)) << number;
    else if (within > 0.0)
      EXPECT_NEAR(number, each, within);
    else
      EXPECT_DOUBLE_EQ(number, each);
  }
}

// Bytes as manuals print them: "FE81 FF55", capital hexadecimal digits, spaces anywhere.
inline std::vector<std::uint8_t> hex_bytes(std::string digits) {
  std::erase(digits, ' ');
  std::vector<std::uint8_t> bytes(digits.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    std::from_chars(&digits[2 * i], &digits[2 * i] + 2, bytes[i], 16);
  return bytes;
}

// CRC-32/MPEG-2 as its definition reads, one bit at a time: no table, nothing shared with the code under test.
inline std::uint32_t long_division(std::span<const std::uint8_t> bytes) {
  std::uint32_t remainder = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes)
    for (int bit = 7; bit >= 0; --bit) {
      const bool in = ((byte >> bit) & 1) != 0, out = (remainder >> 31U) != 0;
      remainder <<= 1U;
      if (in != out) remainder ^= 0x04C11DB7U;
    }
  return remainder;
}

// Checksum of the bytes and as many zeros as make them a multiple of `block` bytes, which are not appended.
inline void append_crc32(std::vector<std::uint8_t>& bytes, std::size_t block = 1) {
  std::vector<std::uint8_t> covered = bytes;
  while (covered.size() % block != 0) covered.push_back(0);
  const std::uint32_t crc = long_division(covered);
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(crc >> shift));
}

}  // namespace ifog
