// SPDX-License-Identifier: Apache-2.0
// A driver to copy. It is built and tested with everything else, so what stands here works.
//
// To make yours, in a folder of its own, out of this tree:
//   1. Copy this file to NAME.cpp and, next to it, write this CMakeLists.txt:
//        cmake_minimum_required(VERSION 3.25)
//        project(my_gyro LANGUAGES CXX)
//        find_package(ifogd REQUIRED)
//        ifogd_add_plugin(NAME SOURCES NAME.cpp)
//      The package comes with `cmake --install BUILD_OF_IFOGD --component development`; the function makes
//      NAME.so, and `cmake --install` of your build puts it where ifogd looks.
//   2. Change what is marked STEP 1 … STEP 6 below.
//   3. `IFOG_PLUGIN_PATH=BUILD ifog drivers NAME` shows that it loads, and its options; then
//      `ifog convert RECORDING.bin OUT.csv --driver NAME` decodes what you recorded from the device
//      (`cat /dev/ttyUSB0 >RECORDING.bin`), and in ifogd.toml `driver = "NAME"` does so live.
//
// A driver is a pure function from bytes to samples. It opens no device, reads no clock and waits for
// nothing: the daemon does that. After `create` it must not allocate, lock, log or throw: decoding is in the
// daemon's real-time path. ifog/driver.h says what each function must do; ifog/byte_driver.h makes its table
// of functions from a class; ifog/options.h helps to read the options.
//
// The device here is invented. It sends 8 bytes a sample, 200 times a second at 115200 baud:
//   0xA5, counter (0 … 255), rate (int32 big-endian, µdeg/s), temperature (int8, °C), sum of the seven bytes

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>

#include "ifog/byte_driver.h"
#include "ifog/driver.h"
#include "ifog/options.h"

namespace {

// STEP 1: the format's constants, with where they come from (manual, page).
constexpr std::uint8_t kStart = 0xA5;
constexpr std::size_t kFrame = 8;
constexpr double kRadPerUnit = 1e-6 * std::numbers::pi / 180.0;

// STEP 2: what the bytes do not say must be an option: units, output mode, data rate. The host refuses keys
// that are not listed and fills in the defaults; nullptr as default makes the option required.
constexpr std::array kOptions{
    ifog_option{"rate_hz", "a number > 0, at most 10000", "200", "data rate set in the device"},
    ifog_option{"mounted", "upright | inverted", "upright", "inverted turns the sign of the rate"},
    ifog_option{nullptr, nullptr, nullptr, nullptr}};

class Driver {
 public:
  // Throws, with the key, its value and what was expected, when an option is no good: see ifog/options.h.
  explicit Driver(const ifog::plugin::Options& options)
      : rate_hz_(options.number("rate_hz", 1e-3, 1e4, "a number > 0, at most 10000")),
        sign_(options.choice<double>("mounted", {{"upright", 1.0}, {"inverted", -1.0}})) {}

  // STEP 3: what a configured device delivers.
  void describe(ifog_description& out) const {
    out = {};
    out.kind = IFOG_RATE;  // IFOG_DELTA_ANGLE or IFOG_ANGLE if that is what it sends
    out.axes = 1;          // more: plugin::set_name(out.axis[0], "x"), …
    out.sequence_modulus = 256;
    out.nominal_rate_hz = rate_hz_;
    out.full_scale[0] = 35.0;  // rad/s, from the data sheet; 0 if it says nothing
    out.baud = 115200;
    out.environments = 1;
    ifog::plugin::set_name(out.environment[0], "temperature_degC");  // the name a capture's column would have
  }

  // STEP 4: bytes come in any portions, so a frame may be split over two calls, and what is not a frame must
  // be passed over. Two rules keep every intact frame: wait in a buffer of fixed size until a frame is
  // complete. If its check fails, drop one byte, not the whole frame, because the next frame may begin
  // inside.
  void decode(std::span<const std::uint8_t> bytes, std::int64_t arrival_ns, ifog_emit_sample emit,
              void* sink) noexcept {
    for (const std::uint8_t byte : bytes) {
      buffer_[filled_++] = byte;
      while (filled_ != 0 && buffer_[0] != kStart) drop_one();
      if (filled_ < kFrame) continue;
      std::uint8_t sum = 0;
      for (std::size_t k = 0; k + 1 < kFrame; ++k) sum = static_cast<std::uint8_t>(sum + buffer_[k]);
      if (sum != buffer_[kFrame - 1]) {
        ++counters_.frames_crc;
        drop_one();
        while (filled_ != 0 && buffer_[0] != kStart) drop_one();
        continue;
      }
      const ifog_sample sample = sample_of_buffer(arrival_ns);
      filled_ = 0;
      ++counters_.frames_good;
      emit(sink, &sample);
    }
  }

  // The device was closed and opened: a half-read frame will not be continued. Counters stay.
  void reset() noexcept {
    counters_.bytes_skipped += filled_;
    filled_ = 0;
  }

  // Every byte is somewhere: in a frame, skipped, or waiting for the rest of its frame.
  void counters(ifog_driver_counters& out) const {
    out = counters_;
    out.bytes_framed = counters_.frames_good * kFrame;
    out.bytes_pending = filled_;
  }

  // STEP 5, optional: the inverse. With it `ifog convert` and `ifog replay` can play a capture as your device
  // would. Throws when the sample does not fit into the format.
  void encode(const ifog_sample& sample, ifog_emit_bytes emit, void* sink) const {
    const double units = std::round(sample.value[0] * sign_ / kRadPerUnit);
    if (!(std::abs(units) <= std::numeric_limits<std::int32_t>::max()))
      throw std::invalid_argument("rate is " + std::to_string(sample.value[0]) +
                                  " rad/s, expected within ±37");
    const double degrees = std::isfinite(sample.environment[0]) ? std::round(sample.environment[0]) : 0.0;
    if (!(std::abs(degrees) <= 127.0))
      throw std::invalid_argument("temperature_degC is " + std::to_string(degrees) +
                                  ", expected within ±127");
    const auto rate = static_cast<std::uint32_t>(static_cast<std::int32_t>(units));
    std::array<std::uint8_t, kFrame> frame{kStart,
                                           static_cast<std::uint8_t>(sample.sequence),
                                           static_cast<std::uint8_t>(rate >> 24U),
                                           static_cast<std::uint8_t>(rate >> 16U & 0xFFU),
                                           static_cast<std::uint8_t>(rate >> 8U & 0xFFU),
                                           static_cast<std::uint8_t>(rate & 0xFFU),
                                           static_cast<std::uint8_t>(static_cast<std::int8_t>(degrees)),
                                           0};
    for (std::size_t k = 0; k + 1 < kFrame; ++k)
      frame[kFrame - 1] = static_cast<std::uint8_t>(frame[kFrame - 1] + frame[k]);
    emit(sink, frame.data(), frame.size());
  }

 private:
  void drop_one() noexcept {
    for (std::size_t k = 1; k < filled_; ++k) buffer_[k - 1] = buffer_[k];
    --filled_;
    ++counters_.bytes_skipped;
  }

  ifog_sample sample_of_buffer(std::int64_t arrival_ns) const noexcept {
    ifog_sample sample{};
    sample.arrival_ns = arrival_ns;
    sample.flags = IFOG_SAMPLE_SEQUENCE;  // and IFOG_SAMPLE_DEVICE_TIME if the device sends its clock
    sample.sequence = buffer_[1];
    const std::uint32_t bits = static_cast<std::uint32_t>(buffer_[2]) << 24U |
                               static_cast<std::uint32_t>(buffer_[3]) << 16U |
                               static_cast<std::uint32_t>(buffer_[4]) << 8U | buffer_[5];
    sample.value[0] = sign_ * kRadPerUnit * static_cast<std::int32_t>(bits);  // SI: rad/s
    sample.valid_axes = 1;  // leave the bit out when the device marks the value bad
    sample.environment[0] = static_cast<std::int8_t>(buffer_[6]);
    sample.environment_fresh = 1;
    for (std::size_t k = 1; k < IFOG_MAX_ENVIRONMENT; ++k)
      sample.environment[k] = std::numeric_limits<double>::quiet_NaN();
    return sample;
  }

  double rate_hz_;
  double sign_;
  std::array<std::uint8_t, kFrame> buffer_{};
  std::size_t filled_ = 0;
  ifog_driver_counters counters_{};
};

// STEP 6: the name must be the file's: template.so. A CAN sensor fills in the table of ifog/driver.h itself,
// with decode_can.
constexpr ifog_driver kTable = ifog::plugin::byte_driver<Driver>(
    "template", "1", "invented gyro of the driver to copy", kOptions.data());

}  // namespace

const ifog_driver* ifog_driver_entry(void) { return &kTable; }
