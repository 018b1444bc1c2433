// SPDX-License-Identifier: Apache-2.0
// What a device that is known sends, and what of it comes, in which order and when: doubled, exchanged, lost,
// begun anew. With what is to be found of each frame, which the making of the stream knows.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "drivers/host/driver_instance.h"

namespace ifog {

struct Device {
  std::string name;
  DriverSettings settings;
  double rate_hz = 200.0;
  std::int64_t wrap_ns = 0;  // of its stamp; 0: it has none, or one that never goes round
  bool restarts = true;      // what it sends can tell that
};

// One frame as it comes.
struct Coming {
  std::vector<std::uint8_t> bytes;
  std::vector<ifog_can_frame> frames;
  double arrives_s = 0.0;
  std::size_t number = 0;     // of the sample, over all that the device took
  std::size_t power_up = 0;   // which
  std::int64_t stamp_ns = 0;  // unwrapped, since that power-up
  double value = 0.0;         // of the first axis, as the frame alone decodes
  bool taken = true;          // not twice, not behind one that follows
  std::size_t missing = 0;    // before it
};

class DisturbedStream {
 public:
  DisturbedStream(const Device& device, std::uint32_t seed, bool constant)
      : device_(device),
        driver_(make_driver(device.name, with_rate(device))),
        random_(seed),
        constant_(constant) {}

  // So many samples from a power-up at time_s, the first with that stamp and counter 0.
  void power_up(double time_s, std::int64_t stamp_ns, std::size_t samples) {
    ++power_ups_;
    const double period_s = 1.0 / device_.rate_hz;
    for (std::size_t i = 0; i < samples; ++i) {
      Coming one;
      one.number = next_number_++;
      one.power_up = power_ups_;
      one.stamp_ns = stamp_ns + std::llround(static_cast<double>(i) * period_s * 1e9);
      one.arrives_s = time_s + static_cast<double>(i) * period_s;
      encode(one, static_cast<std::uint32_t>(i));
      coming.push_back(std::move(one));
    }
  }
  // Every `spaced` frames one disturbance, each a kind in turn, `most_lost` in a row at most.
  void disturb(std::size_t spaced, std::size_t most_lost) {
    std::vector<Coming> out;
    std::size_t kind = 0;
    for (std::size_t at = 0; at < coming.size();) {
      const bool room = at + 40 < coming.size() && coming[at].power_up == coming[at + 40].power_up;
      if (!room || out.empty() || at % spaced != spaced / 2) {
        out.push_back(coming[at++]);
        continue;
      }
      switch (kind++ % 5) {
        case 0: {  // again, some frames later
          const std::size_t later = any(0, 6);
          const Coming again = coming[at];
          for (std::size_t k = 0; k <= later; ++k) out.push_back(coming[at++]);
          out.push_back(again);
          break;
        }
        case 1:  // two change places
          out.push_back(coming[at + 1]);
          out.push_back(coming[at]);
          at += 2;
          break;
        case 2:  // the same, and what follows is lost
          out.push_back(coming[at + 1]);
          out.push_back(coming[at]);
          at += 3;
          break;
        case 3:
          at += any(1, most_lost);
          break;
        default: {  // three of them twice, as a block
          for (std::size_t k = 0; k < 3; ++k) out.push_back(coming[at + k]);
          for (std::size_t k = 0; k < 3; ++k) out.push_back(coming[at++]);
          break;
        }
      }
    }
    coming = std::move(out);
    judge();
  }

  // A frame comes when the latest of those before it has, or its own time.
  void judge() {
    std::uniform_real_distribution<double> jitter_s(0.0, 5e-4);
    double latest_s = 0.0;
    bool first = true;
    std::size_t highest = 0, power_up = 0;
    for (Coming& one : coming) {
      latest_s = std::max(latest_s, one.arrives_s);
      one.arrives_s = latest_s + jitter_s(random_);
      one.taken = first || one.power_up != power_up || one.number > highest;
      one.missing = one.taken && !first && one.power_up == power_up ? one.number - highest - 1 : 0;
      if (one.taken) {
        highest = one.number;
        power_up = one.power_up;
      }
      first = false;
    }
  }

  std::vector<Coming> coming;

 private:
  static DriverSettings with_rate(const Device& device) {
    DriverSettings out = device.settings;
    out.try_emplace("rate_hz", std::to_string(static_cast<int>(device.rate_hz)));
    return out;
  }
  std::size_t any(std::size_t least, std::size_t most) {
    return std::uniform_int_distribution<std::size_t>(least, most)(random_);
  }
  void encode(Coming& one, std::uint32_t sequence) {
    ifog_sample sample{};
    sample.flags = IFOG_SAMPLE_SEQUENCE | IFOG_SAMPLE_DEVICE_TIME;
    sample.sequence = sequence;
    sample.device_time_ns = one.stamp_ns;
    sample.valid_axes = (1U << driver_.description().axes) - 1U;
    std::normal_distribution<double> noise(0.05, 1e-3);
    for (double& value : sample.value) value = constant_ ? 0.05 : noise(random_);
    std::fill(std::begin(sample.environment), std::end(sample.environment), 10.0);
    DriverInstance alone = make_driver(device_.name, with_rate(device_));
    const auto sink = [&](const ifog_sample& decoded) { one.value = decoded.value[0]; };
    if (driver_.takes_can()) {
      driver_.encode_can(sample, one.frames);
      for (const ifog_can_frame& frame : one.frames) alone.decode_can(frame, sink);
    } else {
      driver_.encode_bytes(sample, one.bytes);
      alone.decode_bytes(one.bytes, 0, sink);
    }
  }

  Device device_;
  DriverInstance driver_;
  std::mt19937 random_;
  bool constant_;
  std::size_t next_number_ = 0, power_ups_ = 0;
};

}  // namespace ifog
