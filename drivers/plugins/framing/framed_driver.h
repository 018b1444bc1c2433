// SPDX-License-Identifier: Apache-2.0
// What drivers of devices that send frames have in common: from a frame to its sample and back.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "drivers/plugins/framing/fields.h"
#include "drivers/plugins/framing/frame_finder.h"
#include "ifog/driver.h"
#include "ifog/options.h"

namespace ifog::framing {

// Of a device with axes x, y and z of one full scale, rad/s, and environment channels of these names.
inline ifog_description three_axes(double full_scale_radps, std::span<const char* const> channels) {
  ifog_description out{};
  for (const char* axis : {"x", "y", "z"}) {
    out.full_scale[out.axes] = full_scale_radps;
    plugin::set_name(out.axis[out.axes++], axis);
  }
  for (const char* channel : channels) plugin::set_name(out.environment[out.environments++], channel);
  return out;
}

// Environment channels, which hold their values between frames.
class Channels {
 public:
  Channels() { held_.fill(std::numeric_limits<double>::quiet_NaN()); }
  // Sets a new value of this sample; ignored if not finite.
  void set(ifog_sample& sample, std::size_t channel, double value) noexcept {
    if (!std::isfinite(value)) return;
    held_[channel] = value;
    sample.environment_fresh |= 1U << channel;
  }
  void copy_to(ifog_sample& sample) const noexcept {
    std::copy(held_.begin(), held_.end(), sample.environment);
  }

 private:
  std::array<double, IFOG_MAX_ENVIRONMENT> held_{};
};

// Derived has
//   std::optional<ifog_sample> sample_of(std::span<const std::uint8_t> frame) noexcept;
// without the time of arrival and the channels, which are set here; nullopt: a frame that the options do not want.
template <typename Derived, typename Protocol>
class FramedDriver {
 public:
  explicit FramedDriver(const Protocol& protocol = {}) : finder_(protocol) {}

  void decode(std::span<const std::uint8_t> bytes, std::int64_t arrival_ns, ifog_emit_sample emit,
              void* sink) noexcept {
    finder_.feed(bytes, [&](std::span<const std::uint8_t> frame) {
      std::optional<ifog_sample> sample = static_cast<Derived*>(this)->sample_of(frame);
      if (!sample) {
        ++unwanted_;
        return;
      }
      sample->arrival_ns = arrival_ns;
      channels_.copy_to(*sample);
      emit(sink, &*sample);
    });
  }
  void reset() noexcept { finder_.reset(); }
  void counters(ifog_driver_counters& out) const { finder_.copy_to(out, unwanted_); }

 protected:
  // Counter of the frame to be sent: the sample's, or the next one.
  std::uint32_t count_to_send(const ifog_sample& sample) {
    const std::uint32_t count = (sample.flags & IFOG_SAMPLE_SEQUENCE) != 0 ? sample.sequence : sent_;
    sent_ = count + 1;
    return count;
  }
  template <std::size_t kLongest, typename Frame>
  static void send(const Frame& frame, ifog_emit_bytes emit, void* sink) {
    std::array<std::uint8_t, kLongest> bytes{};
    emit(sink, bytes.data(), pack(frame, bytes));
  }

  FrameFinder<Protocol> finder_;
  Channels channels_;

 private:
  std::uint64_t unwanted_ = 0;  // intact frames that the driver ignores by its options
  std::uint32_t sent_ = 0;
};

}  // namespace ifog::framing
