// SPDX-License-Identifier: Apache-2.0
// Driver `stim300`: Normal Mode datagrams of the Sensonor STIM300.
//
// The identifier tells the content; the units of the counts are settings of the device and must be given to
// the driver.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>

#include "drivers/plugins/framing/framed_driver.h"
#include "drivers/plugins/stim300/datagram.h"
#include "ifog/byte_driver.h"
#include "ifog/driver.h"
#include "ifog/options.h"

namespace ifog::stim300 {
namespace {

constexpr double kStandardGravity = 9.80665;  // m/s² per g, by the datasheet
constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
constexpr double kFullScale_radps = 400.0 * kRadiansPerDegree;  // datasheet, table 5-3
constexpr double kInternalRate_hz = 2000.0;                     // section 7.5.2.2.18
constexpr std::uint32_t kCounterModulus = 256;
constexpr double kRateCounts = 0x1p14;                      // per °/s, equation 1
constexpr double kAngleCounts = 0x1p21;                     // per °, equation 2
constexpr double kAngleWrap_rad = 8.0 * kRadiansPerDegree;  // [-4°, 4°>, section 7.5.2.2.5
constexpr double kInclinationCounts = 0x1p22, kInclinationSpeedCounts = 0x1p25;  // equations 5 and 6
constexpr double kTemperatureCounts = 0x1p8;                                     // per °C, equation 9
constexpr double kAuxCounts = 0x1p24 / 5.0;                                      // per V

// Environment channels.
constexpr std::size_t kAcceleration = 0, kInclination = 3, kGyroTemperature = 6, kAccelerationTemperature = 9,
                      kInclinationTemperature = 12, kLatency = 13, kPps = 14, kAux = 15, kEnvironments = 16;
constexpr std::array<const char*, kEnvironments> kNames{"accel_x_mps2",
                                                        "accel_y_mps2",
                                                        "accel_z_mps2",
                                                        "inclination_x_mps2",
                                                        "inclination_y_mps2",
                                                        "inclination_z_mps2",
                                                        "temperature_x_degC",
                                                        "temperature_y_degC",
                                                        "temperature_z_degC",
                                                        "accel_temperature_x_degC",
                                                        "accel_temperature_y_degC",
                                                        "accel_temperature_z_degC",
                                                        "inclination_temperature_degC",
                                                        "latency_us",
                                                        "pps_us",
                                                        "aux_V"};
static_assert(kEnvironments <= IFOG_MAX_ENVIRONMENT);

struct SetUp {
  std::optional<Content> datagram;  // nullopt: any
  ifog_kind kind = IFOG_RATE;
  double counts_per_g = 0.0, counts_per_mps = 0.0;  // of the accelerometer's range
  bool delta_velocity = false;
  bool terminated = false;
  double rate_hz = 0.0;            // 0: external trigger
  std::uint32_t counter_step = 0;  // internal samples per datagram; 0: any

  [[nodiscard]] double gyro_scale() const {  // rad/s or rad per count
    return kRadiansPerDegree / (kind == IFOG_RATE ? kRateCounts : kAngleCounts);
  }
  [[nodiscard]] double acceleration_scale() const {  // m/s² per count
    return delta_velocity ? rate_hz / counts_per_mps : kStandardGravity / counts_per_g;
  }
  [[nodiscard]] double inclination_scale() const {
    return delta_velocity ? rate_hz / kInclinationSpeedCounts : kStandardGravity / kInclinationCounts;
  }
};

constexpr std::array kOptions{
    ifog_option{
        "datagram", "auto | an identifier, 0x90 ... 0xF7", "auto",
        "Normal Mode datagram, as the datasheet numbers it; auto takes whichever arrives and makes 0xA7"},
    ifog_option{"output", "rate | incremental_angle | integrated_angle", "rate",
                "gyro output unit set in the device; rate includes the average one"},
    ifog_option{"acceleration", "specific_force | delta_velocity", "specific_force",
                "unit of accelerometer and inclinometer: g, or m/s since the datagram before"},
    ifog_option{"acceleration_range", "2 | 5 | 10 | 30 | 80", "10",
                "of the accelerometer that is built in, g"},
    ifog_option{"rate_hz", "125 | 250 | 500 | 1000 | 2000 | trigger", "2000",
                "datagrams a second set in the device, or one at each external trigger"},
    ifog_option{"termination", "none | crlf", "none", "CR LF behind each datagram, as set in the device"},
    ifog_option{nullptr, nullptr, nullptr, nullptr}};

SetUp read_set_up(const plugin::Options& options) {
  SetUp s;
  if (const std::string given(options.text("datagram")); given != "auto") {
    unsigned identifier = 0;
    const char* const end = given.data() + given.size();
    const bool hex = given.starts_with("0x") && given.size() == 4 &&
                     std::from_chars(given.data() + 2, end, identifier, 16).ptr == end;
    if (hex) s.datagram = content_of(static_cast<std::uint8_t>(identifier));
    if (!s.datagram)
      options.fail("datagram", "auto or the identifier of a datagram with rates, such as 0xA5");
  }
  s.kind = options.choice<ifog_kind>(
      "output",
      {{"rate", IFOG_RATE}, {"incremental_angle", IFOG_DELTA_ANGLE}, {"integrated_angle", IFOG_ANGLE}});
  s.delta_velocity =
      options.choice<bool>("acceleration", {{"specific_force", false}, {"delta_velocity", true}});
  // Equations 3 and 4.
  s.counts_per_g = options.choice<double>(
      "acceleration_range", {{"2", 0x1p21}, {"5", 0x1p20}, {"10", 0x1p19}, {"30", 0x1p18}, {"80", 0x1p16}});
  s.counts_per_mps = 8.0 * s.counts_per_g;
  s.rate_hz = options.choice<double>(
      "rate_hz",
      {{"125", 125.0}, {"250", 250.0}, {"500", 500.0}, {"1000", 1000.0}, {"2000", 2000.0}, {"trigger", 0.0}});
  if (s.rate_hz > 0.0) s.counter_step = static_cast<std::uint32_t>(kInternalRate_hz / s.rate_hz);
  if (s.delta_velocity && s.counter_step == 0)
    options.fail("acceleration", "specific_force with rate_hz = trigger: a speed needs its time");
  s.terminated = options.choice<bool>("termination", {{"none", false}, {"crlf", true}});
  return s;
}

// Bit i: axis i is usable according to the status byte.
unsigned usable_axes(std::uint8_t status) {
  if ((status & (kIntegrityError | kStartUp)) != 0) return 0;
  if ((status & (kOverload | kChannelError)) == 0) return 7;
  const unsigned named = status & 7U;
  return named == 0 ? 0 : 7U & ~named;
}

class Driver : public framing::FramedDriver<Driver, Protocol> {
 public:
  explicit Driver(const plugin::Options& options) : Driver(read_set_up(options)) {}
  explicit Driver(const SetUp& set_up) : FramedDriver(Protocol{set_up.terminated}), set_up_(set_up) {}

  void describe(ifog_description& out) const {
    out = framing::three_axes(kFullScale_radps, kNames);
    out.kind = set_up_.kind;
    out.sequence_modulus = set_up_.counter_step == 0 ? 0 : kCounterModulus / set_up_.counter_step;
    out.nominal_rate_hz = set_up_.rate_hz;
    out.angle_wrap_rad = set_up_.kind == IFOG_ANGLE ? kAngleWrap_rad : 0.0;
  }

  void counters(ifog_driver_counters& out) const {
    FramedDriver::counters(out);
    // Any byte may look like the one-byte header, so a wrong checksum does not prove a frame. Losses show in
    // the skipped bytes and the sequence.
    out.frames_crc = 0;
  }

  // Throws std::invalid_argument for a value that does not fit.
  void encode(const ifog_sample& sample, ifog_emit_bytes emit, void* sink) {
    send<kLongestDatagram>(datagram_of(sample), emit, sink);
    constexpr std::array<std::uint8_t, kTermination> kEnd{'\r', '\n'};
    if (set_up_.terminated) emit(sink, kEnd.data(), kEnd.size());
  }

  std::optional<ifog_sample> sample_of(std::span<const std::uint8_t> found) noexcept {
    const Content content = *content_of(found[0]);
    if (set_up_.datagram && content != *set_up_.datagram) return std::nullopt;
    const Datagram in = unpack(content, found);
    ifog_sample sample{};
    sample.status = in.gyro.status | static_cast<std::uint32_t>(in.acceleration.status) << 8U |
                    static_cast<std::uint32_t>(in.inclination.status) << 16U;
    if (set_up_.counter_step != 0) {
      sample.sequence = in.counter / set_up_.counter_step;
      sample.flags = IFOG_SAMPLE_SEQUENCE;
    }
    for (unsigned axis = 0; axis < 3; ++axis) sample.value[axis] = in.gyro.count[axis] * set_up_.gyro_scale();
    sample.valid_axes = usable_axes(in.gyro.status);
    if (content.acceleration) take(sample, kAcceleration, in.acceleration, set_up_.acceleration_scale());
    if (content.inclination) take(sample, kInclination, in.inclination, set_up_.inclination_scale());
    if (content.temperature) {
      take(sample, kGyroTemperature, in.gyro_temperature, 1.0 / kTemperatureCounts);
      if (content.acceleration)
        take(sample, kAccelerationTemperature, in.acceleration_temperature, 1.0 / kTemperatureCounts);
      const Triad& tilt = in.inclination_temperature;
      if (content.inclination && usable_axes(tilt.status) == 7)
        channels_.set(sample, kInclinationTemperature,
                      (tilt.count[0] + tilt.count[1] + tilt.count[2]) / (3.0 * kTemperatureCounts));
    }
    if (content.pps) channels_.set(sample, kPps, in.extra);
    if (content.aux && usable_axes(in.extra_status) == 7) channels_.set(sample, kAux, in.extra / kAuxCounts);
    channels_.set(sample, kLatency, in.latency_us);
    return sample;
  }

 private:
  void take(ifog_sample& sample, std::size_t channel, const Triad& triad, double scale) noexcept {
    for (unsigned axis = 0; axis < 3; ++axis)
      if ((usable_axes(triad.status) & 1U << axis) != 0)
        channels_.set(sample, channel + axis, triad.count[axis] * scale);
  }

  // Missing values become 0 with the status of a channel error.
  static Triad triad_of(const double* values, double scale, unsigned bits, const std::string& what) {
    Triad out;
    for (unsigned axis = 0; axis < 3; ++axis) {
      if (std::isfinite(values[axis]))
        out.count[axis] = framing::count_of(values[axis] / scale, bits, what);
      else
        out.status = static_cast<std::uint8_t>(out.status | kChannelError | 1U << axis);
    }
    return out;
  }

  Datagram datagram_of(const ifog_sample& sample) {
    Datagram out;
    out.content = set_up_.datagram.value_or(*content_of(0xA7));
    std::array<double, 3> gyro{};
    for (unsigned axis = 0; axis < 3; ++axis) {
      const bool valid = (sample.valid_axes & 1U << axis) != 0;
      gyro[axis] = valid ? sample.value[axis] : std::nan("");
      // An angle wraps like its counts.
      if (set_up_.kind == IFOG_ANGLE) gyro[axis] = wrapped(gyro[axis]);
    }
    out.gyro = triad_of(gyro.data(), set_up_.gyro_scale(), 24, "gyro value");
    const double* const environment = sample.environment;
    out.acceleration =
        triad_of(environment + kAcceleration, set_up_.acceleration_scale(), 24, "acceleration");
    out.inclination = triad_of(environment + kInclination, set_up_.inclination_scale(), 24, "inclination");
    out.gyro_temperature =
        triad_of(environment + kGyroTemperature, 1.0 / kTemperatureCounts, 16, "temperature");
    out.acceleration_temperature =
        triad_of(environment + kAccelerationTemperature, 1.0 / kTemperatureCounts, 16, "temperature");
    const std::array<double, 3> tilt{environment[kInclinationTemperature],
                                     environment[kInclinationTemperature],
                                     environment[kInclinationTemperature]};
    out.inclination_temperature = triad_of(tilt.data(), 1.0 / kTemperatureCounts, 16, "temperature");
    encode_rest(sample, out);
    return out;
  }

  void encode_rest(const ifog_sample& sample, Datagram& out) {
    const double extra = out.content.aux ? sample.environment[kAux] * kAuxCounts : sample.environment[kPps];
    if (std::isfinite(extra))
      out.extra = framing::count_of(extra, 24, "PPS or AUX");
    else
      out.extra_status = kChannelError;
    const std::uint32_t step = set_up_.counter_step == 0 ? 1 : set_up_.counter_step;
    out.counter = static_cast<std::uint8_t>(count_to_send(sample) * step % kCounterModulus);
    const double latency = sample.environment[kLatency];
    if (std::isfinite(latency))
      out.latency_us = static_cast<std::uint16_t>(std::clamp(std::round(latency), 0.0, 65535.0));
  }

  static double wrapped(double angle) {
    const double within = std::remainder(angle, kAngleWrap_rad);
    // The interval includes its lower end: a value that rounds to the upper end becomes the lower one.
    const double half_count = 0.5 * kRadiansPerDegree / kAngleCounts;
    return within >= 0.5 * kAngleWrap_rad - half_count ? within - kAngleWrap_rad : within;
  }

  SetUp set_up_;
};

constexpr ifog_driver kTable =
    plugin::byte_driver<Driver>("stim300", "1", "Sensonor STIM300, Normal Mode datagrams", kOptions.data());

}  // namespace
}  // namespace ifog::stim300

const ifog_driver* ifog_driver_entry(void) { return &ifog::stim300::kTable; }
