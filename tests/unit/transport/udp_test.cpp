// SPDX-License-Identifier: Apache-2.0
// The UDP transport on the loopback.
#include <net/if.h>
#include <sys/ioctl.h>

#include "drivers/transport/clock.h"
#include "drivers/transport/network/udp.h"
#include "tests/unit/test.h"
#include "tests/unit/transport/forever.h"
#include "tests/unit/transport/loopback.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

std::string text_of(const Delivery& d) { return {d.bytes.begin(), d.bytes.end()}; }

class Udp : public BothFamilies {
 protected:
  void SetUp() override {
    BothFamilies::SetUp();
    if (IsSkipped()) return;
    settings_.port = free_port(GetParam(), SOCK_DGRAM);
    settings_.bind = address();
  }
  UdpSettings settings_;
};

INSTANTIATE_TEST_SUITE_P(Families, Udp, testing::Values(AF_INET, AF_INET6), BothFamilies::name);

TEST_P(Udp, EachDeliveryIsADatagramWithTheKernelsTimeOfIt) {
  const auto transport = make_udp_transport(settings_);
  transport->open({});
  EXPECT_EQ(transport->state(), TransportState::open);
  EXPECT_FALSE(transport->holds_back());
  LoopbackSocket gyro(GetParam(), SOCK_DGRAM);
  // The kernel begins to stamp some time after the first socket of a system has asked it to.
  std::uint64_t warm_ups = 0;
  for (bool stamped = false; !stamped && warm_ups < 500; ++warm_ups) {
    gyro.send_to(settings_.port, "warm up");
    const Delivery delivery = transport->read(kForever);
    EXPECT_EQ(text_of(delivery), "warm up");
    stamped = delivery.stamped;
    if (!stamped) std::this_thread::sleep_for(10ms);
  }
  const std::int64_t before = arrival_clock_ns();
  gyro.send_to(settings_.port, "first");
  std::this_thread::sleep_for(120ms);  // both are read together, long after they came
  const std::int64_t between = arrival_clock_ns();
  const std::string longest(65507 - 40, 'x');
  gyro.send_to(settings_.port, longest);
  const Delivery first = transport->read(kForever);
  EXPECT_EQ(text_of(first), "first");
  EXPECT_TRUE(first.stamped);
  EXPECT_GE(first.arrival_ns, before - 1'000'000);
  EXPECT_LT(first.arrival_ns, between);
  const Delivery second = transport->read(kForever);
  EXPECT_EQ(text_of(second), longest);
  EXPECT_GT(second.arrival_ns, first.arrival_ns);
  EXPECT_GT(second.arrival_ns, between - 1'000'000);
  EXPECT_EQ(transport->counters().bytes, 7U * warm_ups + 5U + longest.size());
}

TEST_P(Udp, WhatTheKernelDroppedIsCounted) {
  settings_.receive_buffer_bytes = 4096;
  const auto transport = make_udp_transport(settings_);
  transport->open({});
  LoopbackSocket gyro(GetParam(), SOCK_DGRAM);
  constexpr std::size_t kSent = 500;
  for (std::size_t i = 0; i < kSent; ++i) gyro.send_to(settings_.port, std::string(100, 'x'));
  std::size_t got = 0;
  while (!transport->read(0s).empty()) ++got;
  gyro.send_to(settings_.port, "after");  // the kernel says with the next one how many were dropped
  EXPECT_EQ(text_of(transport->read(kForever)), "after");
  EXPECT_LT(got, kSent);
  EXPECT_EQ(transport->counters().kernel_drops, kSent - got);
}

// Datagrams of 127.0.0.2 to any address of this computer.
UdpSettings from_one_host() {
  UdpSettings settings;
  settings.port = free_port(AF_INET, SOCK_DGRAM);
  settings.host = "127.0.0.2";
  return settings;
}

TEST(UdpTransport, DatagramsFromElsewhereAreLeftOutAndCounted) {
  const UdpSettings settings = from_one_host();
  const auto transport = make_udp_transport(settings);
  transport->open({});
  LoopbackSocket gyro(AF_INET, SOCK_DGRAM), other(AF_INET, SOCK_DGRAM);
  ASSERT_TRUE(gyro.bind(0, "127.0.0.2"));
  ASSERT_TRUE(other.bind(0, "127.0.0.3"));
  other.send_to(settings.port, "no");
  gyro.send_to(settings.port, "yes");
  std::string seen;
  while (seen.empty()) seen = text_of(transport->read(kForever));
  EXPECT_EQ(seen, "yes");
  EXPECT_EQ(transport->counters().malformed, 1U);
  EXPECT_STREQ(transport->fault().what, "datagrams from another host, which are dropped");
}

// Whoever floods the port with datagrams of his own cannot keep read() from returning at its time.
TEST(UdpTransport, AReadThatFindsOnlyForeignDatagramsReturns) {
  const UdpSettings settings = from_one_host();
  const auto transport = make_udp_transport(settings);
  transport->open({});
  LoopbackSocket other(AF_INET, SOCK_DGRAM);
  for (int i = 0; i < 40; ++i) other.send_to(settings.port, "no");
  EXPECT_TRUE(transport->read(kForever).empty());
}

TEST(UdpTransport, TheOpeningGoesToTheHost) {
  UdpSettings settings = on_loopback(free_port(AF_INET, SOCK_DGRAM));
  settings.host = "127.0.0.2";
  LoopbackSocket gyro(AF_INET, SOCK_DGRAM);
  ASSERT_TRUE(gyro.bind(settings.port, "127.0.0.2"));
  const std::string opening = "ZZR";
  make_udp_transport(settings)->open(bytes_of(opening));
  char got[16];
  EXPECT_EQ(recv(gyro.fd(), got, sizeof got, 0), 3);
  EXPECT_EQ(std::string(got, 3), opening);
  settings.host = "";
  EXPECT_TRUE(test::has(test::refusal([&] { make_udp_transport(settings)->open(bytes_of(opening)); }),
                        "expected host, the sensor's address"));
}

TEST(UdpTransport, APortThatIsTakenIsAwaited) {
  auto squatter = std::make_unique<LoopbackSocket>(AF_INET, SOCK_DGRAM);
  ASSERT_TRUE(squatter->bind(0));
  const UdpSettings settings = on_loopback(squatter->port());
  const auto transport = make_udp_transport(settings);
  EXPECT_THROW(transport->open({}), OpenError);
  EXPECT_EQ(transport->reason(), EADDRINUSE);
  EXPECT_EQ(transport->state(), TransportState::gone);
  squatter.reset();
  LoopbackSocket gyro(AF_INET, SOCK_DGRAM);
  std::string seen;
  for (int i = 0; i < 600 && seen.empty(); ++i) {
    gyro.send_to(settings.port, "back");
    seen = text_of(transport->read(100ms));
  }
  EXPECT_EQ(seen, "back");
}

TEST(UdpTransport, AGroupIsJoinedOnItsInterface) {
  UdpSettings settings;
  settings.port = free_port(AF_INET, SOCK_DGRAM);
  settings.group = "239.255.12.34";
  settings.interface = "lo";
  const auto transport = make_udp_transport(settings);
  transport->open({});
  LoopbackSocket gyro(AF_INET, SOCK_DGRAM);
  in_addr lo{};
  lo.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(setsockopt(gyro.fd(), IPPROTO_IP, IP_MULTICAST_IF, &lo, sizeof lo), 0);
  unsigned char ttl = 0;
  ASSERT_EQ(setsockopt(gyro.fd(), IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl), 0);
  gyro.send_to(settings.port, "not for the group");  // to the port, but not to the group
  gyro.send_to(settings.port, "to all", "239.255.12.34");
  EXPECT_EQ(text_of(transport->read(kForever)), "to all");
}

}  // namespace
}  // namespace ifog
