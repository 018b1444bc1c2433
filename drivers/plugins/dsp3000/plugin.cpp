// SPDX-License-Identifier: Apache-2.0
// Driver `dsp3000`: KVH DSP-3000 with the digital 100 Hz interface.
//
// Rate, incremental and integrated angle have the same format, so the configuration must tell which it is.
// There is no counter or time, and the device's clock is 2 to 3 % off the nominal 100 Hz: times must come
// from arrivals, not from the nominal rate.
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "drivers/plugins/dsp3000/line.h"
#include "ifog/byte_driver.h"
#include "ifog/driver.h"
#include "ifog/options.h"

namespace ifog::dsp3000 {
namespace {

constexpr double kRadPerMicroDegree = 1e-6 * std::numbers::pi / 180.0;

constexpr std::array kOptions{
    ifog_option{"output", "rate | incremental | integrated", "rate",
                "rate in deg/s, angle since the line before, or angle modulo 360 deg"},
    ifog_option{"set_output", "no | yes", "no", "send the device the command for this output when it opens"},
    ifog_option{"sign", "1 | -1", "1", "-1 turns the sign; the device counts clockwise positive"},
    ifog_option{"rate_hz", "a number > 0, at most 1000", "100",
                "nominal data rate; the device's own is 2 to 3 % off"},
    ifog_option{nullptr, nullptr, nullptr, nullptr}};

struct Output {
  ifog_kind kind;
  char command;  // selects it in the device
};

class Driver {
 public:
  explicit Driver(const plugin::Options& options)
      : output_(options.choice<Output>("output", {{"rate", {IFOG_RATE, 'R'}},
                                                  {"incremental", {IFOG_DELTA_ANGLE, 'A'}},
                                                  {"integrated", {IFOG_ANGLE, 'P'}}})),
        set_output_(options.choice<bool>("set_output", {{"no", false}, {"yes", true}})),
        rad_per_unit_(kRadPerMicroDegree * options.choice<double>("sign", {{"1", 1.0}, {"-1", -1.0}})),
        rate_hz_(options.number("rate_hz", 1e-3, 1e3, "a number > 0, at most 1000")) {}

  void describe(ifog_description& out) const {
    out = {};
    out.kind = output_.kind;
    out.axes = 1;
    out.nominal_rate_hz = rate_hz_;
    out.angle_wrap_rad = output_.kind == IFOG_ANGLE ? 2.0 * std::numbers::pi : 0.0;
    // KVH, DSP-3000 data sheet: maximum input rate +-375 deg/s.
    out.full_scale[0] = 375.0 * std::numbers::pi / 180.0;
    out.baud = 38400;
    if (!set_output_) return;
    // Three times, because the device may miss a character while it sends.
    out.opening_length = 3;
    for (std::uint32_t i = 0; i < out.opening_length; ++i)
      out.opening[i] = static_cast<std::uint8_t>(output_.command);
  }

  void decode(std::span<const std::uint8_t> bytes, std::int64_t arrival_ns, ifog_emit_sample emit,
              void* sink) noexcept {
    finder_.feed(bytes, [&](const Reading& reading) {
      ifog_sample sample{};
      sample.arrival_ns = arrival_ns;
      sample.status = reading.valid ? 1 : 0;
      sample.valid_axes = reading.valid ? 1 : 0;
      sample.value[0] = rad_per_unit_ * reading.micro_degrees;
      for (double& value : sample.environment) value = std::numeric_limits<double>::quiet_NaN();
      emit(sink, &sample);
    });
  }

  void reset() noexcept { finder_.reset(); }

  void counters(ifog_driver_counters& out) const { out = finder_.counters(); }

  void encode(const ifog_sample& sample, ifog_emit_bytes emit, void* sink) {
    Reading reading;
    reading.valid = (sample.valid_axes & 1U) != 0;
    if (reading.valid) {
      double units = std::round(sample.value[0] / rad_per_unit_);
      constexpr double kTurn = 360e6;
      if (output_.kind == IFOG_ANGLE && units < 0.0) units += kTurn;  // the device sends 0 … 360
      if (!(std::abs(units) <= kHighest))
        throw std::invalid_argument("value is " + std::to_string(sample.value[0]) +
                                    ", expected less than 1000 deg or deg/s");
      reading.micro_degrees = static_cast<std::int32_t>(units);
    }
    std::array<char, kLongestLine> line{};
    const std::size_t length = format_line(reading, line.data());
    if (!started_) emit(sink, reinterpret_cast<const std::uint8_t*>("\r\n"), 2);
    started_ = true;
    emit(sink, reinterpret_cast<const std::uint8_t*>(line.data()), length);
  }

 private:
  Output output_;
  bool set_output_;
  double rad_per_unit_;
  double rate_hz_;
  LineFinder finder_;
  // A decoder ignores everything before the first line end, so it is sent first.
  bool started_ = false;
};

constexpr ifog_driver kTable = plugin::byte_driver<Driver>(
    "dsp3000", "1", "KVH DSP-3000, digital 100 Hz interface (ASCII lines)", kOptions.data());

}  // namespace
}  // namespace ifog::dsp3000

const ifog_driver* ifog_driver_entry(void) { return &ifog::dsp3000::kTable; }
