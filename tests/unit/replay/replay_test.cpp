// SPDX-License-Identifier: Apache-2.0
// What `ifog replay` does when the system has no room (the system is a stand-in that answers as told), how late it says that it
// is, and a flight recording that it sends again. As a user runs it: tests/system/command_line/replay.py.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/sensor/duration_histogram.h"
#include "drivers/flight/archive.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/file/pace.h"
#include "tests/unit/test.h"
#include "tools/ifog/replay/replay_target.h"

namespace ifog::tools {
namespace {

// An answer above 0: takes at most so many bytes; 0: takes none; below: fails with this errno.
class ToldOutlet final : public Outlet {
 public:
  explicit ToldOutlet(std::deque<int> answers) : Outlet("can0", -1), answers_(std::move(answers)) {}
  ssize_t write(const void* bytes, std::size_t n) override {
    ++writes_;
    int answer = static_cast<int>(n);
    if (!answers_.empty()) {
      answer = answers_.front();
      answers_.pop_front();
    }
    if (answer < 0) {
      errno = -answer;
      return -1;
    }
    const auto taken = std::min(n, static_cast<std::size_t>(answer));
    sent_.append(static_cast<const char*>(bytes), taken);
    return static_cast<ssize_t>(taken);
  }
  void pause(int error) override { paused_.push_back(error); }

  std::deque<int> answers_;
  std::string sent_;
  std::vector<int> paused_;
  int writes_ = 0;
};

TEST(Outlet, AFullCanQueueIsWaitedForAndTheFrameGoesOnce) {
  ToldOutlet outlet({-ENOBUFS, -ENOBUFS, -EAGAIN, -EINTR});
  EXPECT_TRUE(outlet.send_datagram("frame-1", 7));
  EXPECT_TRUE(outlet.send_datagram("frame-2", 7));
  EXPECT_EQ(outlet.sent_, "frame-1frame-2");
  EXPECT_EQ(outlet.retries(), 3U);  // an interrupted call is not a lack of room
  EXPECT_EQ(outlet.paused_, (std::vector<int>{ENOBUFS, ENOBUFS, EAGAIN}));
}

TEST(Outlet, AFrameOfWhichAPartWentIsAFailure) {
  ToldOutlet outlet({5});
  EXPECT_EQ(test::refusal([&] { outlet.send_datagram("frame-1", 7); }),
            "can0: cannot send: 5 of 7 bytes of a frame were accepted");
}

TEST(Outlet, ShortWritesOfBytesGoOnWhereTheyEnded) {
  ToldOutlet outlet({3, 0, 1, -EAGAIN, 2});
  EXPECT_TRUE(outlet.send_bytes("0123456789", 10));
  EXPECT_EQ(outlet.sent_, "0123456789");
  EXPECT_EQ(outlet.writes_, 6);
  EXPECT_EQ(outlet.retries(), 5U);
  EXPECT_EQ(outlet.paused_, (std::vector<int>{EAGAIN, EAGAIN}));
}

TEST(Outlet, AnyOtherFailureIsOneLine) {
  for (const auto& [error, line] : {std::pair{ENETDOWN, "can0: cannot send: Network is down"},
                                    {EPIPE, "can0: the reader went away"},
                                    {EIO, "can0: cannot send: Input/output error"}}) {
    ToldOutlet outlet({-error});
    EXPECT_EQ(test::refusal([&] { outlet.send_bytes("x", 1); }), line);
  }
}

}  // namespace
}  // namespace ifog::tools

namespace ifog {
namespace {

// This build's program, also where it is built with a sanitizer.
TEST(Replay, AsAUserRunsIt) {
  EXPECT_EQ(std::system("python3 " IFOG_SOURCE_DIR "/tests/system/command_line/replay.py " IFOG_PROGRAM
                        " " IFOG_SOURCE_DIR),
            0);
}

TEST(DurationHistogram, PercentilesAreWithinABucketOfTheSortedValues) {
  DurationHistogram late;
  std::vector<std::int64_t> values;
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    values.push_back(static_cast<std::int64_t>(random() >> (24U + random() % 36U)));
    late.add(values.back());
  }
  std::sort(values.begin(), values.end());
  for (const double share : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const auto exact = static_cast<double>(values[static_cast<std::size_t>(share * 20'000)]);
    EXPECT_GE(1e3 * late.percentile_us(share), exact * (1.0 - 1e-12));
    EXPECT_LE(1e3 * late.percentile_us(share), exact * (1.0 + 1.0 / 32.0) + 1.0);
  }
  EXPECT_DOUBLE_EQ(late.max_us(), static_cast<double>(values.back()) * 1e-3);
  EXPECT_EQ(late.count(), 20'000U);
  EXPECT_EQ(late.percentile_us(1.0), late.max_us());
  late.clear();
  EXPECT_EQ(late.percentile_us(0.5), 0.0);
  late.add(-5);
  late.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(late.count(), 2U);
}

TEST(Pace, DeadlinesComeFromTheFirstAndKeepNanosecondsForDays) {
  constexpr std::int64_t kFirst_ns = 1'700'000'000'000'000'000, kTenDays_ns = 864'000'000'000'001;
  Pace pace, slow(0.5);
  pace.start(kFirst_ns, 5);
  EXPECT_EQ(pace.due_ns(kFirst_ns + kTenDays_ns), 5 + kTenDays_ns);
  EXPECT_EQ(pace.due_ns(kFirst_ns - 1), 4);
  slow.start(100, 1000);
  EXPECT_EQ(slow.due_ns(200), 1200);
}

// A flight recording goes out again as it came in: each delivery by itself, never before its time.

constexpr std::int64_t kMillisecond = 1'000'000, kBegan = 1'700'000'000'000'000'000;
// When the deliveries came, behind the first: evenly, two at once, and after a pause.
const std::vector<std::int64_t> kCame_ms{0, 20, 40, 40, 41, 190, 200};

class RecordedTimes : public testing::Test, protected test::OwnFolder {
 protected:
  // Delivery n is n + 1 bytes 'a' + n, or a CAN frame with n.
  void record(FlightHeader::Carries carries) const {
    FlightHeader header;
    header.sensor = "nose";
    header.driver = "none that is there";
    header.carries = carries;
    ArchiveLimits limits;
    limits.file_bytes = 400;  // over several files
    FlightArchive archive(make_flight_folder(path("record")), limits, header);
    for (std::size_t n = 0; n < kCame_ms.size(); ++n) {
      const std::int64_t read_ns = kBegan + kCame_ms[n] * kMillisecond;
      const auto letter = static_cast<std::uint8_t>('a' + n);
      if (carries == FlightHeader::Carries::can)
        archive.add({FlightKind::can, kFlightStamped, 0, 0, read_ns},
                    std::vector<std::uint8_t>{0x23, 1, 0, 0, 0, 1, letter});
      else
        archive.add({FlightKind::bytes, 0, 0, 0, read_ns}, std::vector<std::uint8_t>(n + 1, letter));
      archive.turn(read_ns, read_ns, true);
    }
  }
  // Exit status; what it prints goes to the file `said`.
  [[nodiscard]] int replay(const std::string& arguments) const {
    return WEXITSTATUS(std::system(
        (IFOG_PROGRAM " replay " + path("record") + " " + arguments + " >" + path("said") + " 2>&1")
            .c_str()));
  }
};

TEST_F(RecordedTimes, BytesIntoAFifo) {
  record(FlightHeader::Carries::bytes);
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  std::vector<std::pair<std::int64_t, std::string>> got;  // when it was here, and what
  std::thread reader([&] {
    const int fd = open(path("fifo").c_str(), O_RDONLY);
    std::string piece(100, '\0');
    for (ssize_t n = 0; (n = read(fd, piece.data(), piece.size())) > 0;)
      got.emplace_back(monotonic_ns(), piece.substr(0, static_cast<std::size_t>(n)));
    close(fd);
  });
  const std::int64_t started_ns = monotonic_ns();
  EXPECT_EQ(replay("--to fifo:" + path("fifo")), 0) << content("said");
  reader.join();
  std::string all, expected;
  for (const auto& [at_ns, piece] : got) {
    // Whatever came with it or after it, the last of it was due.
    EXPECT_GE(at_ns - started_ns, kCame_ms.at(static_cast<std::size_t>(piece.back() - 'a')) * kMillisecond)
        << piece;
    all += piece;
  }
  for (std::size_t n = 0; n < kCame_ms.size(); ++n)
    expected += std::string(n + 1, static_cast<char>('a' + n));
  EXPECT_EQ(all, expected);
}

// The log has their times, and says nothing of a driver that is not there.
TEST_F(RecordedTimes, FramesIntoALog) {
  record(FlightHeader::Carries::can);
  const std::int64_t started_ns = monotonic_ns();
  ASSERT_EQ(replay("--channel can7 --to file:" + path("again.log")), 0) << content("said");
  EXPECT_GE(monotonic_ns() - started_ns, kCame_ms.back() * kMillisecond);
  EXPECT_EQ(
      content("again.log"),
      "(1700000000.000000) can7 123#61\n(1700000000.020000) can7 123#62\n(1700000000.040000) can7 123#63\n"
      "(1700000000.040000) can7 123#64\n(1700000000.041000) can7 123#65\n(1700000000.190000) can7 123#66\n"
      "(1700000000.200000) can7 123#67\n");
}

}  // namespace
}  // namespace ifog
