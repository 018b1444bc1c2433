// SPDX-License-Identifier: Apache-2.0
// What of the CAN transport can be seen without a kernel that has CAN: the two forms of a frame, and the
// refusals. The rest runs on vcan in tests/system.
#include "drivers/transport/can/can.h"

#include <gtest/gtest.h>
#include <linux/can/raw.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

#include "drivers/transport/can/can_socket.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/receiving_socket.h"

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

// The kernel's own control messages, of a datagram socket that every kernel has.
TEST(ReceiveControl, ReadsTheKernelsTime) {
  int fds[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_DGRAM, 0, fds), 0);
  const int on = 1;
  ASSERT_EQ(setsockopt(fds[1], SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on), 0);
  const std::int64_t before = ifog::realtime_ns();
  ASSERT_EQ(write(fds[0], "x", 1), 1);
  char byte = 0;
  iovec vector{&byte, 1};
  alignas(cmsghdr) unsigned char control[256]{};
  msghdr message{};
  message.msg_iov = &vector;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  ASSERT_EQ(recvmsg(fds[1], &message, 0), 1);
  const std::int64_t after = ifog::realtime_ns();
  close(fds[0]);
  close(fds[1]);
  const std::int64_t arrival = ifog::receive_control(message).arrival_ns;
  if (arrival == 0) GTEST_SKIP() << "this kernel stamps no datagrams of AF_UNIX; any Linux of its own does";
  EXPECT_GE(arrival, before);
  EXPECT_LE(arrival, after);
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

}  // namespace
