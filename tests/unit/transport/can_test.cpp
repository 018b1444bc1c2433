// SPDX-License-Identifier: Apache-2.0
// What of the CAN transport can be seen without a kernel that has CAN: the two forms of a frame, and the
// refusals. The rest runs on vcan in tests/system.
#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/transport/can/can.h"
#include "drivers/transport/can/can_socket.h"
#include "drivers/transport/clock.h"
#include "tests/unit/test.h"
#include "tests/unit/transport/forever.h"

namespace {

using ifog::CanKind;

TEST(CanFrame, ComesFromTheSocketsForm) {
  canfd_frame raw{};
  ifog_can_frame frame{};
  raw.can_id = 0x123;
  raw.len = 3;
  raw.data[0] = 1;
  raw.data[2] = 3;
  raw.data[3] = 99;  // beyond the length: rubbish of an earlier frame
  ASSERT_EQ(ifog::from_socket(raw, 16, frame), CanKind::data);
  EXPECT_EQ(frame.id, 0x123U);
  EXPECT_EQ(frame.flags, 0);
  EXPECT_EQ(frame.length, 3);
  EXPECT_EQ(frame.data[2], 3);
  EXPECT_EQ(frame.data[3], 0);

  raw.can_id = 0x80000123U;
  raw.len = 64;
  raw.flags = 1;  // CANFD_BRS
  ASSERT_EQ(ifog::from_socket(raw, 72, frame), CanKind::data);
  EXPECT_EQ(frame.id, 0x123U);
  EXPECT_EQ(frame.flags, IFOG_CAN_EXTENDED | IFOG_CAN_FD | IFOG_CAN_BRS);
  EXPECT_EQ(frame.length, 64);

  raw.can_id = 0x40000123U;
  EXPECT_EQ(ifog::from_socket(raw, 16, frame), CanKind::remote);
  raw.can_id = 0x20000004U;
  EXPECT_EQ(ifog::from_socket(raw, 16, frame), CanKind::error);
  raw.can_id = 0x123;
  EXPECT_EQ(ifog::from_socket(raw, 10, frame), CanKind::unknown);
  raw.len = 200;  // a length no frame has must not reach beyond its data
  ASSERT_EQ(ifog::from_socket(raw, 16, frame), CanKind::data);
  EXPECT_EQ(frame.length, 8);
}

TEST(CanFrame, GoesIntoTheSocketsForm) {
  ifog_can_frame frame{};
  frame.id = 0x1ABCDEF0;
  frame.flags = IFOG_CAN_EXTENDED;
  frame.length = 8;
  frame.data[7] = 7;
  canfd_frame raw{};
  EXPECT_EQ(ifog::to_socket(frame, raw), 16U);
  EXPECT_EQ(raw.can_id, 0x9ABCDEF0U);
  EXPECT_EQ(raw.len, 8);
  EXPECT_EQ(raw.data[7], 7);

  // Data lengths a DLC stands for, ISO 11898-1: 0 to 8, 12, 16, 20, 24, 32, 48, 64.
  frame.flags = IFOG_CAN_FD | IFOG_CAN_BRS;
  for (const auto& [length, sent] :
       {std::pair{8, 8}, {9, 12}, {12, 12}, {13, 16}, {25, 32}, {33, 48}, {49, 64}, {64, 64}}) {
    frame.length = static_cast<std::uint8_t>(length);
    EXPECT_EQ(ifog::to_socket(frame, raw), 72U);
    EXPECT_EQ(raw.len, sent) << length;
    EXPECT_EQ(raw.flags, 1);
  }
}

std::string refusal(const ifog::CanSettings& settings, std::span<const std::uint8_t> opening = {}) {
  const auto transport = ifog::make_can_transport(settings);
  try {
    transport->open(opening);
  } catch (const ifog::OpenError& error) {
    EXPECT_EQ(transport->state(), ifog::TransportState::gone);
    EXPECT_EQ(transport->reason(), error.reason);
    return error.what();
  }
  return "accepted";
}

TEST(CanTransport, RefusesInOneLine) {
  const std::uint8_t byte = 0;
  EXPECT_EQ(refusal({.interface = "can7", .ids = {}}, {&byte, 1}),
            "can7: cannot send the driver's opening bytes: Operation not supported, expected a driver "
            "without them on CAN");
  const int probe = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  if (probe < 0) {
    EXPECT_EQ(refusal({.interface = "can7", .ids = {}}),
              "can7: cannot open a CAN socket: Address family not supported by protocol, expected a kernel "
              "with the modules can and can-raw");
    return;
  }
  close(probe);
  EXPECT_EQ(refusal({.interface = "nocan7", .ids = {}}),
            "nocan7: cannot open: No such device, expected a CAN interface (ip link show type can)");
  EXPECT_EQ(
      refusal({.interface = "lo", .ids = {}}),
      "lo: cannot open: Protocol wrong type for socket, expected a CAN interface, this one carries no CAN");
}

// The CAN transport on a virtual CAN interface, vcan0, which the tests take down and away: they need root and
// a kernel that has it (under user-mode Linux: tests/system).

using namespace std::chrono_literals;
using ifog::CanSettings;
using ifog::kForever;
using ifog::TransportState;

void ip(const std::string& what) { ASSERT_EQ(std::system(("ip link " + what).c_str()), 0) << what; }

class Vcan : public testing::Test {
 protected:
  void SetUp() override {
    const int probe = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    if (probe < 0) GTEST_SKIP() << "this kernel has no CAN sockets; modprobe can-raw vcan";
    close(probe);
    if (if_nametoindex("vcan0") == 0) GTEST_SKIP() << "no vcan0; ip link add vcan0 type vcan";
    if (geteuid() != 0) GTEST_SKIP() << "these take vcan0 down; run them as root";
    ip("set vcan0 mtu 72");
    ip("set vcan0 up");
  }
  static std::unique_ptr<ifog::Transport> opened(const CanSettings& settings) {
    auto transport = ifog::make_can_transport(settings);
    transport->open({});
    EXPECT_EQ(transport->notices().take_warning(), "");
    return transport;
  }
  static ifog_can_frame frame(std::uint32_t id, std::uint8_t first, int flags = 0, std::uint8_t length = 8) {
    ifog_can_frame f{};
    f.id = id;
    f.flags = static_cast<std::uint8_t>(flags);
    f.length = length;
    f.data[0] = first;
    return f;
  }
  // A sender of its own socket, as another program is.
  static void send(const std::vector<ifog_can_frame>& frames, std::uint32_t flag_bits = 0) {
    const ifog::CanSocket socket("vcan0");
    socket.receive_nothing();
    for (const ifog_can_frame& f : frames) {
      canfd_frame raw{};
      const std::size_t size = ifog::to_socket(f, raw);
      raw.can_id |= flag_bits;
      while (write(socket.fd(), &raw, size) != static_cast<ssize_t>(size)) ASSERT_EQ(errno, EAGAIN);
    }
  }
  static std::vector<ifog_can_frame> receive(ifog::Transport& transport, std::size_t n) {
    std::vector<ifog_can_frame> frames;
    while (frames.size() < n) {
      const ifog::Delivery d = transport.read(kForever);
      frames.insert(frames.end(), d.frames.begin(), d.frames.end());
    }
    return frames;
  }
};

TEST_F(Vcan, DeliversOnlyTheWantedFramesWithTheKernelsTime) {
  const auto transport = opened({.interface = "vcan0", .ids = {{0x123, false}, {0x123, true}}});
  const std::int64_t before = ifog::realtime_ns();
  send({frame(0x122, 1), frame(0x123, 2), frame(0x124, 3), frame(0x123, 4, IFOG_CAN_EXTENDED),
        frame(0x123, 5, IFOG_CAN_FD | IFOG_CAN_BRS, 64)});
  send({frame(0x123, 6)}, CAN_RTR_FLAG);
  send({frame(CAN_ERR_CRTL, 0), frame(CAN_ERR_BUSOFF, 0)}, CAN_ERR_FLAG);
  send({frame(0x123, 7)});
  const std::int64_t after = ifog::realtime_ns();
  const std::vector<ifog_can_frame> frames = receive(*transport, 4);
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(frames[0].data[0], 2);
  EXPECT_EQ(frames[1].data[0], 4);
  EXPECT_EQ(frames[1].flags, IFOG_CAN_EXTENDED);
  EXPECT_EQ(frames[2].data[0], 5);
  EXPECT_EQ(frames[2].flags, IFOG_CAN_FD | IFOG_CAN_BRS);
  EXPECT_EQ(frames[2].length, 64);
  EXPECT_EQ(frames[3].data[0], 7);
  std::int64_t last = before;
  for (const ifog_can_frame& f : frames) {
    EXPECT_GE(f.arrival_ns, last);
    last = f.arrival_ns;
  }
  // Read only now: a time taken at the reading would be later than the sending.
  EXPECT_LE(last, after);
  EXPECT_EQ(transport->counters().error_frames, 2U);
}

TEST_F(Vcan, CountsWhatTheKernelHadNoRoomFor) {
  const auto transport = opened({.interface = "vcan0", .ids = {}, .receive_buffer_bytes = 65536});
  constexpr std::size_t kFlood = 5000;
  send(std::vector<ifog_can_frame>(kFlood, frame(0x7, 1)));
  while (!transport->read(0ns).empty()) {
  }
  // No frame came after it that could have said so.
  const ifog::TransportCounters counted = transport->counters();
  EXPECT_GT(counted.kernel_drops, 0U);
  EXPECT_EQ(counted.frames + counted.kernel_drops, kFlood);
  send({frame(0x8, 2)});
  receive(*transport, 1);
  EXPECT_EQ(transport->counters().kernel_drops, counted.kernel_drops);
}

// Frames that wait for the reader when their interface goes, and those that there was no room for.
TEST_F(Vcan, WhatWaitedWhenTheInterfaceWentIsReadAndWhatDidNotFitIsCounted) {
  constexpr std::size_t kFlood = 5000;
  for (const bool removed : {false, true}) {
    const auto transport = opened({.interface = "vcan0", .ids = {}, .receive_buffer_bytes = 262144});
    send(std::vector<ifog_can_frame>(kFlood, frame(0x7, 1)));
    ip(removed ? "del vcan0" : "set vcan0 down");
    while (transport->state() == TransportState::open) transport->read(kForever);
    EXPECT_EQ(transport->reason(), removed ? ENODEV : ENETDOWN);
    const ifog::TransportCounters counted = transport->counters();
    EXPECT_GT(counted.frames, 64U);  // more than one delivery
    EXPECT_GT(counted.kernel_drops, 0U);
    EXPECT_EQ(counted.frames + counted.kernel_drops, kFlood);
    if (removed) ip("add vcan0 type vcan");
    ip("set vcan0 up");
  }
}

TEST_F(Vcan, WhatDidNotFitBeforeTheStopIsCounted) {
  const auto transport = opened({.interface = "vcan0", .ids = {}, .receive_buffer_bytes = 65536});
  constexpr std::size_t kFlood = 5000;
  send(std::vector<ifog_can_frame>(kFlood, frame(0x7, 1)));
  EXPECT_FALSE(transport->read(kForever).empty());
  transport->stop();
  EXPECT_TRUE(transport->read(kForever).empty());
  transport->close_books();
  EXPECT_GT(transport->counters().kernel_drops, kFlood / 2);
}

TEST_F(Vcan, ComesBackWhenTheInterfaceDoes) {
  const auto transport = opened({.interface = "vcan0", .ids = {}});
  for (int round = 0; round < 6; ++round) {
    const bool removed = round % 2 == 1;
    ip(removed ? "del vcan0" : "set vcan0 down");
    while (transport->state() == TransportState::open) transport->read(kForever);
    EXPECT_TRUE(transport->reason() == ENETDOWN || transport->reason() == ENODEV) << transport->reason();
    EXPECT_TRUE(transport->read(20ms).empty());
    EXPECT_EQ(transport->reason(), removed ? ENODEV : ENETDOWN);
    if (removed) ip("add vcan0 type vcan");
    ip("set vcan0 up");
    while (transport->state() == TransportState::gone) transport->read(1ms);
    send({frame(0x1, static_cast<std::uint8_t>(round))});
    const ifog::Delivery d = transport->read(kForever);
    ASSERT_EQ(d.frames.size(), 1U);
    EXPECT_TRUE(d.restarted);
    EXPECT_EQ(d.frames[0].data[0], round);
  }
  EXPECT_EQ(transport->counters().reopened, 6U);
}

TEST_F(Vcan, RefusesAnInterfaceThatIsDown) {
  ip("set vcan0 down");
  EXPECT_EQ(
      ifog::test::refusal([&] { ifog::make_can_transport({.interface = "vcan0", .ids = {}})->open({}); }),
      "vcan0: cannot open: Network is down, expected the interface up (ip link set vcan0 up)");
  ip("set vcan0 up");
}

}  // namespace
