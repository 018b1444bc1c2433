// SPDX-License-Identifier: Apache-2.0
// Devices that are switched off and on, seen or unseen, whose clock has ticks of every size and begins anew
// anywhere: no angle is made of it and none is lost, against all that was sent. Streams by chance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <random>

#include "filters/chain/incrementer.h"
#include "tests/unit/chain/sent_times.h"

namespace ifog {
namespace {

struct Device {
  double stated_hz, rate_hz;
  std::uint32_t modulus;  // 0: no counter
  std::int64_t tick_ns, wrap_ns;
  bool constant;          // it measures one value
  std::uint64_t portion;  // so many come at once
};

std::ostream& operator<<(std::ostream& out, const Device& d) {
  return out << d.stated_hz << " Hz, really " << d.rate_hz << ", modulus " << d.modulus << ", tick "
             << d.tick_ns << " ns, wrap " << d.wrap_ns << " ns, constant " << d.constant << ", by "
             << d.portion;
}

class Chance {
 public:
  explicit Chance(std::uint32_t seed) : random_(seed) {}
  double between(double least, double most) {
    return least + (most - least) * static_cast<double>(random_()) / 4294967296.0;
  }
  bool one_in(std::uint32_t many) { return random_() % many == 0; }
  template <typename T, std::size_t N>
  T of(const T (&all)[N]) {
    return all[random_() % N];
  }
  std::uint32_t below(std::uint32_t most) { return static_cast<std::uint32_t>(random_() % most); }

 private:
  std::mt19937 random_;
};

class Stream {
 public:
  explicit Stream(const Device& device) : device_(device), incrementer_(facts_of(device)) {}

  // From a power-up at that time on, by its clock and its counter.
  void power_up(double time_s, double own_s, std::uint64_t count, std::uint64_t samples, Chance& chance) {
    ++power_ups;
    for (std::uint64_t i = 0; i < samples; ++i) {
      const std::uint64_t last =
          std::min(samples - 1, i / device_.portion * device_.portion + device_.portion - 1);
      Reading reading;
      reading.arrival_ns =
          kStart_ns +
          std::llround((time_s + static_cast<double>(last) / device_.rate_hz + chance.between(0.0, 3e-4)) *
                       1e9);
      reading.valid_axes = 1;
      reading.value[0] = kTurning + (device_.constant ? 0.0 : 1e-6 * static_cast<double>(sent_++ % 1009));
      reading.has_sequence = device_.modulus > 0;
      reading.sequence = device_.modulus > 0 ? static_cast<std::uint32_t>((count + i) % device_.modulus) : 0;
      std::int64_t stamp_ns = std::llround((own_s + static_cast<double>(i) / device_.rate_hz) * 1e9);
      stamp_ns = stamp_ns / device_.tick_ns * device_.tick_ns;
      reading.device_time_ns = device_.wrap_ns > 0 ? stamp_ns % device_.wrap_ns : stamp_ns;
      reading.device_wrap_ns = device_.wrap_ns;
      truth_rad += reading.value[0] / device_.rate_hz;
      if (incrementer_.next(reading, increment_)) angle_rad += increment_.delta_theta_rad[0];
    }
  }
  // What a tick leaves open at each power-up, and three ticks in which one that is constant shows itself.
  [[nodiscard]] double open_rad() const {
    const double tick_s = 1e-9 * static_cast<double>(device_.tick_ns);
    const double learned_s = device_.constant ? 3.0 * tick_s : 0.0;
    return kTurning * ((2.0 / device_.rate_hz + 2.0 * tick_s) * static_cast<double>(power_ups) + learned_s) +
           kTurning * 1e-3;
  }

  double truth_rad = 0.0, angle_rad = 0.0;
  std::uint64_t power_ups = 0;

 private:
  static SensorFacts facts_of(const Device& device) {
    SensorFacts facts;
    facts.nominal_rate_hz = device.stated_hz;
    facts.sequence_modulus = device.modulus;
    return facts;
  }

  Device device_;
  Incrementer incrementer_;
  Increment increment_;
  std::uint64_t sent_ = 0;
};

// short_counter: of some bits, so that whole rounds of it pass while it is switched off.
void expect_no_angle(std::int64_t tick_ns, std::uint32_t seed, bool short_counter = false) {
  Chance chance(seed);
  const double stated_hz = chance.of({50.0, 100.0, 125.0, 200.0, 250.0, 400.0, 500.0, 1000.0});
  // Of one whose ticks are as long as its period should be, a clock alone cannot say that it is slower.
  const bool even = std::abs(stated_hz * 1e-9 * static_cast<double>(tick_ns) - 1.0) < 0.01;
  const double off = !even && chance.one_in(3) ? chance.between(-0.02, 0.02) : 0.0;
  const std::uint32_t modulus = short_counter ? chance.of({16U, 128U, 256U}) : chance.of({0U, 0U, 65'536U});
  const std::int64_t wrap_ns =
      chance.of({std::int64_t{0}, std::int64_t{65'536'000'000}, std::int64_t{4'294'967'296'000}});
  const Device device{stated_hz,
                      stated_hz * (1.0 + off),
                      modulus,
                      tick_ns,
                      wrap_ns,
                      modulus == 0 && chance.one_in(4),
                      chance.one_in(3) ? 2 + chance.below(short_counter ? 29 : 8) : 1};
  Stream stream(device);
  double time_s = 0.0;
  for (int i = 0; i < 3; ++i) {
    const auto samples = static_cast<std::uint64_t>(chance.between(3.0, 9.0) * device.rate_hz);
    const double own_s = chance.one_in(3) ? 0.0 : chance.between(0.0, 4000.0);
    stream.power_up(time_s, own_s, chance.one_in(2) ? 0 : chance.below(100'000), samples, chance);
    time_s += static_cast<double>(samples) / device.rate_hz + chance.between(0.6, 25.0);
  }
  EXPECT_NEAR(stream.angle_rad, stream.truth_rad, stream.open_rad()) << "seed " << seed << ": " << device;
}

TEST(BegunAnew, WhateverItsClockTicksNoAngleIsMadeOrLost) {
  for (const std::int64_t tick_ns : {1000, 1'000'000, 10'000'000, 100'000'000})
    for (std::uint32_t seed = 1; seed <= 200; ++seed) expect_no_angle(tick_ns, seed);
}

// The rounds of a pause are told seconds later, by a sample whose own step of the clock knows nothing of
// them.
TEST(BegunAnew, NorIsItWhereTheCounterGoesRoundMeanwhile) {
  for (const std::int64_t tick_ns : {1000, 1'000'000, 10'000'000, 100'000'000})
    for (std::uint32_t seed = 1; seed <= 300; ++seed) expect_no_angle(tick_ns, seed, true);
}

// Twice the same frame each time, of a device that measures one value: those are no ticks of its clock.
TEST(BegunAnew, FramesThatComeTwiceAreNoTicks) {
  SensorFacts facts;
  facts.nominal_rate_hz = 200.0;
  Incrementer incrementer(facts);
  Increment increment;
  for (std::int64_t n = 0; n < 2000; ++n) {
    Reading reading;
    reading.arrival_ns = kStart_ns + n * 2'500'000;
    reading.valid_axes = 1;
    reading.value[0] = kTurning;
    reading.device_time_ns = n / 2 * 5'000'000;
    EXPECT_EQ(incrementer.next(reading, increment), n % 2 == 0) << n;
  }
  EXPECT_EQ(incrementer.counts().missing, 0U);
}

}  // namespace
}  // namespace ifog
