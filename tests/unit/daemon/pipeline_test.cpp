// SPDX-License-Identifier: Apache-2.0
// Whole pipelines, from bytes to encoded messages.
#include <bot_core/kvh_raw_imu_batch_t.hpp>
#include <ifog/imu_t.hpp>

#include "daemon/pipeline/assemble.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/publish/encoders.h"
#include "tests/unit/daemon/rig.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

// One frame a delivery and by whichever thread is awake; many, and all steps by the filter thread.
TEST(Pipeline, EverySampleIsPublishedInOrderWithTheSameBitsInTwoRuns) {
  constexpr int kCount = 2000;
  const std::vector<std::uint8_t> bytes = frames(kCount);
  Rig one(bytes, 36, true), other(bytes, 1001, true, 1024, 0us, false);
  one.run_from_rest_to_the_end();
  other.run_to_the_end();
  EXPECT_GT(one.pipeline->hand_over().done_here(), 0U);
  EXPECT_EQ(other.pipeline->hand_over().done_here(), 0U);
  const std::vector<rate_t> a = one.publisher->messages(), b = other.publisher->messages();
  ASSERT_EQ(a.size(), static_cast<std::size_t>(kCount));
  ASSERT_EQ(b.size(), a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].seq, static_cast<int>(i));
    ASSERT_EQ(a[i].merged, 1);
    ASSERT_EQ(a[i].raw[0], static_cast<double>(static_cast<float>(rate_of(static_cast<int>(i)))));
    ASSERT_EQ(a[i].dt, 1e-3);
    ASSERT_EQ(a[i].flags & rate_t::FLAG_GAP, 0);
    ASSERT_EQ(a[i].denoised, b[i].denoised);
    ASSERT_EQ(a[i].variance, b[i].variance);
    ASSERT_EQ(a[i].angle, b[i].angle);
  }
  EXPECT_NEAR(a.back().angle[2], sent_angle(kCount), 1e-14);
  EXPECT_EQ(one.pipeline->reader().books().driver.frames_good, static_cast<std::uint64_t>(kCount));
}

// What LCM did not take is in the next message: who integrates has every increment once, and `dt` is the time
// since the message before.
TEST(Pipeline, IncrementsThatWereNotSentAreInTheNextMessage) {
  constexpr int kCount = 1000, kFrom = 300, kTo = 500;
  Rig rig(frames(kCount), kFrame, true);
  rig.publisher->imu_refused_from = kFrom;
  rig.publisher->imu_refused_to = kTo;
  rig.run_to_the_end();
  const std::vector<imu_t> increments = rig.publisher->increments();
  ASSERT_EQ(increments.size(), static_cast<std::size_t>(kCount - (kTo - kFrom)));
  double angle = 0.0, turned_s = 0.0, time_s = 0.0, moved_s = 0.0, velocity = 0.0;
  int samples = 0;
  for (const imu_t& each : increments) {
    angle += each.delta_theta[0];
    turned_s += each.turned_s[0];
    moved_s += each.moved_s[2];
    velocity += each.delta_v[2];
    time_s += each.dt;
    samples += each.merged;
  }
  EXPECT_EQ(samples, kCount);
  EXPECT_NEAR(angle, sent_angle(kCount), 1e-13);
  EXPECT_NEAR(turned_s, kCount * 1e-3, 1e-9);
  EXPECT_NEAR(moved_s, kCount * 1e-3, 1e-9);
  EXPECT_NEAR(time_s, kCount * 1e-3, 1e-9);
  Rig undisturbed(frames(kCount), kFrame, true);
  undisturbed.run_to_the_end();
  double expected = 0.0;
  for (const imu_t& each : undisturbed.publisher->increments()) expected += each.delta_v[2];
  EXPECT_NEAR(velocity, expected, 1e-9);
  const imu_t& after = increments[kFrom];
  EXPECT_EQ(after.seq, kTo);
  EXPECT_EQ(after.merged, kTo - kFrom + 1);
  EXPECT_NEAR(after.dt, (kTo - kFrom + 1) * 1e-3, 1e-9);
  EXPECT_NE(after.flags & rate_t::FLAG_MERGED, 0);
  EXPECT_EQ(increments[kFrom + 1].merged, 1);
  EXPECT_EQ(increments[kFrom + 1].flags & rate_t::FLAG_MERGED, 0);
}

// Merged increments, new filters and the encoding together: the sums of angle and velocity are exact. Accelerations
// travel as float32 in units of the standard gravity (the maker's format).
TEST(Pipeline, OverflowAndReloadsTogetherLoseNoAngleAndNoVelocity) {
  constexpr int kCount = 20'000;
  constexpr double kGravity = 9.80665;
  Rig rig(frames(kCount), kFrame, false, 16, 50us, false);
  rig.pipeline->start();
  while (!rig.pipeline->ended()) {
    rig.pipeline->filter().offer(std::make_unique<ChainParts>(rig.chain));
    std::this_thread::sleep_for(2ms);
    rig.pipeline->filter().collect_retired();
  }
  rig.pipeline->stop();
  const std::vector<imu_t> increments = rig.publisher->increments();
  const std::vector<rate_t> rates = rig.publisher->messages();
  ASSERT_EQ(increments.size(), rates.size());
  int samples = 0, resets = 0;
  double velocity = 0.0, angle = 0.0, moved_s = 0.0, covered_s = 0.0, sent = 0.0;
  for (std::size_t i = 0; i < increments.size(); ++i) {
    const imu_t& each = increments[i];
    ASSERT_EQ(each.seq, rates[i].seq);
    ASSERT_EQ(each.flags, rates[i].flags);
    ASSERT_EQ(each.utime, rates[i].utime);
    ASSERT_EQ(each.merged > 1, (each.flags & rate_t::FLAG_MERGED) != 0);
    ASSERT_EQ(each.flags & rate_t::FLAG_GAP, 0);
    resets += (each.flags & rate_t::FLAG_FILTER_RESET) != 0 ? 1 : 0;
    samples += each.merged;
    velocity += each.delta_v[2];
    angle += each.delta_theta[0];
    moved_s += each.moved_s[2];
    covered_s += rates[i].covered[1];
  }
  for (int n = 0; n < kCount; ++n)
    sent += static_cast<double>(static_cast<float>(temperature_of(n) / kGravity)) * kGravity * 1e-3;
  EXPECT_EQ(samples, kCount);
  EXPECT_GT(rig.pipeline->queue().merged(), 0U);
  EXPECT_GT(resets, 0);  // how many depends on the machine
  EXPECT_NEAR(velocity, sent, 1e-9);
  EXPECT_NEAR(angle, sent_angle(kCount), 1e-13);
  EXPECT_NEAR(rates.back().angle[1], sent_angle(kCount), 1e-13);
  EXPECT_NEAR(moved_s, kCount * 1e-3, 1e-9);
  EXPECT_NEAR(covered_s, kCount * 1e-3, 1e-9);
  EXPECT_NEAR(increments.back().temperature_degC, temperature_of(kCount - 1), 1e-9);
}

// Each step takes longer than a sample: whenever the reader has done two itself it leaves the work to the
// filter thread for 16 deliveries, 32, 64 …, so that in 3000 it is delayed a dozen times and no more.
TEST(Pipeline, AFilterThatIsSlowIsLeftToItsThread) {
  constexpr int kCount = 3000;
  Rig rig(frames(kCount), kFrame, false, 8, 1500us);
  const HandOver& hand_over = rig.pipeline->hand_over();
  rig.run_from_rest_to_the_end();
  EXPECT_LE(hand_over.done_here(), 12U);
  EXPECT_GT(rig.pipeline->queue().merged(), 0U);
  const std::vector<rate_t> messages = rig.publisher->messages();
  EXPECT_NEAR(messages.back().angle[0], sent_angle(kCount), 1e-13);
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
  EXPECT_EQ(rig.pipeline->reader().books().counts.missing, 2U);
  Event event;
  ASSERT_TRUE(rig.pipeline->take_event(event));
  EXPECT_EQ(event.kind, EventKind::gap);
  EXPECT_EQ(event.count, 2U);
}

// What the pipelines of several sensors have in common.

AssembledSensor reader_on(const std::string& cpus, ReadersProcessors& processors) {
  const Config config = parse_config(R"(
[daemon]
plugin_folder = ")" IFOG_BINARY_DIR R"(/plugins"
[[sensor]]
name = "nose"
driver = "kvh1750"
nominal_rate_hz = 100
[sensor.transport]
type = "serial"
device = "/dev/ttyS1"
[sensor.realtime]
reader_cpus = )" + cpus + "\n",
                                     "f.toml");
  return assemble(config.sensors.at(0), config, std::make_unique<KeepingPublisher>(), processors);
}

// Those that no thread stands back for before so many processors were worked on for three quarters.
void expect_to_be_of(SharedProcessors& shared, int processors) {
  constexpr std::int64_t kWindow = SharedProcessors::kWindow_ns;
  std::int64_t now = kWindow;
  shared.add(now, 0);
  shared.add(now += kWindow, processors * kWindow * 74 / 100);
  EXPECT_LT(shared.quiet_until_ns(), now) << processors;
  shared.add(now += kWindow, processors * kWindow * 76 / 100);
  EXPECT_GT(shared.quiet_until_ns(), now) << processors;
}

// However the configurations name them.
TEST(Assemble, ReadersOnTheSameProcessorsHaveOneAccountOfThem) {
  ReadersProcessors processors;
  const AssembledSensor a = reader_on("[0, 2]", processors), b = reader_on("[2, 0, 2]", processors),
                        c = reader_on("[2]", processors), d = reader_on("[]", processors),
                        e = reader_on("[]", processors);
  const auto account = [](const AssembledSensor& sensor) { return sensor.pipeline->plan().processors; };
  ASSERT_NE(account(a), nullptr);
  EXPECT_EQ(account(a), account(b));
  EXPECT_NE(account(a), account(c));
  ASSERT_NE(account(d), nullptr) << "readers that may run anywhere share all processors";
  EXPECT_EQ(account(d), account(e));
  EXPECT_NE(account(d), account(a));
  EXPECT_EQ(processors.size(), 3U);
  expect_to_be_of(*account(a), 2);
  expect_to_be_of(*account(c), 1);
  expect_to_be_of(*account(d), static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
}

TEST(InertialEncoder, SamplesThatWaitBeyondWhatTheirFieldHoldsAreItsMost) {
  const auto encoder = make_inertial_encoder(kImuType, SensorFacts{});
  Increment increment;
  increment.samples = 1'500'000'000;
  const ChainOutput out;
  imu_t message;
  for (const std::int32_t expected : {1'500'000'000, std::numeric_limits<std::int32_t>::max()}) {
    const auto bytes = encoder->encode(increment, out);
    ASSERT_GT(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
    EXPECT_EQ(message.merged, expected);
    encoder->sent(false);
  }
}

// Thirty samples, of which three came merged and one had an invalid axis: every packet has a period's angle,
// the counts are those of the device, and the sum is what was turned.
TEST(InertialEncoder, MergedSamplesAreAsManyPacketsOfABatch) {
  SensorFacts facts;
  facts.acceleration_channel = {0, 1, 2};
  const auto encoder = make_inertial_encoder(kKvhBatchType, facts);
  std::map<std::int64_t, double> turned;
  for (std::uint64_t n = 1; n <= 30; ++n) {
    if (n == 10 || n == 11) continue;
    Increment in;
    ChainOutput out;
    in.sequence = n;
    in.samples = n == 12 ? 3 : 1;
    in.utime_ns = static_cast<std::int64_t>(n) * 1'000'000;
    in.covered_s.fill(n == 20 ? 0.0 : 0.001 * in.samples);
    in.moved_s = in.covered_s;
    in.delta_v_mps.fill(9.81 * in.moved_s[0]);
    out.delta_theta_rad.fill(0.5 * in.covered_s[0]);
    const auto bytes = encoder->encode(in, out);
    EXPECT_EQ(bytes.empty(), n == 20);
    bot_core::kvh_raw_imu_batch_t batch;
    if (bytes.empty()) continue;
    ASSERT_GT(batch.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
    EXPECT_EQ(batch.raw_imu.front().packet_count, n);
    for (const auto& packet : batch.raw_imu) {
      EXPECT_NEAR(packet.delta_rotation[1], 0.0005, 1e-12);
      EXPECT_NEAR(packet.linear_acceleration[2], 9.81, 1e-9);
      EXPECT_EQ(packet.utime, packet.packet_count * 1000);
      turned[packet.packet_count] = packet.delta_rotation[0];
    }
  }
  EXPECT_EQ(turned.size(), 29U);
  EXPECT_EQ(turned.count(20), 0U);
}

}  // namespace
}  // namespace ifog
