// SPDX-License-Identifier: Apache-2.0
// Driver `sbgecom`: SBG Systems Ellipse, Apogee, Ekinox, Quanta, Pulse; IMU logs of the sbgECom protocol.
//
// Both messages contain mean rate and specific force between two messages, including coning and sculling:
// times the interval they are the increments.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "drivers/plugins/framing/framed_driver.h"
#include "drivers/plugins/sbgecom/message.h"
#include "ifog/byte_driver.h"
#include "ifog/driver.h"
#include "ifog/options.h"

namespace ifog::sbgecom {
namespace {

constexpr std::int64_t kStampModulus = std::int64_t{1} << 32U;  // µs

// Environment channels.
constexpr std::size_t kAcceleration = 0, kTemperature = 3, kEnvironments = 4;
constexpr std::array<const char*, kEnvironments> kNames{"accel_x_mps2", "accel_y_mps2", "accel_z_mps2",
                                                        "temperature_degC"};

constexpr std::array kOptions{
    ifog_option{"message", "auto | imu_short | imu_data", "auto",
                "IMU log set in the device; auto takes whichever arrives. Where both are on, choose one"},
    ifog_option{"rate_hz", "a number > 0, at most 100000", "200", "rate of the log set in the device"},
    // Widest range of a product (Pulse-40); narrower devices report saturation in their status.
    ifog_option{"full_scale", "a number > 0, at most 10000", "2000",
                "maximum input rate in deg/s: what reaches it is saturated"},
    ifog_option{nullptr, nullptr, nullptr, nullptr}};

class Driver : public framing::FramedDriver<Driver, Protocol> {
 public:
  explicit Driver(const plugin::Options& options)
      : message_(options.choice<std::optional<std::uint8_t>>(
            "message", {{"auto", std::nullopt}, {"imu_short", kImuShort}, {"imu_data", kImuData}})),
        rate_hz_(options.number("rate_hz", 1e-3, 1e5, "a number > 0, at most 100000")),
        full_scale_radps_(options.number("full_scale", 1e-3, 1e4, "a number > 0, at most 10000") *
                          std::numbers::pi / 180.0) {}

  void describe(ifog_description& out) const {
    out = framing::three_axes(full_scale_radps_, kNames);
    out.kind = IFOG_RATE;
    out.has_device_time = 1;
    out.nominal_rate_hz = rate_hz_;
  }

  // The device's other messages are good frames, too.
  void counters(ifog_driver_counters& out) const { finder_.copy_to(out); }

  // Throws std::invalid_argument: no time, or a value that does not fit.
  void encode(const ifog_sample& sample, ifog_emit_bytes emit, void* sink) {
    if ((sample.flags & IFOG_SAMPLE_DEVICE_TIME) == 0)
      throw std::invalid_argument("the message carries the device's time, and the sample has none");
    Imu imu;
    imu.message = message_.value_or(kImuShort);
    imu.time_stamp_us = stamp_.stamp_at(sample.device_time_ns, kStampModulus);
    imu.status = kComOk | kImuOk | kAccelerationsInRange | kGyrosInRange;
    for (unsigned axis = 0; axis < 3; ++axis) {
      if ((sample.valid_axes & 1U << axis) != 0) {
        imu.rate_radps[axis] = sample.value[axis];
        imu.status = static_cast<std::uint16_t>(imu.status | kGyroOk << axis);
      }
      if (const double acceleration = sample.environment[kAcceleration + axis]; std::isfinite(acceleration)) {
        imu.acceleration_mps2[axis] = acceleration;
        imu.status = static_cast<std::uint16_t>(imu.status | kAccelerationOk << axis);
      }
    }
    // The message cannot express a missing temperature.
    if (std::isfinite(sample.environment[kTemperature]))
      imu.temperature_degC = sample.environment[kTemperature];
    send<kLongestImuFrame>(imu, emit, sink);
  }

  std::optional<ifog_sample> sample_of(std::span<const std::uint8_t> found) noexcept {
    Imu imu;
    if (!unpack(found, imu) || (message_ && imu.message != *message_)) return std::nullopt;
    ifog_sample sample{};
    sample.status = imu.status;
    sample.device_time_ns = stamp_.time_ns(imu.time_stamp_us);
    sample.device_wrap_ns = stamp_.time_ns(kStampModulus);
    sample.flags = IFOG_SAMPLE_DEVICE_TIME;
    const bool alive = (imu.status & kComOk) != 0;
    const bool gyros = alive && (imu.status & kGyrosInRange) != 0;
    const bool accelerometers = alive && (imu.status & kAccelerationsInRange) != 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      sample.value[axis] = imu.rate_radps[axis];
      if (gyros && (imu.status & kGyroOk << axis) != 0 && std::isfinite(imu.rate_radps[axis]))
        sample.valid_axes |= 1U << axis;
      if (accelerometers && (imu.status & kAccelerationOk << axis) != 0)
        channels_.set(sample, kAcceleration + axis, imu.acceleration_mps2[axis]);
    }
    if (alive) channels_.set(sample, kTemperature, imu.temperature_degC);
    return sample;
  }

 private:
  std::optional<std::uint8_t> message_;
  double rate_hz_, full_scale_radps_;
  framing::Stamp stamp_{1000};
};

constexpr ifog_driver kTable = plugin::byte_driver<Driver>(
    "sbgecom", "1", "SBG Systems sbgECom, IMU logs IMU_SHORT and IMU_DATA", kOptions.data());

}  // namespace
}  // namespace ifog::sbgecom

const ifog_driver* ifog_driver_entry(void) { return &ifog::sbgecom::kTable; }
