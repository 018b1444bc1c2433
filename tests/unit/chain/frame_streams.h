// SPDX-License-Identifier: Apache-2.0
// What devices send and when it arrives, frame by frame, for the tests of what is made of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "filters/chain/incrementer.h"
#include "tests/unit/chain/sent_times.h"

namespace ifog {

struct SentFrame {
  double taken_s = 0.0, arrives_s = 0.0;
  std::uint64_t count = 0;
  double stamp_s = 0.0, value = 0.0;
};
using SentFrames = std::vector<SentFrame>;

// One device from power-up on: rate_radps and a noise of its own.
struct SendingDevice {
  double rate_hz = 1000.0, rate_radps = 0.1, noise_radps = 1e-4, begins_s = 0.0;
  std::uint64_t count = 0;
  double stamp_s = 0.0;

  [[nodiscard]] SentFrames send(double seconds, std::mt19937& random) const {
    std::normal_distribution<double> noise(0.0, 1.0);
    SentFrames out;
    const auto frames = static_cast<std::uint64_t>(std::llround(seconds * rate_hz));
    for (std::uint64_t n = 0; n < frames; ++n) {
      const double since_s = static_cast<double>(n) / rate_hz, at_s = begins_s + since_s;
      out.push_back({at_s, at_s + 2e-4, count + n, stamp_s + since_s,
                     rate_radps + (noise_radps > 0.0 ? noise_radps * noise(random) : 0.0)});
    }
    return out;
  }
};

inline SentFrames together(SentFrames a, const SentFrames& b) {
  a.insert(a.end(), b.begin(), b.end());
  std::stable_sort(a.begin(), a.end(),
                   [](const SentFrame& x, const SentFrame& y) { return x.arrives_s < y.arrives_s; });
  return a;
}

// They are read no sooner than every so often, all that have come by then at once.
inline SentFrames read_every(double seconds, SentFrames frames) {
  for (SentFrame& frame : frames) frame.arrives_s = std::ceil(frame.arrives_s / seconds) * seconds;
  return frames;
}

// modulus 0: no counter; wrap_ns: of the clock, 0 it does not go round. timed: it is known when frames came.
struct StreamFacts {
  double stated_hz = 1000.0;
  std::uint32_t modulus = 128;
  bool clocked = false, timed = true;
  SensorKind kind = SensorKind::rate;
};

struct StreamResult {
  double angle_rad = 0.0, covered_s = 0.0;
  IncrementerCounts counts;
  bool mixed = false;
  double mixed_from_s = -1.0, last_taken_s = -1.0;
};

inline StreamResult run_stream(const SentFrames& frames, const StreamFacts& of) {
  SensorFacts facts;
  facts.nominal_rate_hz = of.stated_hz;
  facts.sequence_modulus = of.modulus;
  facts.kind = of.kind;
  Incrementer incrementer(facts);
  Increment increment;
  StreamResult out;
  for (const SentFrame& frame : frames) {
    Reading reading;
    if (of.timed) reading.arrival_ns = kStart_ns + std::llround(frame.arrives_s * 1e9);
    reading.valid_axes = 1;
    reading.value[0] = of.kind == SensorKind::delta_angle ? frame.value / of.stated_hz : frame.value;
    reading.has_sequence = of.modulus > 0;
    reading.sequence = of.modulus > 0 ? static_cast<std::uint32_t>(frame.count % of.modulus) : 0;
    if (of.clocked) reading.device_time_ns = std::llround(frame.stamp_s * 1e9);
    if (incrementer.next(reading, increment)) {
      out.angle_rad += increment.delta_theta_rad[0];
      out.covered_s += increment.covered_s[0];
      out.last_taken_s = frame.taken_s;
    }
    if (incrementer.mixed() && out.mixed_from_s < 0.0) out.mixed_from_s = frame.taken_s;
  }
  out.counts = incrementer.counts();
  out.mixed = incrementer.mixed();
  return out;
}

}  // namespace ifog
