// SPDX-License-Identifier: Apache-2.0
// Heap allocations between the first and the last sample of a running pipeline, the send on LCM's UDP
// included.
//
// LCM is multicast: the program moves into a network namespace of its own first, so that nothing leaves the
// machine.
#include "drivers/transport/file/file.h"
#include "tests/unit/daemon/private_network.h"
#include "tests/unit/daemon/rig.h"
#include "tests/unit/malloc_counter.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

TEST(Allocation, NoneBetweenTheFirstAndTheLastSample) {
  if (!test::allocations_can_be_counted())
    GTEST_SKIP() << "a sanitizer has its own malloc; runs in the release build";
  ASSERT_TRUE(test::allocation_counter_works());
  if (const std::string why = enter_private_network(); !why.empty())
    GTEST_SKIP() << "no private network namespace (" << why << "); runs as root or with user namespaces";
  constexpr int kCount = 2000;
  const test::OwnFolder folder;
  const std::vector<std::uint8_t> bytes = kvh_frames(0, kCount, [](int n) { return 0.01 + 1e-5 * (n % 17); });
  folder.write("gyro.kvh", {bytes.begin(), bytes.end()});
  // Recorded, too; the recorder thread, which may allocate, does not run here.
  Tape tape(1U << 20U);
  PipelinePlan plan;
  plan.tape = &tape;
  plan.also = {{std::string(kImuType), "IFOG_TEST_IMU"},
               {std::string(kInertialType), "B"},
               {std::string(kInsType), "C"},
               {std::string(kMicrostrainType), "D"},
               {std::string(kKvhBatchType), "E"}};
  FileSettings file;
  file.path = folder.path("gyro.kvh");
  file.pace = FileSettings::Pace::recorded;
  file.bytes_per_second = 36.0 * 2000.0;
  file.block_bytes = 36;
  Rig rig(make_file_transport(file), make_lcm_publisher("udpm://239.255.76.67:7667?ttl=0"), plan);
  Pipeline& pipeline = *rig.pipeline;
  pipeline.start();
  const auto samples = [&] { return pipeline.reader().books().counts.samples; };
  while (samples() < 1 && !pipeline.ended()) std::this_thread::sleep_for(std::chrono::microseconds(100));
  test::count_allocations(true);
  const std::uint64_t from = samples();
  FilterSnapshot snapshot;
  bool answered = false;
  while (samples() < kCount - 10 && !pipeline.ended()) {
    pipeline.filter().ask();  // what housekeeping does must not make the filter thread allocate
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    answered = pipeline.filter().take_snapshot(snapshot) || answered;
  }
  test::count_allocations(false);
  const std::uint64_t to = samples();
  pipeline.stop();
  EXPECT_EQ(test::take_allocations(), 0U);
  EXPECT_GT(to - from, static_cast<std::uint64_t>(kCount) / 2);
  EXPECT_TRUE(answered);
  EXPECT_GT(tape.counters().deliveries.value(), to - from);
  ASSERT_TRUE(pipeline.filter().take_snapshot(snapshot));
  EXPECT_GE(snapshot.books.sent, to);
  EXPECT_EQ(snapshot.books.imu_failures, 0U);
}

}  // namespace
}  // namespace ifog
