// SPDX-License-Identifier: Apache-2.0
// Driver `stdbin`: iXblue (Exail) fibre-optic INS, AHRS and gyrocompasses (Octans, Quadrans, Hydrins, Phins,
// Rovins, …), STDBIN telegrams of versions 2 to 5.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "drivers/plugins/framing/framed_driver.h"
#include "drivers/plugins/stdbin/telegram.h"
#include "ifog/byte_driver.h"
#include "ifog/driver.h"
#include "ifog/options.h"

namespace ifog::stdbin {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
// The stamp is the time of day if the device knows it, else since power-up.
constexpr std::int64_t kTick_ns = 100'000, kTicksOfADay = 864'000'000,
                       kTicksOfTheField = std::int64_t{1} << 32U;
// Part of the 32-bit counter that suffices to count losses.
constexpr std::uint32_t kSequenceModulus = 1U << 16U;

// Environment channels.
constexpr std::size_t kAcceleration = 0, kTemperature = 3, kEnvironments = 6;
constexpr std::array<const char*, kEnvironments> kNames{"accel_x_mps2",           "accel_y_mps2",
                                                        "accel_z_mps2",           "temperature_degC",
                                                        "accel_temperature_degC", "board_temperature_degC"};

constexpr std::array kOptions{
    ifog_option{
        "rate_block", "raw | compensated", "raw",
        "raw: extended block 2 (protocol 3 and later), which has Earth's rotation in it as an error model "
        "needs; compensated: navigation block 5, without"},
    ifog_option{"version", "2 | 3 | 4 | 5", "3", "of the telegrams that are made; those of all are read"},
    ifog_option{"rate_hz", "a number > 0, at most 100000", "100", "telegrams a second set in the device"},
    ifog_option{"full_scale", "a number > 0, at most 10000", "750",
                "maximum input rate in deg/s: what reaches it is saturated"},
    ifog_option{nullptr, nullptr, nullptr, nullptr}};

class Driver : public framing::FramedDriver<Driver, Protocol> {
 public:
  explicit Driver(const plugin::Options& options)
      : raw_(options.choice<bool>("rate_block", {{"raw", true}, {"compensated", false}})),
        version_(options.choice<std::uint8_t>("version", {{"2", 2}, {"3", 3}, {"4", 4}, {"5", 5}})),
        rate_hz_(options.number("rate_hz", 1e-3, 1e5, "a number > 0, at most 100000")),
        full_scale_radps_(options.number("full_scale", 1e-3, 1e4, "a number > 0, at most 10000") *
                          kRadiansPerDegree) {
    if (raw_ && version_ == 2)
      options.fail("version", "3, 4 or 5 with rate_block = raw: extended blocks exist since version 3");
  }

  void describe(ifog_description& out) const {
    out = framing::three_axes(full_scale_radps_, kNames);
    out.kind = IFOG_RATE;
    out.sequence_modulus = kSequenceModulus;
    out.has_device_time = 1;
    out.nominal_rate_hz = rate_hz_;
  }

  void reset() noexcept {
    FramedDriver::reset();
    beyond_a_day_ = false;
  }

  // Throws std::invalid_argument: no time, a missing axis, or a value that no float holds.
  void encode(const ifog_sample& sample, ifog_emit_bytes emit, void* sink) {
    if ((sample.flags & IFOG_SAMPLE_DEVICE_TIME) == 0)
      throw std::invalid_argument("the telegram carries the device's time, and the sample has none");
    Telegram telegram;
    telegram.version = version_;
    telegram.validity_100us = stamp_.stamp_at(sample.device_time_ns, kTicksOfADay);
    telegram.counter = count_to_send(sample);
    Triad rate{};
    for (unsigned axis = 0; axis < 3; ++axis)
      rate[axis] = (sample.valid_axes & 1U << axis) != 0
                       ? framing::float_of(sample.value[axis] / kRadiansPerDegree, "rate")
                       : std::nanf("");
    (raw_ ? telegram.raw_rate_degps : telegram.rate_degps) = rate;
    telegram.raw_acceleration_mps2 = triad_of(sample.environment + kAcceleration, "acceleration");
    telegram.temperature_degC = triad_of(sample.environment + kTemperature, "temperature");
    send<kLongestTelegram>(telegram, emit, sink);
  }

  std::optional<ifog_sample> sample_of(std::span<const std::uint8_t> found) noexcept {
    const Telegram telegram = unpack(found);
    const std::optional<Triad>& rate = raw_ ? telegram.raw_rate_degps : telegram.rate_degps;
    if (!rate) return std::nullopt;
    ifog_sample sample{};
    sample.status = telegram.sensor_status.value_or(0);
    sample.sequence = telegram.counter % kSequenceModulus;
    // A stamp above a day is no time of day.
    beyond_a_day_ = beyond_a_day_ || telegram.validity_100us >= kTicksOfADay;
    sample.device_time_ns = stamp_.time_ns(telegram.validity_100us);
    sample.device_wrap_ns = stamp_.time_ns(beyond_a_day_ ? kTicksOfTheField : kTicksOfADay);
    sample.flags = IFOG_SAMPLE_SEQUENCE | IFOG_SAMPLE_DEVICE_TIME;
    for (unsigned axis = 0; axis < 3; ++axis) {
      sample.value[axis] = static_cast<double>((*rate)[axis]) * kRadiansPerDegree;
      if (std::isfinite(sample.value[axis])) sample.valid_axes |= 1U << axis;
    }
    const auto take = [&](const std::optional<Triad>& values, std::size_t channel) {
      for (std::size_t i = 0; values && i < values->size(); ++i)
        channels_.set(sample, channel + i, static_cast<double>((*values)[i]));
    };
    take(telegram.raw_acceleration_mps2, kAcceleration);
    take(telegram.temperature_degC, kTemperature);
    return sample;
  }

 private:
  // nullopt if all three are missing.
  static std::optional<Triad> triad_of(const double* values, const char* what) {
    Triad out{};
    bool any = false;
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = framing::float_of(values[i], what);
      any = any || std::isfinite(values[i]);
    }
    return any ? std::optional(out) : std::nullopt;
  }

  bool raw_;
  std::uint8_t version_;
  double rate_hz_, full_scale_radps_;
  framing::Stamp stamp_{kTick_ns};
  bool beyond_a_day_ = false;
};

constexpr ifog_driver kTable = plugin::byte_driver<Driver>(
    "stdbin", "1", "iXblue (Exail) STDBIN telegrams, versions 2 to 5", kOptions.data());

}  // namespace
}  // namespace ifog::stdbin

const ifog_driver* ifog_driver_entry(void) { return &ifog::stdbin::kTable; }
