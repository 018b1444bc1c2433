// SPDX-License-Identifier: Apache-2.0
// The serial transport over a pseudo terminal in the place of the line: libserialport itself takes none (no
// modem lines), it is tried in tests/system on an emulated UART and a USB adapter that is pulled out.
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "drivers/transport/clock.h"
#include "drivers/transport/serial/serial_port.h"
#include "drivers/transport/sole_reader.h"
#include "tests/unit/test.h"
#include "tests/unit/transport/forever.h"
#include "tests/unit/transport/terminal.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

SerialSettings settings() { return {.device = "gyro", .baud = 921600}; }

TEST(SerialTransport, DeliversEveryByteWithItsArrival) {
  Gyro gyro;
  const auto transport = make_serial_transport(settings(), gyro.opener());
  transport->open({});
  EXPECT_EQ(transport->notices().take_warning(), "no low latency");
  EXPECT_EQ(transport->notices().take_warning(), "");
  EXPECT_FALSE(transport->holds_back());
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  const std::int64_t before = realtime_ns();
  gyro.send(all);
  const Delivery d = transport->read(kForever);
  EXPECT_GE(d.arrival_ns, before);
  EXPECT_LE(d.arrival_ns, realtime_ns());
  std::string seen(d.bytes.begin(), d.bytes.end());
  if (seen.size() < all.size()) seen += read_some(*transport, all.size() - seen.size());
  EXPECT_EQ(seen, all);
  EXPECT_EQ(transport->counters().bytes, 256U);
  EXPECT_TRUE(transport->read(1ms).empty());
  EXPECT_EQ(transport->state(), TransportState::open);
}

TEST(SerialTransport, ComesBackAfterEachPullAndSendsItsOpeningAgain) {
  Gyro gyro;
  const auto transport = make_serial_transport(settings(), gyro.opener());
  const std::string opening = "=rate\r";
  transport->open(bytes_of(opening));
  EXPECT_EQ(gyro.receive(opening.size()), opening);
  gyro.send("0");
  EXPECT_EQ(read_some(*transport, 1), "0");
  for (int pull = 1; pull <= 10; ++pull) {
    gyro.pull();
    while (transport->state() == TransportState::open) transport->read(kForever);
    EXPECT_EQ(transport->state(), TransportState::gone);
    EXPECT_NE(transport->reason(), 0);
    EXPECT_TRUE(transport->read(1ms).empty());
    if (pull == 1) std::this_thread::sleep_for(200ms);
    gyro.plug();
    while (transport->state() == TransportState::gone) transport->read(1ms);
    EXPECT_EQ(gyro.receive(opening.size()), opening);
    gyro.send(std::to_string(pull));
    Delivery back;
    while (back.empty()) back = transport->read(10ms);
    EXPECT_EQ(std::string(back.bytes.begin(), back.bytes.end()), std::to_string(pull));
    EXPECT_TRUE(back.restarted);
    EXPECT_GT(back.arrival_ns, 0) << "nothing piles up in a device that is away";
  }
  EXPECT_EQ(transport->counters().reopened, 10U);
}

// What the UART had counted before the device was opened is none of its reader's losses; what it counts until
// the moment it goes away is, and so is what it counts until the last read.
TEST(SerialTransport, LossesUpToTheHangUpAndTheStopAreCounted) {
  Gyro gyro;
  gyro.errors = {.lost = 0xFFFFFFFEU, .damaged = 7};
  const auto transport = make_serial_transport(settings(), gyro.opener());
  transport->open({});
  gyro.send("0");
  EXPECT_EQ(read_some(*transport, 1), "0");
  EXPECT_EQ(transport->counters().kernel_drops, 0U);
  EXPECT_EQ(transport->counters().error_frames, 0U);
  gyro.errors = {.lost = 3, .damaged = 9};  // five more, over the end of the kernel's 32 bits
  gyro.pull();
  while (transport->state() == TransportState::open) transport->read(kForever);
  EXPECT_EQ(transport->counters().kernel_drops, 5U);
  EXPECT_EQ(transport->counters().error_frames, 2U);
  transport->close_books();  // of no open device
  gyro.errors = {};          // the driver is loaded again with the device
  gyro.plug();
  while (transport->state() == TransportState::gone) transport->read(1ms);
  gyro.errors = {.lost = 1, .damaged = 1};
  transport->stop();
  EXPECT_TRUE(transport->read(kForever).empty());
  transport->close_books();
  EXPECT_EQ(transport->counters().kernel_drops, 6U);
  EXPECT_EQ(transport->counters().error_frames, 3U);
}

TEST(SerialTransport, StopEndsTheWaitForBytesAndTheWaitForTheDevice) {
  for (const bool there : {true, false}) {
    Gyro gyro;
    const auto transport = make_serial_transport(settings(), gyro.opener());
    transport->open({});
    if (!there) {
      gyro.pull();
      while (transport->state() == TransportState::open) transport->read(kForever);
    }
    expect_stop_to_end_a_read(*transport);
  }
}

TEST(SerialTransport, AnOpeningThatCannotBeSentIsAFailure) {
  int fds[2];
  ASSERT_EQ(pipe2(fds, O_NONBLOCK), 0);
  close(fds[1]);
  // A descriptor that may only be read.
  class ReadOnly final : public SerialPort {
   public:
    explicit ReadOnly(int fd) : fd_(fd) {}
    [[nodiscard]] int fd() const override { return fd_; }

   private:
    int fd_;
  };
  const auto transport = make_serial_transport(
      settings(), [&](const SerialSettings&, std::string&) { return std::make_unique<ReadOnly>(fds[0]); });
  const std::uint8_t byte = 'x';
  EXPECT_EQ(test::refusal([&] {
              transport->open({&byte, 1});
            }),
            "gyro: cannot send the opening bytes: Bad file descriptor, expected a device that takes them");
  close(fds[0]);
}

std::string refusal(const SerialSettings& s) {
  return test::refusal([&] { make_serial_transport(s)->open({}); });
}

TEST(SerialTransport, RefusesInOneLine) {
  EXPECT_EQ(refusal({.device = "/dev/no-gyro", .baud = 921600}),
            "/dev/no-gyro: cannot open: No such file or directory, expected a serial device");
  EXPECT_EQ(refusal({.device = "/dev/null", .baud = 921600}).substr(0, 24), "/dev/null: cannot open: ");
}

// What the port asks for on whatever line it has opened.
TEST(SerialTransport, ALineIsOneReaders) {
  const int master = open_line();
  const auto line = [&] { return open(ptsname(master), O_RDWR | O_NOCTTY | O_CLOEXEC); };
  const int first = line(), second = line();
  SoleReader one, other;
  one.take(first, "gyro");
  EXPECT_THROW(other.take(second, "gyro"), DeviceInUse);
  const pid_t child = fork();  // has the descriptors, too
  if (child == 0) pause();
  one.release();
  close(first);
  EXPECT_NO_THROW(other.take(second, "gyro"));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  close(second);
  close(master);
}

// A gyro that is set up by lines of text, as KVH's manual says that it answers them, over a pseudo terminal.

using namespace std::string_literals;
const std::string kFrame = "\xFE\x81\xFF\x55 frame \r\x01\x02 DR"s;

// Streams frames of bytes, but between "=CONFIG,1" and "=CONFIG,0", and answers what it is asked there.
class Imu {
 public:
  explicit Imu(Gyro& line) : line_(line), thread_([this] { run(); }) {}
  ~Imu() {
    ended_ = true;
    thread_.join();
  }
  Imu(const Imu&) = delete;
  Imu& operator=(const Imu&) = delete;
  void answer(const std::string& to, const std::string& with) {
    const std::lock_guard lock(mutex_);
    other_[to] = with;
  }
  std::vector<std::string> asked() {
    const std::lock_guard lock(mutex_);
    return asked_;
  }
  std::atomic<bool> powered{true};

 private:
  void run() {
    std::string line;
    bool configures = false;
    while (!ended_) {
      if (!powered) {
        configures = false;
        line_.drain();
        std::this_thread::sleep_for(1ms);
        continue;
      }
      if (!configures) line_.send(kFrame);
      for (const char c : line_.drain()) {
        if (c != '\r' && c != '\n') {
          line += c;
        } else if (!line.empty()) {
          reply(std::exchange(line, {}), configures);
        }
      }
      std::this_thread::sleep_for(1ms);
    }
  }
  void reply(const std::string& line, bool& configures) {
    const std::lock_guard lock(mutex_);
    asked_.push_back(line);
    if (line == "=CONFIG,1") configures = true;
    if (line == "=CONFIG,0") configures = false;
    const auto other = other_.find(line);
    const std::string answer = other != other_.end() ? other->second : line.substr(1);
    if (!answer.empty()) line_.send(answer + "\r\n");
  }
  Gyro& line_;
  std::mutex mutex_;
  std::map<std::string, std::string> other_;
  std::vector<std::string> asked_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

SerialSettings set_up() {
  return {.device = "gyro",
          .baud = 921600,
          .set_up = {"=CONFIG,1", "=dr,1000", "=OUTPUTFMT,B", "?FILTTYPE,G -> FILTTYPE,G,CHEBY", "?IS",
                     "=CONFIG,0"}};
}
const std::vector<std::string> kAsked{"=CONFIG,1",   "=dr,1000", "=OUTPUTFMT,B",
                                      "?FILTTYPE,G", "?IS",      "=CONFIG,0"};

class SetUpByLines : public testing::Test {
 protected:
  void SetUp() override {
    imu_.answer("=dr,1000", "DR, 1000");  // as its manual writes it
    imu_.answer("?FILTTYPE,G", "FILTTYPE,G,CHEBY");
    imu_.answer("?IS", "IS,0815");
  }
  std::string refusal() {
    return test::refusal([&] { transport_->open({}); });
  }
  // Until it is so, or ten seconds are over.
  template <typename Is>
  bool reads_until(Is&& is) {
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (std::chrono::steady_clock::now() < end) {
      transport_->read(50ms);
      if (is()) return true;
    }
    return false;
  }
  Gyro line_;
  Imu imu_{line_};
  std::unique_ptr<Transport> transport_ = make_serial_transport(set_up(), line_.opener());
};

TEST_F(SetUpByLines, EachLineIsAnsweredBeforeTheNextAndSaid) {
  EXPECT_EQ(refusal(), "accepted");
  EXPECT_EQ(imu_.asked(), kAsked);
  EXPECT_EQ(transport_->notices().take_answers(),
            "gyro: set up, it answered CONFIG,1; DR,1000; OUTPUTFMT,B; FILTTYPE,G,CHEBY; IS,0815; CONFIG,0");
  EXPECT_EQ(transport_->notices().take_answers(), "");
  EXPECT_TRUE(reads_until([&] { return transport_->counters().bytes > 3 * kFrame.size(); }));
}

TEST_F(SetUpByLines, AnAnswerThatDiffersAndNoneAreRefused) {
  for (const auto& [to, with, line] :
       {std::tuple{"=OUTPUTFMT,B", "OUTPUTFMT,A",
                   "gyro: answered 'OUTPUTFMT,A' to '=OUTPUTFMT,B': Protocol error, expected 'OUTPUTFMT,B'"},
        {"=OUTPUTFMT,B", "INVALID,=OUTPUTFMT,B",
         "gyro: answered 'INVALID,=OUTPUTFMT,B' to '=OUTPUTFMT,B': Protocol error, expected 'OUTPUTFMT,B'"},
        {"?FILTTYPE,G", "FILTTYPE,G,AVE",
         "gyro: answered 'FILTTYPE,G,AVE' to '?FILTTYPE,G': Protocol error, expected 'FILTTYPE,G,CHEBY'"},
        {"=dr,1000", "", "gyro: no answer to '=dr,1000': Connection timed out, expected 'DR,1000'"}}) {
    TearDown();
    SetUp();
    imu_.answer("=OUTPUTFMT,B", "OUTPUTFMT,B");
    imu_.answer(to, with);
    transport_ = make_serial_transport(set_up(), line_.opener());
    EXPECT_EQ(refusal(), line);
    EXPECT_EQ(transport_->notices().take_answers(), "");
  }
}

// It is off for longer than it ever pauses, and on again; what it then answers otherwise is said once.
TEST_F(SetUpByLines, WhatHadNoPowerIsSetUpAgain) {
  EXPECT_EQ(refusal(), "accepted");
  (void)transport_->notices().take_answers();
  (void)transport_->notices().take_warning();
  imu_.powered = false;
  EXPECT_TRUE(reads_until([&] { return transport_->state() == TransportState::gone; }));
  imu_.answer("=OUTPUTFMT,B", "OUTPUTFMT,A");
  imu_.powered = true;
  std::string said;
  EXPECT_TRUE(reads_until([&] {
    if (const std::string now = transport_->notices().take_warning(); !now.empty()) said = now;
    return said.find("OUTPUTFMT") != std::string::npos;
  })) << said;
  EXPECT_EQ(said, "gyro: answered 'OUTPUTFMT,A' to '=OUTPUTFMT,B': Protocol error, expected 'OUTPUTFMT,B'");
  EXPECT_EQ(transport_->state(), TransportState::gone);
  imu_.answer("=OUTPUTFMT,B", "OUTPUTFMT,B");
  EXPECT_TRUE(reads_until([&] { return transport_->state() == TransportState::open; }));
  EXPECT_TRUE(test::has(transport_->notices().take_answers(), "OUTPUTFMT,B"));
  EXPECT_EQ(transport_->counters().reopened, 1U);
}

}  // namespace
}  // namespace ifog
