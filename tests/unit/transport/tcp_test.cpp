// SPDX-License-Identifier: Apache-2.0
// The TCP transport on the loopback, with a sensor that listens, closes, is taken and is not there.
#include <poll.h>

#include "drivers/transport/clock.h"
#include "drivers/transport/network/tcp.h"
#include "tests/unit/test.h"
#include "tests/unit/transport/forever.h"
#include "tests/unit/transport/loopback.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

// A sensor that listens on a port of its own.
class Server {
 public:
  explicit Server(int family, std::uint16_t port = 0) : socket_(family, SOCK_STREAM) {
    EXPECT_TRUE(socket_.bind(port));
    EXPECT_EQ(listen(socket_.fd(), 8), 0);
  }
  ~Server() { hang_up(); }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  [[nodiscard]] std::uint16_t port() const { return socket_.port(); }
  void accept() {
    hang_up();
    client_ = ::accept(socket_.fd(), nullptr, nullptr);
    ASSERT_GE(client_, 0);
  }
  // The next connection within a tenth of a second.
  void say_and_close(const std::string& text) {
    pollfd ask{socket_.fd(), POLLIN, 0};
    if (poll(&ask, 1, 100) <= 0) return;
    accept();
    send(text);
    hang_up();
  }
  // How many connections were asked for; each is closed at once.
  int turn_away() {
    int count = 0;
    for (pollfd ask{socket_.fd(), POLLIN, 0}; poll(&ask, 1, 0) > 0; ++count)
      close(::accept(socket_.fd(), nullptr, nullptr));
    return count;
  }
  void send(const std::string& text) const {
    ASSERT_EQ(::send(client_, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  std::string receive(std::size_t n) const {
    std::string text(n, '\0');
    return recv(client_, text.data(), n, MSG_WAITALL) == static_cast<ssize_t>(n) ? text : "";
  }
  void hang_up() {
    if (client_ >= 0) close(client_);
    client_ = -1;
  }

 private:
  LoopbackSocket socket_;
  int client_ = -1;
};

// A server that says why it hangs up, or that doubles every FF.
TEST(TcpServer, WhichSaysItsPortIsTakenIsQuotedAndTakenForOpenOnlyOnce) {
  Server server(AF_INET);
  auto transport = make_tcp_transport({.host = "127.0.0.1", .port = server.port()});
  transport->open({});
  std::atomic<bool> on{true};
  std::thread answer([&] {
    while (on) server.say_and_close("Port already in use\r\n");
  });
  const auto until = std::chrono::steady_clock::now() + 1s;
  while (std::chrono::steady_clock::now() < until) (void)transport->read(20ms);
  on = false;
  answer.join();
  EXPECT_EQ(transport->state(), TransportState::gone);
  EXPECT_EQ(std::string(transport->fault().text), "Port already in use");
  EXPECT_EQ(transport->counters().malformed, 1U);
  EXPECT_EQ(transport->counters().reopened, 0U);
}

TEST(TcpServer, WhichSpeaksTelnetIsRecognised) {
  Server server(AF_INET);
  auto transport = make_tcp_transport({.host = "127.0.0.1", .port = server.port()});
  std::thread answer([&] { server.accept(); });
  transport->open({});
  answer.join();
  const std::string frame("\xFE\x81\xFF\xFF\x55 some more of it, 36 bytes", 30);
  for (int n = 0; n < 40; ++n) server.send(frame);
  std::size_t came = 0;
  while (came < 40 * frame.size()) came += transport->read(kForever).bytes.size();
  ASSERT_NE(transport->fault().what, nullptr);
  EXPECT_TRUE(test::has(std::string(transport->fault().what), "telnet"));
}

class Tcp : public BothFamilies {
 protected:
  [[nodiscard]] static TcpSettings at(std::uint16_t port) { return {.host = address(), .port = port}; }
};

INSTANTIATE_TEST_SUITE_P(Families, Tcp, testing::Values(AF_INET, AF_INET6), BothFamilies::name);

TEST_P(Tcp, DeliversEveryByteWithTheKernelsTime) {
  Server gyro(GetParam());
  const auto transport = make_tcp_transport(at(gyro.port()));
  const std::string opening = "ZZR";
  transport->open(bytes_of(opening));
  gyro.accept();
  EXPECT_EQ(gyro.receive(3), opening);
  gyro.send("x");
  read_some(*transport, 1);
  std::string all;
  for (int i = 0; i < 100'000; ++i) all += static_cast<char>(i % 251);
  const std::int64_t before = arrival_clock_ns();
  std::thread sender([&] { gyro.send(all); });
  std::string seen;
  while (seen.size() < all.size()) {
    const Delivery d = transport->read(kForever);
    if (d.arrival_ns != 0) {
      EXPECT_GE(d.arrival_ns, before - 1'000'000);
      EXPECT_LE(d.arrival_ns, arrival_clock_ns());
    }
    seen.append(d.bytes.begin(), d.bytes.end());
  }
  sender.join();
  EXPECT_EQ(seen, all);
  EXPECT_EQ(transport->counters().bytes, all.size() + 1);
  EXPECT_EQ(transport->counters().reopened, 0U);
}

TEST_P(Tcp, ConnectsAgainWhenTheOtherEndCloses) {
  Server gyro(GetParam());
  const auto transport = make_tcp_transport(at(gyro.port()));
  const std::string opening = "go";
  transport->open(bytes_of(opening));
  for (unsigned round = 0; round < 3; ++round) {
    gyro.accept();
    EXPECT_EQ(gyro.receive(2), opening);  // each time
    gyro.send("hello");
    bool restarted = false;
    EXPECT_EQ(read_some(*transport, 5, &restarted), "hello");
    EXPECT_EQ(restarted, round > 0);
    EXPECT_EQ(transport->counters().reopened, round);
    gyro.hang_up();
    while (transport->counters().reopened == round) EXPECT_TRUE(transport->read(50ms).empty());
  }
}

TEST_P(Tcp, ADeviceThatIsNotThereYetIsAwaited) {
  const std::uint16_t port = free_port(GetParam(), SOCK_STREAM);
  const auto transport = make_tcp_transport(at(port));
  EXPECT_TRUE(test::has(test::refusal([&] { transport->open({}); }),
                        "expected a device or server that listens there"));
  EXPECT_EQ(transport->reason(), ECONNREFUSED);
  EXPECT_TRUE(transport->read(30ms).empty());
  EXPECT_EQ(transport->state(), TransportState::gone);
  Server gyro(GetParam(), port);
  std::thread answer([&] {
    gyro.accept();
    gyro.send("there");
  });
  EXPECT_EQ(read_some(*transport, 5), "there");
  answer.join();
  EXPECT_EQ(transport->state(), TransportState::open);
  EXPECT_EQ(transport->counters().reopened, 0U);  // it was never there before
}

// A serial server whose line is taken accepts and closes: it must not be asked as fast as the processor goes.
TEST_P(Tcp, AServerThatTurnsAwayIsNotFlooded) {
  Server server(GetParam());
  const auto transport = make_tcp_transport(at(server.port()));
  transport->open({});
  const std::int64_t begin = monotonic_ns();
  for (int asked = 0; asked < 6;) {
    asked += server.turn_away();
    transport->read(1ms);
  }
  // The one of open(), then pauses of 10, 20, 40, 80 and 100 ms.
  EXPECT_GE(monotonic_ns() - begin, 240'000'000);
}

// No connection that was never answered holds a read beyond its time: the queue of a server that accepts
// nobody is full, and the kernel drops what would be one more.
TEST(TcpTransport, AnAttemptWithoutAnAnswerHoldsNobodyUp) {
  LoopbackSocket full(AF_INET, SOCK_STREAM);
  ASSERT_TRUE(full.bind(0));
  ASSERT_EQ(listen(full.fd(), 0), 0);
  const TcpSettings settings{.host = "127.0.0.1", .port = full.port()};
  const auto first = make_tcp_transport(settings);
  first->open({});  // fills the queue
  const auto transport = make_tcp_transport(settings);
  const std::int64_t begin = monotonic_ns();
  EXPECT_THROW(transport->open({}), OpenError) << "the queue was not full";
  EXPECT_EQ(transport->reason(), ETIMEDOUT);
  const std::int64_t tried = monotonic_ns();
  EXPECT_GE(tried - begin, 400'000'000);
  EXPECT_TRUE(transport->read(20ms).empty());  // an attempt continues meanwhile, and nobody waits for it
  EXPECT_TRUE(transport->read(20ms).empty());
  std::thread stopper([&] { transport->stop(); });
  while (!transport->stopped()) transport->read(kForever);
  stopper.join();
  EXPECT_EQ(transport->state(), TransportState::gone);
}

// A port of the range that the system gives to those who connect, on which nobody listens.
TEST(TcpTransport, NeverTalksToItself) {
  const std::uint16_t port = free_port(AF_INET, SOCK_STREAM);
  LoopbackSocket own(AF_INET, SOCK_STREAM);
  ASSERT_TRUE(own.bind(port));
  const TcpSettings settings{.host = "127.0.0.1", .port = port};
  EXPECT_THROW(make_tcp_transport(settings)->open({}), OpenError);
}

TEST(TcpTransport, AnInterfaceThatIsMissingIsAwaited) {
  const auto elsewhere = make_tcp_transport({.host = "fe80::1%none-such", .port = 1});
  EXPECT_THROW(elsewhere->open({}), OpenError);
  EXPECT_EQ(elsewhere->reason(), ENODEV);
}

}  // namespace
}  // namespace ifog
