// SPDX-License-Identifier: Apache-2.0
// Two devices on one line: what is taken until that shows is the first one's, and of it so much as the two
// had in common; then nothing, until one of them has gone.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "tests/unit/chain/frame_streams.h"

namespace ifog {
namespace {

constexpr double kTen_s = 10.0;
constexpr double kFew = 30.0;  // samples that may be taken of either before it shows

// What comes is the first one's angle while it was taken, and not the sum of both.
void expect_found(const SentFrames& frames, const StreamFacts& facts, const SendingDevice& first,
                  double portion_s = 0.0) {
  const StreamResult got = run_stream(frames, facts);
  EXPECT_TRUE(got.mixed);
  EXPECT_GT(got.counts.mixed, 0U);
  EXPECT_GE(got.mixed_from_s, 0.0);
  EXPECT_LT(got.mixed_from_s, 1.0 + 1200.0 / facts.stated_hz);
  const double period_s = 1.0 / facts.stated_hz;
  const double shows_s = kFew * period_s + 10.0 * portion_s;
  EXPECT_LT(got.covered_s, got.mixed_from_s + shows_s);
  EXPECT_NEAR(got.angle_rad, first.rate_radps * got.covered_s, shows_s);
  EXPECT_EQ(got.counts.samples + got.counts.repeated, frames.size());
}

TEST(MixedDevices, TwoThatAreInterleavedAreFoundAndNotSummed) {
  for (const std::uint32_t modulus : {128U, 256U, 65'536U})
    for (const std::uint64_t apart : {2U, 5U, 8U, 13U, 40U, 64U, 100U, 127U}) {
      if (apart % modulus < 2 || modulus - apart % modulus < 2) continue;
      SCOPED_TRACE(testing::Message() << "modulus " << modulus << ", apart " << apart);
      std::mt19937 random(7 * modulus + static_cast<std::uint32_t>(apart));
      const SendingDevice a{1000.0, 0.1, 1e-4, 0.0, 3, 0.0};
      const SendingDevice b{1000.02, -0.4, 1e-4, 4e-4, 3 + apart, 0.0};
      expect_found(together(a.send(kTen_s, random), b.send(kTen_s, random)), {1000.0, modulus}, a);
    }
}

TEST(MixedDevices, HoweverTheyAreRead) {
  for (const double every_s : {0.001, 0.004, 0.016, 0.05}) {
    SCOPED_TRACE(every_s);
    std::mt19937 random(11);
    const SendingDevice a{1000.0, 0.1, 1e-4, 0.0, 3, 0.0}, b{999.97, -0.4, 1e-4, 4e-4, 57, 0.0};
    const SentFrames line = together(a.send(kTen_s, random), b.send(kTen_s, random));
    expect_found(read_every(every_s, line), {1000.0, 128}, a);
    // Each through a buffer of its own: the frames of one, then those of the other.
    const SentFrames a_then_b =
        together(read_every(every_s, a.send(kTen_s, random)), read_every(every_s, b.send(kTen_s, random)));
    expect_found(a_then_b, {1000.0, 128}, a, every_s);
  }
}

TEST(MixedDevices, WithDamagedFramesToo) {
  for (const double lost : {0.002, 0.02, 0.05}) {
    SCOPED_TRACE(lost);
    std::mt19937 random(13);
    const SendingDevice a{1000.0, 0.1, 1e-4, 0.0, 3, 0.0}, b{1000.01, -0.4, 1e-4, 4e-4, 57, 0.0};
    SentFrames line = together(a.send(kTen_s, random), b.send(kTen_s, random));
    std::bernoulli_distribution damaged(lost);
    std::erase_if(line, [&](const SentFrame&) { return damaged(random); });
    const StreamResult got = run_stream(line, {1000.0, 128});
    EXPECT_TRUE(got.mixed);
    EXPECT_LT(got.mixed_from_s, 3.0);
    EXPECT_LT(got.covered_s, got.mixed_from_s + 0.1);
  }
}

TEST(MixedDevices, OfConstantValuesAndOtherKinds) {
  std::mt19937 random(17);
  const SendingDevice a{1000.0, 0.1, 0.0, 0.0, 3, 0.0}, b{1000.01, -0.4, 0.0, 4e-4, 57, 0.0};
  const SentFrames line = together(a.send(kTen_s, random), b.send(kTen_s, random));
  expect_found(line, {1000.0, 128}, a);
  expect_found(line, {1000.0, 128, false, true, SensorKind::delta_angle}, a);
  expect_found(line, {1000.0, 128, false, false}, a);  // a recording of bytes without times
}

TEST(MixedDevices, ThreeOfThem) {
  std::mt19937 random(23);
  const SendingDevice a{1000.0, 0.1, 1e-4, 0.0, 3, 0.0}, b{1000.01, -0.4, 1e-4, 3e-4, 57, 0.0},
      c{999.99, 0.3, 1e-4, 6e-4, 100, 0.0};
  expect_found(together(together(a.send(kTen_s, random), b.send(kTen_s, random)), c.send(kTen_s, random)),
               {1000.0, 128}, a);
}

TEST(MixedDevices, OneThatIsPluggedInLaterAndOutAgain) {
  std::mt19937 random(29);
  const SendingDevice a{1000.0, 0.1, 1e-4, 0.0, 3, 0.0};
  const SendingDevice b{1000.02, -0.4, 1e-4, 10.0004, 57, 0.0};
  const StreamResult got = run_stream(together(a.send(40.0, random), b.send(kTen_s, random)), {1000.0, 128});
  EXPECT_FALSE(got.mixed);
  EXPECT_NEAR(got.mixed_from_s, 10.8, 0.3);
  EXPECT_NEAR(got.covered_s, 30.3, 0.7);
  EXPECT_NEAR(got.angle_rad, 0.1 * got.covered_s, 0.02);
  EXPECT_GT(got.last_taken_s, 39.99);
  // The other way: the first is taken away, and the second goes on.
  const SentFrames rest =
      together(a.send(20.0, random), SendingDevice{1000.02, -0.4, 1e-4, 10.0004, 57, 0.0}.send(30.0, random));
  const StreamResult other = run_stream(rest, {1000.0, 128});
  EXPECT_FALSE(other.mixed);
  EXPECT_NEAR(other.angle_rad, 0.1 * 10.3 - 0.4 * 19.7, 0.5);
}

}  // namespace
}  // namespace ifog
