// SPDX-License-Identifier: Apache-2.0
// What a running pipeline says of itself.
#include "filters/allan/streaming.h"
#include "tests/unit/daemon/rig.h"
#include "tests/unit/messages.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

// What the estimator has counted is the sensor's, not that of the parts a reload brings.
TEST(PipelineStatus, CountersGoOnOverAReload) {
  constexpr int kCount = 4000, kHalf = 2000;
  // In noise as the filter is configured for, or it finds that there is none and that everything is motion.
  test::Noise normal(3, 1e-4);
  const auto spikes = [&](int n) { return normal() + (n % 250 == 249 ? 0.5 : 0.0); };
  Rig rig(frames(kCount, spikes), kFrame, true);
  rig.transport->allowed_ = kHalf * kFrame;
  rig.transport->stays_open_ = true;
  rig.pipeline->start();
  const auto look = [&](std::size_t messages) {
    rig.await_messages(messages);
    return rig.status(rig.snapshot());
  };
  const status_t before = look(kHalf);
  EXPECT_EQ(before.gated, kHalf / 250);
  rig.pipeline->filter().offer(std::make_unique<ChainParts>(rig.chain));
  rig.transport->allowed_ = (kHalf + 10) * kFrame;
  const status_t after = look(kHalf + 10);
  EXPECT_EQ(after.filter_resets, 1);
  EXPECT_EQ(after.gated, before.gated);
  EXPECT_GE(after.floor_hits, before.floor_hits);
  EXPECT_FALSE(test::has(rig.report->moved(), "+-")) << rig.report->moved();
  rig.transport->allowed_ = ~std::size_t{0};
  EXPECT_GE(look(kCount).gated, kCount / 250);
  rig.pipeline->stop();
}

TEST(PipelineStatus, InputThatIsNoneOfTheSensorsIsAFaultInWords) {
  for (const bool rubbish : {true, false}) {
    Rig rig(rubbish ? std::vector<std::uint8_t>(50 * kFrame) : frames(50), kFrame, true);
    rig.transport->stays_open_ = true;
    rig.transport->stray_ = rubbish;  // long ago, and not what is wrong now
    rig.pipeline->start();
    while (rig.pipeline->reader().books().line.bytes < 50 * kFrame) std::this_thread::sleep_for(1ms);
    std::string fault;
    for (int second = 0; second < 8; ++second) {
      FilterSnapshot snapshot;
      snapshot.reader = rig.pipeline->reader().books();
      fault = rig.status(snapshot).fault;
    }
    EXPECT_EQ(fault, rubbish
                         ? "bytes received and no frame of the sensor in them: check driver, options and baud"
                         : "");
    rig.pipeline->stop();
  }
}

// A vehicle that does not stop: what is published is not denoised, and that is said once, after a minute.
TEST(PipelineStatus, NoiseThatIsNotLearnedIsTold) {
  for (const double noise : {0.0, 1e-8}) {
    Rig rig(frames(50), kFrame, true);
    rig.transport->stays_open_ = true;
    rig.pipeline->start();
    while (rig.pipeline->reader().books().line.bytes < 50 * kFrame) std::this_thread::sleep_for(1ms);
    std::vector<int> told;
    for (int second = 1; second < 200; ++second) {
      FilterSnapshot snapshot;
      snapshot.reader = rig.pipeline->reader().books();
      snapshot.reader.counts.samples += 100 * static_cast<std::uint64_t>(second);
      snapshot.health.measurement_noise[0] = noise;
      (void)rig.status(snapshot);
      if (test::has(rig.report->unknown_noise(), "ifog tune")) told.push_back(second);
    }
    EXPECT_EQ(told, noise > 0.0 ? std::vector<int>{} : std::vector<int>{60});
    rig.pipeline->stop();
  }
}

// Two devices on one line: in the books, in the state and in words; and what is published is not their sum.
TEST(PipelineStatus, FramesOfTwoDevicesAreNotTakenAndToldInWords) {
  constexpr std::size_t kCount = 4000, kApart = 40;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 1e-4);
  const auto turning = [&](double radps) {
    return [&normal, &random, radps](int n) { return radps - rate_of(n) + normal(random); };
  };
  const std::vector<std::uint8_t> one = frames(kCount, turning(0.1)),
                                  other = frames(kCount + kApart, turning(-0.4));
  std::vector<std::uint8_t> line;
  for (std::size_t n = 0; n < kCount; ++n) {
    line.insert(line.end(), one.begin() + n * kFrame, one.begin() + (n + 1) * kFrame);
    line.insert(line.end(), other.begin() + (n + kApart) * kFrame, other.begin() + (n + kApart + 1) * kFrame);
  }
  Rig rig(line, kFrame, true);
  rig.transport->stays_open_ = true;
  rig.pipeline->start();
  while (rig.pipeline->reader().books().decoded < 2 * kCount) std::this_thread::sleep_for(1ms);
  const FilterSnapshot snapshot = rig.snapshot();
  const status_t status = rig.status(snapshot);
  EXPECT_EQ(status.state, status_t::STATE_NO_DATA);
  EXPECT_TRUE(status.fault.starts_with("the sequence runs to and fro")) << status.fault;
  EXPECT_EQ(status.samples_decoded, static_cast<std::int64_t>(2 * kCount));
  EXPECT_EQ(status.samples_in + status.samples_repeated, status.samples_decoded);
  EXPECT_GT(status.samples_repeated, static_cast<std::int64_t>(kCount));
  rig.pipeline->stop();
  const std::vector<rate_t> messages = rig.publisher->messages();
  ASSERT_FALSE(messages.empty());
  double angle_rad = 0.0;
  for (const rate_t& message : messages) angle_rad += message.delta_theta[0];
  const double taken_s = 1e-3 * static_cast<double>(messages.size());
  EXPECT_LT(taken_s, 1.0);
  EXPECT_NEAR(angle_rad, 0.1 * taken_s, 0.5 * 0.03);
}

// Reader and filter are asked at one instant: what is read between the answer and the report is not waiting.
TEST(PipelineStatus, WhatIsReadAfterTheFiltersAnswerIsNotWaiting) {
  Rig rig(frames(1000), kFrame, true);
  rig.transport->allowed_ = 100 * kFrame;
  rig.transport->stays_open_ = true;
  rig.pipeline->start();
  while (rig.publisher->messages().size() < 100 || rig.pipeline->reader().books().line.bytes < 100 * kFrame)
    std::this_thread::sleep_for(1ms);
  const FilterSnapshot snapshot = rig.snapshot();
  rig.transport->allowed_ = ~std::size_t{0};
  while (rig.pipeline->reader().books().counts.samples < 1000) std::this_thread::sleep_for(1ms);
  const status_t& status = rig.status(snapshot);
  EXPECT_EQ(status.samples_waiting, 0);
  EXPECT_EQ(status.samples_in, 100);
  EXPECT_EQ(status.samples_published, 100);
  EXPECT_EQ(status.bytes_read, static_cast<std::int64_t>(100 * kFrame));
  rig.pipeline->stop();
}

// However late the last question was asked, and whether or not its answer was fetched: what housekeeping says
// at the end of a file tells of the file's last sample, and is not the latency of an earlier second.
TEST(PipelineStatus, TheLastWordTellsOfTheLastSample) {
  constexpr int kCount = 1033, kHalf = 500;
  Rig rig(frames(kCount), kFrame, true);
  rig.transport->allowed_ = kHalf * kFrame;
  rig.pipeline->start();
  rig.await_messages(kHalf);
  rig.pipeline->filter().ask();
  std::this_thread::sleep_for(20ms);  // answered, and not fetched
  rig.transport->allowed_ = ~std::size_t{0};
  rig.wait_for_the_end();
  FilterSnapshot snapshot;
  ASSERT_TRUE(rig.pipeline->filter().take_snapshot(snapshot));
  EXPECT_NEAR(snapshot.channel[0], temperature_of(kCount - 1), 1e-3);  // read in 1/100 °C
  rig.pipeline->filter().ask();
  ASSERT_TRUE(rig.pipeline->filter().take_snapshot(snapshot));
  EXPECT_NEAR(snapshot.channel[0], temperature_of(kCount - 1), 1e-3);  // read in 1/100 °C
  EXPECT_EQ(snapshot.latency.count(), 0U);
}

// Of what was published, by axis, and the same at the other end of the message.
TEST(PipelineStatus, TheStatusCarriesTheAllanDeviation) {
  constexpr int kCount = 4000;
  Rig rig(kvh_frames(0, kCount, [](int n, int axis) { return (1 + axis) * rate_of(n); }), kFrame, true);
  rig.transport->stays_open_ = true;
  rig.pipeline->start();
  rig.await_messages(kCount);
  const FilterSnapshot snapshot = rig.snapshot();
  rig.pipeline->stop();
  const std::vector<std::uint8_t> bytes = encoded(rig.status(snapshot));
  status_t status{};
  ASSERT_GT(status.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
  ASSERT_GT(status.octaves, 8);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    StreamingAllan published;
    for (const rate_t& message : rig.publisher->messages()) published.add(message.compensated[axis]);
    ASSERT_EQ(status.octaves, published.octaves());
    for (int k = 0; k < status.octaves; ++k)
      EXPECT_EQ(status.allan_rate_radps[axis][static_cast<std::size_t>(k)], published.deviation(k)) << k;
  }
  EXPECT_NEAR(status.allan_tau0_s, 1e-3, 1e-15);
}

}  // namespace
}  // namespace ifog
