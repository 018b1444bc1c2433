// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/capture/files/output_file.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/file/byte_file.h"
#include "drivers/transport/file/file.h"
#include "drivers/transport/sole_reader.h"
#include "tests/unit/test.h"
#include "tests/unit/transport/forever.h"

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using ifog::FileSettings;
using ifog::kForever;
using ifog::TransportState;

class FileTransport : public testing::Test, protected ifog::test::OwnFolder {
 protected:
  FileTransport() { settings_.path = path("source"); }
  void put(const std::string& text) const { std::ofstream(settings_.path, std::ios::binary) << text; }
  void fifo() const { ASSERT_EQ(mkfifo(settings_.path.c_str(), 0600), 0); }
  void candump(const std::string& text) {
    put(text);
    settings_.format = FileSettings::Format::candump;
  }
  std::unique_ptr<ifog::Transport> opened() const {
    auto transport = ifog::make_file_transport(settings_);
    transport->open({});
    return transport;
  }
  std::string refusal() const {
    const std::string what = ifog::test::refusal([&] { ifog::make_file_transport(settings_)->open({}); });
    return what.starts_with(folder()) ? what.substr(folder().size() + 1) : what;
  }
  static std::string all_bytes(ifog::Transport& transport) {
    std::string text;
    while (transport.state() == TransportState::open) {
      const ifog::Delivery d = transport.read(kForever);
      text.append(d.bytes.begin(), d.bytes.end());
    }
    return text;
  }
  static std::vector<ifog_can_frame> all_frames(ifog::Transport& transport,
                                                std::chrono::nanoseconds timeout = kForever) {
    std::vector<ifog_can_frame> frames;
    while (transport.state() == TransportState::open) {
      const ifog::Delivery d = transport.read(timeout);
      frames.insert(frames.end(), d.frames.begin(), d.frames.end());
    }
    return frames;
  }

  FileSettings settings_;
};

std::string pattern(std::size_t n) {
  std::string text(n, '\0');
  std::uint32_t x = 1;
  for (char& c : text) c = static_cast<char>((x = x * 1664525U + 1013904223U) >> 24U);
  return text;
}

TEST_F(FileTransport, DeliversEveryByteOfAFileLongerThanItsBuffer) {
  const std::string text = pattern(300'001);
  put(text);
  const auto transport = opened();
  EXPECT_TRUE(transport->holds_back());
  EXPECT_EQ(all_bytes(*transport), text);
  EXPECT_EQ(transport->state(), TransportState::ended);
  EXPECT_EQ(transport->reason(), 0);
  EXPECT_EQ(transport->counters().bytes, text.size());
  EXPECT_TRUE(transport->read(kForever).empty());
}

TEST_F(FileTransport, ReadsGzipAndSaysWhenItIsCutOff) {
  settings_.path += ".gz";
  const std::string text = pattern(200'000);
  ifog::write_file(settings_.path, text);
  EXPECT_EQ(all_bytes(*opened()), text);
  fs::resize_file(settings_.path, fs::file_size(settings_.path) / 2);
  const auto transport = opened();
  const std::string some = all_bytes(*transport);
  EXPECT_TRUE(text.starts_with(some));
  EXPECT_EQ(transport->counters().malformed, 1U);
  ASSERT_NE(transport->fault().what, nullptr);
  EXPECT_STREQ(transport->fault().what, "the gzip stream ends early or is damaged");
}

TEST_F(FileTransport, RecordedBytesComeInBlocksNeverEarly) {
  const std::string text = pattern(100);
  put(text);
  settings_.pace = FileSettings::Pace::recorded;
  settings_.bytes_per_second = 1000;
  settings_.block_bytes = 30;
  const std::int64_t before = ifog::monotonic_ns();
  const auto transport = opened();
  EXPECT_FALSE(transport->holds_back());
  std::vector<std::size_t> sizes;
  std::string seen;
  while (transport->state() == TransportState::open) {
    const ifog::Delivery d = transport->read(kForever);
    if (d.empty()) continue;
    sizes.push_back(d.bytes.size());
    seen.append(d.bytes.begin(), d.bytes.end());
  }
  EXPECT_EQ(seen, text);
  EXPECT_EQ(sizes, (std::vector<std::size_t>{30, 30, 30, 10}));
  EXPECT_GE(ifog::monotonic_ns() - before, 70'000'000);  // 70 bytes after the first block
}

// A read that is over before its frame is due goes on where it was.
TEST_F(FileTransport, RecordedFramesKeepTheirSpacingAndStartNow) {
  candump(
      "(1000.000000) can0 001#01\n(1000.010000) can0 001#02\n(1000.010001) can0 001#03\n(1000.050000) can0 "
      "001#04\n");
  settings_.pace = FileSettings::Pace::recorded;
  settings_.speed = 2.0;
  const std::int64_t before = ifog::realtime_ns();
  const auto transport = opened();
  const std::vector<ifog_can_frame> frames = all_frames(*transport, 1ms);
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_GE(frames[0].arrival_ns, before);
  EXPECT_EQ(frames[1].arrival_ns - frames[0].arrival_ns, 5'000'000);
  EXPECT_EQ(frames[2].arrival_ns - frames[0].arrival_ns, 5'000'500);
  EXPECT_EQ(frames[3].arrival_ns - frames[0].arrival_ns, 25'000'000);
  EXPECT_GE(ifog::realtime_ns(), frames[3].arrival_ns);
}

TEST_F(FileTransport, FreeFramesKeepTheLogsTimes) {
  std::string text;
  for (int i = 0; i < 5000; ++i)
    text += "(1700000000." + std::to_string(100'000 + i) + ") can0 123#" + (i % 2 == 0 ? "00" : "01") + "\n";
  candump(text);
  const auto transport = opened();
  const std::vector<ifog_can_frame> frames = all_frames(*transport);
  ASSERT_EQ(frames.size(), 5000U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_EQ(frames[i].arrival_ns, 1'700'000'000'100'000'000 + static_cast<std::int64_t>(i) * 1000);
    ASSERT_EQ(frames[i].data[0], i % 2);
  }
  EXPECT_EQ(transport->counters().frames, 5000U);
}

TEST_F(FileTransport, PassesOnlyWantedFramesAndCountsTheRest) {
  candump(
      "(1.0) can0 123#01\n(1.1) can1 123#02\n(1.2) can0 124#03\n(1.3) can0 00000123#04\n(1.4) can0 "
      "20000004#00\n"
      "(1.5) can0 123#R\nrubbish\n\n(1.6) can0 123#05\n(1.7) can0 123#0");
  settings_.interface = "can0";
  settings_.ids = {{0x123, false}};
  const auto transport = opened();
  const std::vector<ifog_can_frame> frames = all_frames(*transport);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].data[0], 1);
  EXPECT_EQ(frames[1].data[0], 5);
  EXPECT_EQ(transport->counters().error_frames, 1U);
  EXPECT_EQ(transport->counters().malformed, 2U);
  EXPECT_EQ(transport->fault().line, 10U);
  EXPECT_STREQ(transport->fault().what, "the log is cut off here");
}

// Two gyros with one id on two buses are two: what the second sent is not mixed into the first's.
TEST_F(FileTransport, AnIdThatComesOnTwoInterfacesEndsIt) {
  candump(
      "(1.0) vcan1 124#00\n(1.0) vcan0 123#01\n(1.1) vcan0 123#02\n(1.2) vcan1 123#03\n(1.3) vcan0 123#04\n");
  settings_.ids = {{0x123, false}};
  const auto transport = opened();
  const std::vector<ifog_can_frame> frames = all_frames(*transport);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].data[0], 2);
  EXPECT_EQ(transport->reason(), 0);
  EXPECT_EQ(transport->fault().line, 4U);
  EXPECT_EQ(transport->fault().text, "vcan0 and vcan1");
  EXPECT_TRUE(ifog::test::has(std::string(transport->fault().what), "expected sensor.transport.interface"));
  for (const auto& [interface, first] : {std::pair{"vcan0", 1}, {"vcan1", 3}}) {
    settings_.interface = interface;
    const auto one = opened();
    EXPECT_EQ(all_frames(*one).at(0).data[0], first);
    EXPECT_EQ(one->fault().what, nullptr);
  }
  // Different ids on two buses may well be one device's.
  settings_.interface.clear();
  settings_.ids = {{0x123, false}, {0x124, false}};
  candump("(1.0) vcan1 124#00\n(1.0) vcan0 123#01\n(1.1) vcan0 123#02\n");
  EXPECT_EQ(all_frames(*opened()).size(), 3U);
}

// Where to begin to look: the first of many, with what stands there, or one that never ends.
TEST_F(FileTransport, OfBadLinesTheFirstIsTold) {
  std::string many;
  for (int n = 0; n < 1000; ++n) many += "rubbish " + std::to_string(n) + std::string(100, ' ') + "\n";
  for (const auto& [bad, count] : {std::pair{many, 1000U}, {std::string(200'000, 'x') + "\n", 1U}}) {
    candump("(1.0) can0 123#01\n" + bad + "(1.1) can0 123#02\n");
    const auto transport = opened();
    EXPECT_EQ(all_frames(*transport).size(), 2U);
    EXPECT_EQ(transport->counters().malformed, count);
    EXPECT_EQ(transport->fault().line, 2U);
    EXPECT_EQ(transport->fault().text, bad.substr(0, transport->fault().text.size()));
    EXPECT_LE(transport->fault().text.size(), 60U);
  }
}

TEST_F(FileTransport, AFifoWaitsForItsFirstWriterAndEndsWithIt) {
  fifo();
  settings_.await_writer = false;
  const auto transport = opened();
  EXPECT_TRUE(transport->read(1ms).empty());
  EXPECT_EQ(transport->state(), TransportState::open);
  std::thread writer([&] { std::ofstream(settings_.path) << "hello"; });
  EXPECT_EQ(all_bytes(*transport), "hello");
  EXPECT_EQ(transport->state(), TransportState::ended);
  writer.join();
}

TEST_F(FileTransport, AFifoWhoseWriterReturnsStartsAnew) {
  fifo();
  const auto transport = opened();
  for (int round = 0; round < 20; ++round) {
    const std::string text = "round " + std::to_string(round);
    if (round == 10) {  // it is another one of the same name
      std::filesystem::remove(settings_.path);
      fifo();
    }
    std::thread writer([&] { std::ofstream(settings_.path) << text; });
    std::string seen;
    bool restarted = false;
    while (seen.size() < text.size()) {
      const ifog::Delivery d = transport->read(1ms);
      restarted = restarted || d.restarted;
      seen.append(d.bytes.begin(), d.bytes.end());
    }
    writer.join();
    EXPECT_EQ(seen, text);
    EXPECT_EQ(restarted, round > 0);
    while (transport->state() == TransportState::open) transport->read(kForever);
    EXPECT_EQ(transport->state(), TransportState::gone);
  }
  EXPECT_EQ(transport->counters().reopened, 19U);
}

// While another tries again and again, opening it again lets nobody in.
TEST_F(FileTransport, AFifoOpenedAnewIsStillOneReaders) {
  fifo();
  ifog::ByteFile file;
  file.open(settings_.path);
  std::atomic<bool> done = false;
  std::atomic<int> got_in = 0;
  std::thread other([&] {
    while (!done) {
      const int fd = ::open(settings_.path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
      if (fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) == 0) ++got_in;
      ::close(fd);
    }
  });
  for (int i = 0; i < 5000; ++i) EXPECT_NO_THROW(file.open(settings_.path)) << i;
  done = true;
  other.join();
  EXPECT_EQ(got_in, 0);
}

TEST_F(FileTransport, AFifoIsOneReaders) {
  fifo();
  auto first = opened();
  // Also after its writer has gone and it is open again.
  for (int round = 0; round < 2; ++round) {
    EXPECT_THROW(opened(), ifog::DeviceInUse) << round;
    { std::ofstream(settings_.path) << "abc"; }
    EXPECT_EQ(first->read(kForever).bytes.size(), 3U) << round;
    while (first->state() == TransportState::open) first->read(kForever);
    EXPECT_EQ(first->state(), TransportState::gone) << round;
  }
  EXPECT_EQ(refusal(),
            "source: another process reads it: Device or resource busy, expected a device or FIFO of this "
            "daemon's own");
  first.reset();
  EXPECT_EQ(refusal(), "accepted");
  // What many may read is not asked for.
  settings_.path = "/dev/null";
  const auto second = opened();
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(FileTransport, AFileThatIsMissingIsAwaited) {
  EXPECT_EQ(refusal(), "source: cannot open: No such file or directory, expected a readable file or FIFO");
  const auto transport = ifog::make_file_transport(settings_);
  EXPECT_THROW(transport->open({}), std::runtime_error);
  EXPECT_EQ(transport->state(), TransportState::gone);
  EXPECT_EQ(transport->reason(), ENOENT);
  EXPECT_TRUE(transport->read(1ms).empty());
  put("late");
  ifog::Delivery d;
  while (d.empty()) d = transport->read(kForever);
  EXPECT_EQ(std::string(d.bytes.begin(), d.bytes.end()), "late");
}

TEST_F(FileTransport, RefusesAFolder) {
  fs::create_directory(settings_.path);
  EXPECT_EQ(refusal(), "source: cannot open: Is a directory, expected a readable file or FIFO");
}

TEST_F(FileTransport, StopEndsAReadThatWaitsForARecordedTime) {
  candump("(1.0) can0 001#01\n(3600.0) can0 001#02\n");
  settings_.pace = FileSettings::Pace::recorded;
  const auto transport = opened();
  EXPECT_EQ(transport->read(kForever).frames.size(), 1U);
  ifog::expect_stop_to_end_a_read(*transport);
}

}  // namespace
