// SPDX-License-Identifier: Apache-2.0
// A gyro that is set up by lines of text, as KVH's manual says that it answers them, over a pseudo terminal.
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "tests/unit/refusal.h"
#include "tests/unit/transport/forever.h"
#include "tests/unit/transport/terminal.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

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
  EXPECT_NE(transport_->notices().take_answers().find("OUTPUTFMT,B"), std::string::npos);
  EXPECT_EQ(transport_->counters().reopened, 1U);
}

}  // namespace
}  // namespace ifog
