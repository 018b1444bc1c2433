// SPDX-License-Identifier: Apache-2.0
// Driver `kvh1750`: KVH 1725, 1750 and 1775 IMU and DSP-1760, message formats A, B and C.
//
// Radians or degrees, rate or delta angle, and the temperature's scale are settings of the device (=ANGUNITS,
// =ANGFMT, =LINFMT, =TEMPUNITS) and must be given to the driver. KVH delivers devices that send delta angles;
// the default here is rate.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "drivers/plugins/framing/framed_driver.h"
#include "drivers/plugins/kvh1750/frame.h"
#include "ifog/byte_driver.h"
#include "ifog/driver.h"
#include "ifog/options.h"

namespace ifog::kvh {
namespace {

constexpr double kStandardGravity = 9.80665;  // m/s² per g
constexpr double kMicroteslaPerGauss = 100.0;

// Environment channels: accelerometers, temperature, then (format C) the magnetic field.
constexpr std::size_t kAcceleration = 0;
constexpr std::size_t kTemperature = 3;
constexpr std::size_t kMagneticField = 4;
constexpr std::size_t kEnvironments = 7;
constexpr std::array<const char*, kEnvironments> kEnvironmentNames{
    "accel_x_mps2",  "accel_y_mps2",  "accel_z_mps2", "temperature_degC",
    "magnetic_x_uT", "magnetic_y_uT", "magnetic_z_uT"};

enum class Acceleration { kSpecificForce, kDeltaVelocity };

struct SetUp {
  std::optional<Format> format;  // nullopt: any
  double rad_per_unit = 1.0;
  bool delta_angle = false;
  Acceleration acceleration = Acceleration::kSpecificForce;
  bool fahrenheit = false;
  double degrees_per_count = 1.0;
  std::int64_t stamp_modulus_us = 0;
  double rate_hz = 1000.0;
  double full_scale_radps = 0.0;

  [[nodiscard]] double celsius(double sent) const {
    const double degrees = sent * degrees_per_count;
    return fahrenheit ? (degrees - 32.0) / 1.8 : degrees;
  }
  [[nodiscard]] double as_sent(double celsius) const {
    return (fahrenheit ? celsius * 1.8 + 32.0 : celsius) / degrees_per_count;
  }
  // m/s² per unit sent
  [[nodiscard]] double acceleration_scale() const {
    return acceleration == Acceleration::kSpecificForce ? kStandardGravity : rate_hz;
  }
};

constexpr std::array kOptions{
    ifog_option{"format", "auto | a | b | c", "auto", "message format; auto takes whichever arrives"},
    ifog_option{"angle_unit", "radians | degrees", "radians",
                "unit of the gyro values, as set in the device"},
    ifog_option{"output", "rate | delta", "rate",
                "gyro values are rates, or delta angles as KVH delivers it"},
    ifog_option{"acceleration", "specific_force | delta_velocity", "specific_force",
                "accelerometer values are g, or m/s since the sample before"},
    ifog_option{"temperature", "degC | centi_degC | degF | centi_degF", "degC",
                "temperature counts: degrees or hundredths of a degree"},
    ifog_option{"time_stamp", "free | pps", "free",
                "format B's stamp runs on through 32 bits, or restarts at each pulse per second"},
    ifog_option{"rate_hz", "a number > 0, at most 100000", "1000", "data rate set in the device"},
    // KVH, data sheets of the 1725, 1750 and 1775 IMU and of the DSP-1760: maximum input rate +-490 deg/s.
    ifog_option{"full_scale", "a number > 0, at most 10000", "490",
                "maximum input rate in deg/s: what reaches it is saturated"},
    ifog_option{nullptr, nullptr, nullptr, nullptr}};

SetUp read_set_up(const plugin::Options& options) {
  SetUp s;
  s.format = options.choice<std::optional<Format>>(
      "format", {{"auto", std::nullopt}, {"a", Format::kA}, {"b", Format::kB}, {"c", Format::kC}});
  s.rad_per_unit =
      options.choice<double>("angle_unit", {{"radians", 1.0}, {"degrees", std::numbers::pi / 180.0}});
  s.delta_angle = options.choice<bool>("output", {{"rate", false}, {"delta", true}});
  s.acceleration = options.choice<Acceleration>(
      "acceleration",
      {{"specific_force", Acceleration::kSpecificForce}, {"delta_velocity", Acceleration::kDeltaVelocity}});
  struct Scale {
    bool fahrenheit;
    double degrees_per_count;
  };
  const Scale scale = options.choice<Scale>("temperature", {{"degC", {false, 1.0}},
                                                            {"centi_degC", {false, 0.01}},
                                                            {"degF", {true, 1.0}},
                                                            {"centi_degF", {true, 0.01}}});
  s.fahrenheit = scale.fahrenheit;
  s.degrees_per_count = scale.degrees_per_count;
  s.stamp_modulus_us =
      options.choice<std::int64_t>("time_stamp", {{"free", std::int64_t{1} << 32U}, {"pps", 1'000'000}});
  s.rate_hz = options.number("rate_hz", 1e-3, 1e5, "a number > 0, at most 100000");
  s.full_scale_radps =
      options.number("full_scale", 1e-3, 1e4, "a number > 0, at most 10000") * std::numbers::pi / 180.0;
  return s;
}

class Driver : public framing::FramedDriver<Driver, Protocol> {
 public:
  explicit Driver(const plugin::Options& options) : set_up_(read_set_up(options)) {}

  void describe(ifog_description& out) const {
    const bool magnetic = !set_up_.format || set_up_.format == Format::kC;
    out = framing::three_axes(set_up_.full_scale_radps,
                              std::span(kEnvironmentNames).first(magnetic ? kEnvironments : kMagneticField));
    out.kind = set_up_.delta_angle ? IFOG_DELTA_ANGLE : IFOG_RATE;
    out.sequence_modulus = kSequenceModulus;
    out.has_device_time = set_up_.format == Format::kB ? 1 : 0;
    out.nominal_rate_hz = set_up_.rate_hz;
    out.baud = 921600;
  }

  // Throws std::invalid_argument for a value that does not fit.
  void encode(const ifog_sample& sample, ifog_emit_bytes emit, void* sink) {
    send<kLongestFrame>(frame_of(sample), emit, sink);
  }

  std::optional<ifog_sample> sample_of(std::span<const std::uint8_t> found) noexcept {
    const Frame frame = unpack(found);
    if (set_up_.format && frame.format != *set_up_.format) return std::nullopt;
    ifog_sample sample{};
    sample.sequence = frame.sequence % kSequenceModulus;
    sample.status = frame.status;
    sample.flags = IFOG_SAMPLE_SEQUENCE;
    if (frame.format == Format::kB) {
      sample.device_time_ns = stamp_.time_ns(frame.time_stamp_us);
      sample.device_wrap_ns = stamp_.time_ns(set_up_.stamp_modulus_us);
      sample.flags |= IFOG_SAMPLE_DEVICE_TIME;
    }
    for (unsigned axis = 0; axis < 3; ++axis) {
      const double value = static_cast<double>(frame.gyro[axis]) * set_up_.rad_per_unit;
      sample.value[axis] = value;
      if ((frame.status & kGyroValid << axis) != 0 && std::isfinite(value)) sample.valid_axes |= 1U << axis;
      if ((frame.status & kAccelerometerValid << axis) != 0)
        channels_.set(sample, kAcceleration + axis,
                      static_cast<double>(frame.accelerometer[axis]) * set_up_.acceleration_scale());
    }
    if (frame.format != Format::kC) {
      channels_.set(sample, kTemperature, set_up_.celsius(frame.temperature));
    } else if (const std::size_t quantity = slow_quantity(frame.sequence); quantity == 0) {
      channels_.set(sample, kTemperature, set_up_.celsius(static_cast<double>(frame.slow)));
    } else {
      channels_.set(sample, kMagneticField + quantity - 1,
                    static_cast<double>(frame.slow) * kMicroteslaPerGauss);
    }
    return sample;
  }

 private:
  Frame frame_of(const ifog_sample& sample) {
    Frame frame;
    frame.format = set_up_.format.value_or(Format::kA);
    frame.sequence = static_cast<std::uint8_t>(count_to_send(sample) % kSequenceModulus);
    for (unsigned axis = 0; axis < 3; ++axis) {
      frame.gyro[axis] = framing::float_of(sample.value[axis] / set_up_.rad_per_unit, "gyro value");
      if ((sample.valid_axes & 1U << axis) != 0)
        frame.status = static_cast<std::uint8_t>(frame.status | kGyroValid << axis);
      const double acceleration = sample.environment[kAcceleration + axis];
      if (!std::isfinite(acceleration)) continue;
      frame.accelerometer[axis] =
          framing::float_of(acceleration / set_up_.acceleration_scale(), "acceleration");
      frame.status = static_cast<std::uint8_t>(frame.status | kAccelerometerValid << axis);
    }
    if (frame.format == Format::kB) {
      if ((sample.flags & IFOG_SAMPLE_DEVICE_TIME) == 0)
        throw std::invalid_argument("format b needs the device's time, and the sample has none");
      frame.time_stamp_us = stamp_.stamp_at(sample.device_time_ns, set_up_.stamp_modulus_us);
    }
    encode_slow(sample, frame);
    return frame;
  }

  void encode_slow(const ifog_sample& sample, Frame& frame) const {
    const double temperature = sample.environment[kTemperature];
    if (frame.format == Format::kC) {
      const std::size_t quantity = slow_quantity(frame.sequence);
      frame.slow =
          quantity == 0
              ? framing::float_of(set_up_.as_sent(temperature), "temperature")
              : framing::float_of(sample.environment[kMagneticField + quantity - 1] / kMicroteslaPerGauss,
                                  "magnetic field");
      return;
    }
    // The format cannot express a missing temperature; devices without the sensor send 0.
    const double counts = std::isfinite(temperature) ? std::round(set_up_.as_sent(temperature)) : 0.0;
    if (counts < std::numeric_limits<std::int16_t>::min() ||
        counts > std::numeric_limits<std::int16_t>::max())
      throw std::invalid_argument("temperature_degC is " + std::to_string(temperature) +
                                  ", expected what 16 bits hold in the temperature option's scale");
    frame.temperature = static_cast<std::int16_t>(counts);
  }

  SetUp set_up_;
  framing::Stamp stamp_{1000};
};

constexpr ifog_driver kTable = plugin::byte_driver<Driver>(
    "kvh1750", "1", "KVH 1725, 1750, 1775 IMU and DSP-1760, message formats A, B and C", kOptions.data());

}  // namespace
}  // namespace ifog::kvh

const ifog_driver* ifog_driver_entry(void) { return &ifog::kvh::kTable; }
