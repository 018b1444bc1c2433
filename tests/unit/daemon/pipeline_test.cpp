// Whole pipelines, from bytes to encoded messages: two real threads, the real plugin, a publisher that keeps
// all.
#include "daemon/pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <ifog/rate_t.hpp>
#include <mutex>
#include <thread>
#include <vector>

#include "daemon/housekeeping/status_report.h"
#include "drivers/host/driver_instance.h"
#include "drivers/transport/clock.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kFrame = 36;

// Hands out what it was given, in portions, as fast as it is asked.
class MemoryTransport final : public Transport {
 public:
  MemoryTransport(std::vector<std::uint8_t> bytes, std::size_t portion, bool holds_back)
      : Transport("memory"), bytes_to_give_(std::move(bytes)), portion_(portion), holds_back_(holds_back) {}
  void connect(std::string&) override {}
  Delivery receive(std::int64_t) noexcept override {
    Delivery out;
    const bool all_given = at_ >= bytes_to_give_.size();
    if (all_given && !stays_open_.load()) end(0);
    if (all_given || at_ >= allowed_.load()) {
      if (state() != TransportState::ended) std::this_thread::sleep_for(1ms);
      return out;
    }
    const std::size_t n = std::min(portion_, bytes_to_give_.size() - at_);
    out.bytes = std::span(bytes_to_give_).subspan(at_, n);
    out.arrival_ns = realtime_ns();
    at_ += n;
    given_.store(at_);
    return out;
  }
  [[nodiscard]] bool holds_back() const override { return holds_back_; }

 private:
  std::vector<std::uint8_t> bytes_to_give_;
  std::size_t portion_, at_ = 0;
  bool holds_back_;

 public:
  std::atomic<std::size_t> given_{0};
  std::atomic<std::size_t> allowed_{~std::size_t{0}};  // no more than this is given yet
  std::atomic<bool> stays_open_{false};
};

class KeepingPublisher final : public Publisher {
 public:
  explicit KeepingPublisher(std::chrono::microseconds pause = 0us) : pause_(pause) {}
  bool publish(const char* channel, std::span<const std::uint8_t> message) noexcept override {
    rate_t decoded{};
    const bool good = decoded.decode(message.data(), 0, static_cast<int>(message.size())) > 0;
    const std::lock_guard lock(mutex_);
    if (good && std::string(channel) == "IFOG_TEST") messages_.push_back(decoded);
    if (pause_ > 0us) std::this_thread::sleep_for(pause_);
    return good;
  }
  std::vector<rate_t> messages() {
    const std::lock_guard lock(mutex_);
    return messages_;
  }

 private:
  std::chrono::microseconds pause_;
  std::mutex mutex_;
  std::vector<rate_t> messages_;
};

double rate_of(int n) { return 0.01 + 1e-4 * std::sin(0.01 * n); }

double temperature_of(int n) { return n % 50; }

std::vector<std::uint8_t> frames(int count) {
  DriverInstance driver = make_driver("kvh1750", {{"format", "a"}});
  std::vector<std::uint8_t> out;
  for (int n = 0; n < count; ++n) {
    ifog_sample sample{};
    sample.flags = IFOG_SAMPLE_SEQUENCE;
    sample.sequence = static_cast<std::uint32_t>(n % 128);
    sample.valid_axes = 7;
    for (double& value : sample.value) value = rate_of(n);
    for (double& value : sample.environment) value = temperature_of(n);
    sample.environment_fresh = ~0U;
    driver.encode_bytes(sample, out);
  }
  return out;
}

struct Rig {
  Rig(std::vector<std::uint8_t> bytes, std::size_t portion, bool holds_back, std::size_t slots = 1024,
      std::chrono::microseconds pause = 0us, bool direct = true) {
    DriverInstance driver = make_driver("kvh1750", {});
    PipelinePlan plan;
    plan.lcm_channel = "IFOG_TEST";
    plan.facts = sensor_facts(driver.description(), 1000.0, 0);
    plan.ring_slots = slots;
    plan.direct = direct;
    plan.reader.name = "read";
    plan.filter.name = "filter";
    chain.facts = plan.facts;
    chain.axes = {"x", "y", "z"};
    for (std::uint32_t i = 0; i < driver.description().environments; ++i) {
      chain.channels.emplace_back(driver.description().environment[i]);
      chain.channel_max_age_s.push_back(10.0);
    }
    chain.filter.process_noise = 1e-10;
    chain.filter.measurement_noise = 1e-8;
    auto memory = std::make_unique<MemoryTransport>(std::move(bytes), portion, holds_back);
    transport = memory.get();
    auto keeping = std::make_unique<KeepingPublisher>(pause);
    publisher = keeping.get();
    pipeline = std::make_unique<Pipeline>(plan, std::move(memory), std::move(driver), nullptr,
                                          std::make_unique<ChainParts>(chain), std::move(keeping));
    pipeline->open();
  }
  void run_to_the_end() {
    pipeline->start();
    wait_for_the_end();
  }
  // One frame at a time until the reader has found the filter thread asleep, then the rest.
  void run_from_rest_to_the_end() {
    transport->allowed_ = 0;
    pipeline->start();
    while (pipeline->hand_over().done_here() == 0) {
      transport->allowed_ += kFrame;
      std::this_thread::sleep_for(5ms);
    }
    transport->allowed_ = ~std::size_t{0};
    wait_for_the_end();
  }
  void wait_for_the_end() {
    while (!pipeline->ended()) std::this_thread::sleep_for(1ms);
    pipeline->stop();
  }
  ChainSettings chain;
  MemoryTransport* transport;
  KeepingPublisher* publisher;
  std::unique_ptr<Pipeline> pipeline;
};

double sent_angle(int count) {
  double sum = 0.0;
  for (int n = 0; n < count; ++n) sum += static_cast<double>(static_cast<float>(rate_of(n))) * 1e-3;
  return sum;
}

TEST(Pipeline, EverySampleIsPublishedInOrder) {
  constexpr int kCount = 5000;
  Rig rig(frames(kCount), 100, true);
  rig.run_to_the_end();
  const std::vector<rate_t> messages = rig.publisher->messages();
  ASSERT_EQ(messages.size(), static_cast<std::size_t>(kCount));
  for (int n = 0; n < kCount; ++n) {
    const rate_t& message = messages[static_cast<std::size_t>(n)];
    ASSERT_EQ(message.seq, n);
    ASSERT_EQ(message.merged, 1);
    ASSERT_EQ(message.raw[0], static_cast<double>(static_cast<float>(rate_of(n))));
    ASSERT_EQ(message.dt, 1e-3);
    ASSERT_EQ(message.flags & rate_t::FLAG_GAP, 0);
  }
  EXPECT_NEAR(messages.back().angle[2], sent_angle(kCount), 1e-14);
  EXPECT_EQ(rig.pipeline->reader().counters().frames_good.value(), static_cast<std::uint64_t>(kCount));
}

TEST(Pipeline, TwoRunsGiveTheSameBits) {
  const std::vector<std::uint8_t> bytes = frames(2000);
  // One frame a delivery and by whichever thread is awake; many, and all steps by the filter thread.
  Rig one(bytes, 36, true), other(bytes, 1001, true, 1024, 0us, false);
  one.run_from_rest_to_the_end();
  other.run_to_the_end();
  EXPECT_GT(one.pipeline->hand_over().done_here(), 0U);
  EXPECT_EQ(other.pipeline->hand_over().done_here(), 0U);
  const std::vector<rate_t> a = one.publisher->messages(), b = other.publisher->messages();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].denoised, b[i].denoised);
    ASSERT_EQ(a[i].variance, b[i].variance);
    ASSERT_EQ(a[i].angle, b[i].angle);
  }
}

TEST(Pipeline, AFilterThatCannotKeepUpLosesNoAngle) {
  constexpr int kCount = 3000;
  Rig rig(frames(kCount), kFrame, false, 8, 300us, false);
  rig.run_to_the_end();
  const std::vector<rate_t> messages = rig.publisher->messages();
  EXPECT_LT(messages.size(), static_cast<std::size_t>(kCount));
  EXPECT_GT(rig.pipeline->queue().overflows(), 0U);
  std::int64_t samples = 0;
  double angle = 0.0;
  bool flagged = false;
  for (const rate_t& message : messages) {
    samples += message.merged;
    angle += message.delta_theta[0];
    flagged = flagged || (message.flags & rate_t::FLAG_MERGED) != 0;
    ASSERT_EQ(message.merged > 1, (message.flags & rate_t::FLAG_MERGED) != 0);
  }
  EXPECT_EQ(samples, kCount);
  EXPECT_TRUE(flagged);
  EXPECT_NEAR(angle, sent_angle(kCount), 1e-13);
  EXPECT_NEAR(messages.back().angle[0], sent_angle(kCount), 1e-13);
}

// Each step takes longer than a sample: whenever the reader has done two itself it leaves the work to the
// filter thread for 16 deliveries, 32, 64 …, so that in 3000 it is held up a dozen times and no more.
TEST(Pipeline, AFilterThatIsSlowIsLeftToItsThread) {
  constexpr int kCount = 3000;
  Rig rig(frames(kCount), kFrame, false, 8, 1500us);
  const HandOver& hand_over = rig.pipeline->hand_over();
  rig.run_from_rest_to_the_end();
  EXPECT_EQ(hand_over.too_long(), hand_over.done_here());
  EXPECT_LE(hand_over.done_here(), 12U);
  EXPECT_GT(rig.pipeline->queue().merged(), 0U);
  const std::vector<rate_t> messages = rig.publisher->messages();
  EXPECT_NEAR(messages.back().angle[0], sent_angle(kCount), 1e-13);
}

// Merged increments, new filters and the LCM encoding together. The sum of what was sent is exact: every
// value is a whole multiple of 2^-30 rad/s, and their sum in whole numbers.
TEST(Pipeline, OverflowAndReloadsTogetherLoseNoAngle) {
  constexpr int kCount = 40'000;
  constexpr double kUnit = 1.0 / (1 << 30);
  DriverInstance driver = make_driver("kvh1750", {{"format", "a"}});
  std::vector<std::uint8_t> bytes;
  std::int64_t sum = 0;
  for (int n = 0; n < kCount; ++n) {
    const int units = (n * 7919) % 4001 - 1000;
    sum += units;
    ifog_sample sample{};
    sample.flags = IFOG_SAMPLE_SEQUENCE;
    sample.sequence = static_cast<std::uint32_t>(n % 128);
    sample.valid_axes = 7;
    for (double& value : sample.value) value = units * kUnit;
    sample.environment_fresh = ~0U;
    driver.encode_bytes(sample, bytes);
  }
  Rig rig(std::move(bytes), kFrame, false, 16, 20us, false);
  rig.pipeline->start();
  int reloads = 0;
  while (!rig.pipeline->ended()) {
    rig.pipeline->filter().offer(std::make_unique<ChainParts>(rig.chain));
    std::this_thread::sleep_for(2ms);
    rig.pipeline->filter().collect_retired();
    ++reloads;
  }
  rig.pipeline->stop();
  std::int64_t samples = 0;
  int resets = 0;
  double angle = 0.0, covered = 0.0;
  for (const rate_t& message : rig.publisher->messages()) {
    samples += message.merged;
    angle += message.delta_theta[1];
    covered += message.covered[1];
    resets += (message.flags & rate_t::FLAG_FILTER_RESET) != 0 ? 1 : 0;
    ASSERT_EQ(message.flags & rate_t::FLAG_GAP, 0);
  }
  const double sent = static_cast<double>(sum) * kUnit * 1e-3;
  EXPECT_EQ(samples, kCount);
  EXPECT_GT(rig.pipeline->queue().merged(), 0U);
  EXPECT_GT(resets, 2);
  EXPECT_GT(reloads, 2);
  EXPECT_NEAR(angle, sent, 1e-13);
  EXPECT_NEAR(rig.publisher->messages().back().angle[1], sent, 1e-13);
  EXPECT_NEAR(covered, kCount * 1e-3, 1e-9);
}

TEST(Pipeline, WhatHasBeenReadIsPublishedBeforeItStops) {
  Rig rig(frames(200'000), kFrame, false, 1 << 16, 20us);
  rig.pipeline->start();
  while (rig.transport->given_.load() < 500 * kFrame) std::this_thread::sleep_for(1ms);
  rig.pipeline->stop();
  const std::size_t given = rig.transport->given_.load() / kFrame;
  std::int64_t samples = 0;
  for (const rate_t& message : rig.publisher->messages()) samples += message.merged;
  EXPECT_EQ(samples, static_cast<std::int64_t>(given));
}

TEST(Pipeline, AReloadLosesNoSampleAndNoAngle) {
  constexpr int kCount = 20'000;
  Rig rig(frames(kCount), kFrame, true, 64, 5us);
  rig.pipeline->start();
  int reloads = 0;
  while (!rig.pipeline->ended()) {
    rig.pipeline->filter().offer(std::make_unique<ChainParts>(rig.chain));
    std::this_thread::sleep_for(2ms);
    rig.pipeline->filter().collect_retired();
    ++reloads;
  }
  rig.pipeline->stop();
  const std::vector<rate_t> messages = rig.publisher->messages();
  ASSERT_EQ(messages.size(), static_cast<std::size_t>(kCount));
  int resets = 0;
  for (int n = 0; n < kCount; ++n) {
    ASSERT_EQ(messages[static_cast<std::size_t>(n)].seq, n);
    resets += (messages[static_cast<std::size_t>(n)].flags & rate_t::FLAG_FILTER_RESET) != 0 ? 1 : 0;
  }
  EXPECT_GT(resets, 2);
  EXPECT_GT(reloads, 2);
  EXPECT_NEAR(messages.back().angle[1], sent_angle(kCount), 1e-13);
}

TEST(Pipeline, DamagedFramesAreCountedAndTheGapIsFlagged) {
  std::vector<std::uint8_t> bytes = frames(300);
  bytes[100 * kFrame + 10] ^= 0x40;
  bytes[101 * kFrame + 10] ^= 0x40;
  Rig rig(bytes, 77, true);
  rig.run_to_the_end();
  const std::vector<rate_t> messages = rig.publisher->messages();
  ASSERT_EQ(messages.size(), 298U);
  EXPECT_EQ(messages[100].seq, 102);
  EXPECT_NE(messages[100].flags & rate_t::FLAG_GAP, 0);
  EXPECT_NEAR(messages[100].dt, 3e-3, 1e-15);
  EXPECT_NEAR(messages[100].covered[0], 1e-3, 1e-15);
  EXPECT_EQ(rig.pipeline->reader().counters().missing.value(), 2U);
  Event event;
  ASSERT_TRUE(rig.pipeline->take_event(event));
  EXPECT_EQ(event.kind, EventKind::gap);
  EXPECT_EQ(event.count, 2U);
}

TEST(Pipeline, AFileCutOffWithinAFrameIsCounted) {
  std::vector<std::uint8_t> bytes = frames(50);
  bytes.resize(bytes.size() - 10);
  Rig rig(bytes, 77, true);
  rig.run_to_the_end();
  EXPECT_EQ(rig.publisher->messages().size(), 49U);
  EXPECT_EQ(rig.pipeline->reader().counters().bytes_skipped.value(), kFrame - 10);
}

TEST(Pipeline, HousekeepingGetsASnapshotWhileSamplesFlow) {
  Rig rig(frames(5000), kFrame, true, 64, 50us);
  rig.pipeline->start();
  FilterSnapshot snapshot;
  int taken = 0;
  while (!rig.pipeline->ended()) {
    rig.pipeline->filter().ask();
    std::this_thread::sleep_for(5ms);
    if (rig.pipeline->filter().take_snapshot(snapshot)) ++taken;
  }
  rig.pipeline->stop();
  EXPECT_GT(taken, 3);
  EXPECT_TRUE(snapshot.has_health);
  EXPECT_GT(snapshot.allan_octaves, 5);
}

// Reader and filter are asked at one instant: what is read between the answer and the report is not waiting.
TEST(Pipeline, WhatIsReadAfterTheFiltersAnswerIsNotWaiting) {
  Rig rig(frames(1000), kFrame, true);
  rig.transport->allowed_ = 100 * kFrame;
  rig.transport->stays_open_ = true;
  rig.pipeline->start();
  while (rig.publisher->messages().size() < 100 || rig.pipeline->reader().books().bytes_read < 100 * kFrame)
    std::this_thread::sleep_for(1ms);
  rig.pipeline->filter().ask();
  FilterSnapshot snapshot;
  while (!rig.pipeline->filter().take_snapshot(snapshot)) std::this_thread::sleep_for(1ms);
  rig.transport->allowed_ = ~std::size_t{0};
  while (rig.pipeline->reader().counters().samples.value() < 1000) std::this_thread::sleep_for(1ms);
  StatusReport report("test", rig.chain.channels, rig.chain.axes);
  const status_t& status = report.update(*rig.pipeline, snapshot, 1.0);
  EXPECT_EQ(status.samples_waiting, 0);
  EXPECT_EQ(status.samples_in, 100);
  EXPECT_EQ(status.samples_published, 100);
  EXPECT_EQ(status.bytes_read, static_cast<std::int64_t>(100 * kFrame));
  rig.pipeline->stop();
}

// However late the last question was asked, and whether or not its answer was fetched: what housekeeping says
// at the end of a file tells of the file's last sample, and is not the latency of an earlier second.
TEST(Pipeline, TheLastWordTellsOfTheLastSample) {
  constexpr int kCount = 1033, kHalf = 500;
  Rig rig(frames(kCount), kFrame, true);
  rig.transport->allowed_ = kHalf * kFrame;
  rig.pipeline->start();
  while (rig.publisher->messages().size() < kHalf) std::this_thread::sleep_for(1ms);
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

// By the definition (IEEE Std 952, overlapping) from what was published, at averaging times that the stream
// evaluates at every sample.
TEST(Pipeline, TheStatusCarriesTheAllanDeviation) {
  constexpr int kCount = 4000;
  Rig rig(frames(kCount), kFrame, true);
  rig.transport->stays_open_ = true;
  rig.pipeline->start();
  while (rig.publisher->messages().size() < kCount) std::this_thread::sleep_for(5ms);
  rig.pipeline->filter().ask();
  FilterSnapshot snapshot;
  while (!rig.pipeline->filter().take_snapshot(snapshot)) std::this_thread::sleep_for(1ms);
  rig.pipeline->stop();

  StatusReport report("test", {"temperature_degC"}, {"x", "y", "z"});
  const status_t& sent = report.update(*rig.pipeline, snapshot, 1.0);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(sent.getEncodedSize()));
  ASSERT_EQ(sent.encode(bytes.data(), 0, sent.getEncodedSize()), sent.getEncodedSize());
  status_t status{};
  ASSERT_GT(status.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);

  const std::vector<rate_t> messages = rig.publisher->messages();
  ASSERT_EQ(messages.size(), static_cast<std::size_t>(kCount));
  ASSERT_GT(status.octaves, 8);
  for (std::size_t octave = 0; octave < 3; ++octave) {
    const std::size_t m = std::size_t{1} << octave;
    double squares = 0.0, count = 0.0;
    for (std::size_t i = 0; i + 2 * m <= messages.size(); ++i) {
      double difference = 0.0;
      for (std::size_t k = 0; k < m; ++k)
        difference += messages[i + k].compensated[1] - messages[i + m + k].compensated[1];
      squares += difference * difference / static_cast<double>(m * m);
      count += 1.0;
    }
    const double deviation = std::sqrt(0.5 * squares / count);
    EXPECT_NEAR(status.allan_rate_radps[1][octave], deviation, 1e-9 * deviation) << "octave " << octave;
  }
  EXPECT_NEAR(status.allan_tau0_s, 1e-3, 1e-15);
}

}  // namespace
}  // namespace ifog
