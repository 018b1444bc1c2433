// SPDX-License-Identifier: Apache-2.0
// One device is never taken for two: one that repeats, by a second and longer way too, restarts, loses
// frames, has them in another order, is held up, or is polled. Streams by chance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include "tests/unit/chain/frame_streams.h"

namespace ifog {
namespace {

class Way {
 public:
  explicit Way(std::uint32_t seed) : random_(seed) {}
  double between(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  bool one_in(std::uint32_t many) { return random_() % many == 0; }
  template <typename T, std::size_t N>
  T of(const T (&all)[N]) {
    return all[random_() % N];
  }
  std::mt19937& random() { return random_; }

  void lose(SentFrames& frames) {
    const double part = between(0.0, 0.4);
    std::erase_if(frames, [&](const SentFrame&) { return between(0.0, 1.0) < part; });
  }
  void lose_portions(SentFrames& frames, std::uint64_t modulus) {
    const auto portion = static_cast<std::uint64_t>(between(1.0, 2.0 * static_cast<double>(modulus)));
    const auto every = static_cast<std::uint64_t>(between(1.0, 2.0 * static_cast<double>(modulus)));
    std::uint64_t n = 0;
    std::erase_if(frames, [&](const SentFrame&) { return n++ % (portion + every) >= every; });
  }
  // Every frame a second time, so many later.
  void repeat(SentFrames& frames, double rate_hz) {
    const double late_s = between(0.0, 200.0) / rate_hz;
    SentFrames again = frames;
    for (SentFrame& frame : again) frame.arrives_s += late_s;
    if (one_in(2)) lose(again);
    frames = together(std::move(frames), again);
  }
  void hold_up(SentFrames& frames) {
    const double from_s = between(1.0, 8.0), to_s = from_s + between(0.1, 6.0);
    for (SentFrame& frame : frames)
      if (frame.arrives_s > from_s && frame.arrives_s < to_s) frame.arrives_s = to_s;
  }
  void poll(SentFrames& frames, double period) {
    double next = 0.0;
    std::uint64_t n = 0;
    std::erase_if(frames, [&](const SentFrame&) {
      const bool taken = static_cast<double>(n++) >= next;
      if (taken) next += period;
      return !taken;
    });
  }
  // Each by one of two ways.
  void change_places(SentFrames& frames, double rate_hz) {
    const double late_s = between(0.0, 12.0) / rate_hz;
    const std::uint32_t many = of({2U, 3U, 20U});
    for (SentFrame& frame : frames)
      if (one_in(many)) frame.arrives_s += late_s;
    frames = together(std::move(frames), {});
  }

 private:
  std::mt19937 random_;
};

void expect_one(std::uint32_t seed) {
  Way way(seed);
  StreamFacts facts;
  facts.modulus = way.of({0U, 16U, 128U, 128U, 256U, 65'536U});
  facts.clocked = facts.modulus == 0 || way.one_in(3);
  facts.timed = !way.one_in(8);
  facts.stated_hz = way.of({50.0, 200.0, 1000.0});
  SendingDevice device;
  device.rate_hz = facts.stated_hz * (way.one_in(4) ? way.of({0.5, 0.97, 1.03, 2.0}) : 1.0);
  device.noise_radps = way.one_in(4) ? 0.0 : 1e-4;
  device.count = way.one_in(2) ? 0 : 1000;
  device.stamp_s = way.between(0.0, 1000.0);
  SentFrames frames = device.send(20.0, way.random());
  const bool restarts = way.one_in(3);
  if (restarts) {  // switched off and on, again and again
    double at_s = way.between(0.2, 5.0);
    const double every_s = way.between(0.1, 5.0);
    const auto anew = static_cast<std::uint64_t>(way.between(0.0, 3.0));
    double from_s = 0.0;
    std::uint64_t less = 0;
    for (SentFrame& frame : frames) {
      if (frame.taken_s >= at_s) {
        at_s += every_s;
        from_s = frame.taken_s;
        less = frame.count - anew;
      }
      frame.count -= less;
      frame.stamp_s -= from_s > 0.0 ? device.stamp_s + from_s : 0.0;
    }
  }
  const double rate_hz = device.rate_hz;
  const std::uint64_t round = facts.modulus > 0 ? facts.modulus : 128;
  std::string what = "modulus " + std::to_string(facts.modulus) + (facts.clocked ? " clocked" : "") +
                     (facts.timed ? "" : " untimed") + " at " + std::to_string(facts.stated_hz) + " really " +
                     std::to_string(device.rate_hz);
  if (restarts) what += ", restarts";
  const auto may = [&](bool does, const char* words) {
    if (does) what += std::string(", ") + words;
    return does;
  };
  if (may(way.one_in(3), "loses")) way.lose(frames);
  if (may(way.one_in(4), "loses portions")) way.lose_portions(frames, round);
  if (facts.timed && way.one_in(4))
    way.poll(frames, way.between(1.0, 3.0 * static_cast<double>(round % 1000)));
  if (facts.timed && way.one_in(6))
    way.poll(frames, 0.5 * static_cast<double>(std::min<std::uint64_t>(round, 256) + 1));
  if (may(way.one_in(4), "changes places")) way.change_places(frames, rate_hz);
  if (may(way.one_in(3), "repeats")) way.repeat(frames, rate_hz);
  if (may(way.one_in(3), "held up")) way.hold_up(frames);
  if (may(way.one_in(3), "read in portions")) frames = read_every(way.of({0.004, 0.016, 0.1}), frames);
  const StreamResult got = run_stream(frames, facts);
  EXPECT_EQ(got.counts.mixed, 0U) << "seed " << seed << ": " << what;
  EXPECT_LT(got.mixed_from_s, 0.0) << "seed " << seed << ": " << what;
}

TEST(OneDevice, IsNeverTakenForTwo) {
  for (std::uint32_t seed = 1; seed <= 800; ++seed) expect_one(seed);
}

// Whatever is lost, held up or overtaken on its way: of one device each frame that none behind it has
// overtaken is taken, also while it is doubtful whether there are two.
TEST(OneDevice, KeepsEveryFrameThatWasNotOvertaken) {
  for (std::uint32_t seed = 1; seed <= 400; ++seed) {
    Way way(seed);
    StreamFacts facts;
    facts.modulus = way.of({0U, 128U, 256U, 65'536U});
    facts.clocked = facts.modulus == 0 || way.one_in(3);
    facts.stated_hz = way.of({50.0, 200.0, 1000.0});
    SendingDevice device;
    device.rate_hz = facts.stated_hz;
    device.count = 1000;
    device.stamp_s = way.between(0.0, 1000.0);
    SentFrames frames = device.send(20.0, way.random());
    if (way.one_in(2)) way.lose(frames);
    if (!way.one_in(4)) way.change_places(frames, device.rate_hz);
    if (way.one_in(3)) frames = read_every(way.of({0.004, 0.016}), frames);
    std::uint64_t highest = 0, in_turn = 0;
    for (const SentFrame& frame : frames) {
      if (frame.count <= highest) continue;
      highest = frame.count;
      ++in_turn;
    }
    const StreamResult got = run_stream(frames, facts);
    EXPECT_EQ(frames.size() - got.counts.repeated, in_turn)
        << "seed " << seed << ", modulus " << facts.modulus << (facts.clocked ? ", clocked" : "") << ", "
        << facts.stated_hz << " Hz, " << frames.size() << " frames";
  }
}

// By a second way each frame comes again, later: the angle is that of the frames, once.
TEST(OneDevice, WhoseFramesComeTwiceHasItsAngleOnce) {
  for (const double late : {3.4, 20.4, 100.4, 150.4, 240.4}) {
    SCOPED_TRACE(late);
    std::mt19937 random(5);
    const SendingDevice device{1000.0, 0.1, 1e-4, 0.0, 3, 0.0};
    const SentFrames once = device.send(20.0, random);
    SentFrames again = once;
    for (SentFrame& frame : again) frame.arrives_s += late * 1e-3;
    const StreamResult got = run_stream(together(once, again), {1000.0, 128});
    EXPECT_FALSE(got.mixed);
    EXPECT_NEAR(got.covered_s, 20.0, 0.06);
    EXPECT_NEAR(got.angle_rad, 2.0, 0.006);
  }
}

// Two samples to a count, with values of their own.
TEST(OneDevice, ThatCountsEverySecondSampleIsOne) {
  std::mt19937 random(6);
  const SendingDevice device{1000.0, 0.1, 1e-4, 0.0, 3, 0.0};
  SentFrames frames = device.send(20.0, random);
  for (SentFrame& frame : frames) frame.count /= 2;
  EXPECT_EQ(run_stream(frames, {1000.0, 128}).counts.mixed, 0U);
}

}  // namespace
}  // namespace ifog
