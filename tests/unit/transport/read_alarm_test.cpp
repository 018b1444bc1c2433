// SPDX-License-Identifier: Apache-2.0
// A call that waits for bytes ends when another thread wishes it, at whichever moment of the way into the call.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/transport/clock.h"
#include "drivers/transport/file/file.h"
#include "drivers/transport/network/udp.h"
#include "drivers/transport/stoppable_wait.h"
#include "tests/unit/test.h"
#include "tests/unit/transport/forever.h"
#include "tests/unit/transport/loopback.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kLong_ns = 600'000'000'000;

TEST(ReadAlarm, RungOutsideACallKeepsTheThreadFromEnteringOne) {
  ReadAlarm& alarm = ReadAlarm::of_this_thread();
  ASSERT_TRUE(alarm.set(monotonic_ns() + kLong_ns));
  ReadAlarm::ring(alarm.number());
  while (alarm.enter()) alarm.leave();  // the signal comes within a moment
  EXPECT_FALSE(alarm.is_set(monotonic_ns() + kLong_ns));
  ASSERT_TRUE(alarm.set(monotonic_ns() + kLong_ns));
  EXPECT_TRUE(alarm.enter()) << "it rings once where there is no call to end";
  alarm.leave();
  alarm.off();
  EXPECT_FALSE(alarm.is_set(monotonic_ns() + kLong_ns));
}

// The reader is caught everywhere between the look whether it is stopped and deep in its call. One that was
// missed would hang for ten minutes.
TEST(ReadAlarm, StopEndsAReadWheneverItComes) {
  const test::OwnFolder folder;
  const std::string fifo = folder.path("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  std::mt19937 random(7);
  std::uniform_int_distribution<int> moment(0, 4000);
  for (int n = 0; n < 400; ++n) {
    const bool network = n % 2 == 1;
    const std::uint16_t port = network ? free_port(AF_INET, SOCK_DGRAM) : std::uint16_t{0};
    const auto transport =
        network ? make_udp_transport(on_loopback(port)) : make_file_transport(of_file(fifo));
    transport->open({});
    const int writer = open(fifo.c_str(), O_RDWR | O_CLOEXEC);
    // What has come once is read with calls that wait.
    const char byte = 'x';
    ASSERT_EQ(write(writer, &byte, 1), 1);
    LoopbackSocket gyro(AF_INET, SOCK_DGRAM);
    if (network) gyro.send_to(port, "x");
    ASSERT_EQ(transport->read(60s).bytes.size(), 1U);
    std::atomic<bool> reading{false};
    std::thread reader([&] {
      reading = true;
      while (!transport->stopped()) transport->read(600s);
    });
    while (!reading) std::this_thread::yield();
    std::atomic<int> spent{0};
    for (const int most = moment(random); spent < most; ++spent) {
    }
    transport->stop();
    reader.join();
    close(writer);
  }
}

}  // namespace
}  // namespace ifog
