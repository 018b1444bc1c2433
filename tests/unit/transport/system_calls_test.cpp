// SPDX-License-Identifier: Apache-2.0
// What a delivery costs in system calls: one that waits and reads, and no look before it. This program counts
// the looks itself: its ppoll stands before the C library's.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "drivers/transport/file/file.h"
#include "drivers/transport/network/tcp.h"
#include "drivers/transport/network/udp.h"
#include "tests/unit/own_folder.h"
#include "tests/unit/transport/forever.h"
#include "tests/unit/transport/loopback.h"
#include "tests/unit/transport/terminal.h"

namespace {
std::atomic<int> polled{0};
}

extern "C" int ppoll(pollfd* fds, nfds_t count, const timespec* span, const sigset_t* mask) {
  polled.fetch_add(1, std::memory_order_relaxed);
  timespec left = span != nullptr ? *span : timespec{};  // the system call writes to it
  return static_cast<int>(
      syscall(SYS_ppoll, fds, count, span != nullptr ? &left : nullptr, mask, sizeof(std::uint64_t)));
}

namespace ifog {
namespace {

using namespace std::chrono_literals;

constexpr int kDeliveries = 200;

// One byte at a time, each sent when the reader has had the one before.
void expect_no_look(Transport& transport, const std::function<void()>& send) {
  std::atomic<int> seen{0};
  std::thread reader([&] {
    while (!transport.stopped()) seen += static_cast<int>(transport.read(600s).bytes.size());
  });
  const auto deliver = [&](int count) {
    for (int n = 1; n <= count; ++n) {
      const int before = seen;
      send();
      while (seen == before) std::this_thread::sleep_for(100us);
    }
  };
  deliver(2);  // a FIFO is polled until somebody has written to it
  const int from = polled;
  deliver(kDeliveries);
  EXPECT_EQ(polled - from, 0);
  EXPECT_EQ(seen, kDeliveries + 2);
  transport.stop();
  reader.join();
}

void write_byte(int fd) {
  const char byte = 'x';
  ASSERT_EQ(write(fd, &byte, 1), 1);
}

TEST(SystemCalls, TheCountSeesALook) {
  const int before = polled;
  const auto transport = make_file_transport(of_file("/dev/null"));
  transport->open({});
  transport->read(1ms);
  EXPECT_GT(polled, before) << "a device is no pipe: polled";
}

TEST(SystemCalls, AFifoIsReadWithoutALook) {
  const test::OwnFolder folder;
  const std::string path = folder.path("fifo");
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const auto transport = make_file_transport(of_file(path));
  transport->open({});
  const int writer = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  expect_no_look(*transport, [&] { write_byte(writer); });
  close(writer);
}

TEST(SystemCalls, ASerialLineIsReadWithoutALook) {
  Gyro gyro;
  const auto transport = make_serial_transport({.device = "gyro", .baud = 921600}, gyro.opener());
  transport->open({});
  expect_no_look(*transport, [&] { gyro.send("x"); });
}

TEST(SystemCalls, DatagramsAreReadWithoutALook) {
  const std::uint16_t port = free_port(AF_INET, SOCK_DGRAM);
  const auto transport = make_udp_transport(on_loopback(port));
  transport->open({});
  const LoopbackSocket gyro(AF_INET, SOCK_DGRAM);
  expect_no_look(*transport, [&] { gyro.send_to(port, "x"); });
}

TEST(SystemCalls, AConnectionIsReadWithoutALook) {
  LoopbackSocket server(AF_INET, SOCK_STREAM);
  ASSERT_TRUE(server.bind(0));
  ASSERT_EQ(listen(server.fd(), 1), 0);
  const auto transport = make_tcp_transport({.host = "127.0.0.1", .port = server.port()});
  transport->open({});
  const int gyro = accept(server.fd(), nullptr, nullptr);
  expect_no_look(*transport, [&] { write_byte(gyro); });
  close(gyro);
}

}  // namespace
}  // namespace ifog
