// SPDX-License-Identifier: Apache-2.0
// Logs of lcm-logger as captures: written here with LCM's own library, read by ours.
#include <unistd.h>
#include <ifog/channel_t.hpp>
#include <ifog/rate_t.hpp>
#include <ifog/status_t.hpp>
#include <lcm/lcm-cpp.hpp>

#include "drivers/capture/files/output_file.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/messages.h"
#include "tests/unit/test.h"
#include "tools/ifog/captures/lcm/lcm_log.h"

namespace ifog::tools {
namespace {

namespace fs = std::filesystem;

class LcmLog : public testing::Test, protected test::OwnFolder {
 protected:
  void SetUp() override {
    writer_ = std::make_unique<lcm::LogFile>(path_, "w");
    ASSERT_TRUE(writer_->good());
  }

  template <typename Message>
  void add(const std::string& channel, const Message& message, std::int64_t came_utime = 0) {
    std::vector<std::uint8_t> bytes = encoded(message);
    lcm::LogEvent event{};
    event.timestamp = came_utime;
    event.channel = channel;
    event.datalen = static_cast<int>(bytes.size());
    event.data = bytes.data();
    ASSERT_EQ(writer_->writeEvent(&event), 0);
  }
  // Sample n of a sensor with so many axes; every number in it is another.
  static rate_t sample(int n, int axes, std::int64_t sensor_time_ns = -1) {
    rate_t out = rate(axes, 100.0 * n);
    out.utime = 1'700'000'000'000'000 + n * 1000;
    out.sensor_time_ns = sensor_time_ns;
    out.dt = 0.001;
    return out;
  }
  void finish() { writer_.reset(); }
  static Capture read(InputFile& file, const std::string& channel) {
    return capture_of(table_of([&](RowSink& sink) {
                        read_lcm_log(file, channel, sink);
                        return RowNotes{};
                      }),
                      file.path());
  }
  Capture read(const std::string& channel) const {
    InputFile file(path_);
    return read(file, channel);
  }
  Table published(const std::string& channel) const {
    InputFile file(path_);
    return table_of([&](RowSink& sink) { return read_published(file, channel, sink), RowNotes{}; });
  }
  std::string refusal(const std::string& channel = "") {
    finish();
    return test::refusal([&] { read(channel); });
  }

  const std::string path_ = path("log");
  std::unique_ptr<lcm::LogFile> writer_;
};

TEST_F(LcmLog, TheSensorsOwnClockGoesBeforeTheFittedTime) {
  for (int n = 0; n < 3; ++n) add("IFOG_NOSE", sample(n, 1, 5'000'000'000 + n * 250'000'000LL));
  finish();
  const Capture capture = read("IFOG_NOSE");
  EXPECT_EQ(capture.time_s, (std::vector<double>{0.0, 0.25, 0.5}));
  EXPECT_EQ(capture.axes, std::vector<std::string>{""});
}

TEST_F(LcmLog, WhatWasPublishedComesInTheColumnsOfDenoise) {
  for (int n = 0; n < 3; ++n) add("IFOG_NOSE", sample(n, 2));
  finish();
  const Table table = published("");
  std::vector<std::string> names;
  for (const CaptureColumn& column : table.columns) names.push_back(column.name);
  EXPECT_EQ(names, (std::vector<std::string>{"raw_x_radps", "compensated_x_radps", "denoised_x_radps",
                                             "variance_x_rad2ps2", "raw_y_radps", "compensated_y_radps",
                                             "denoised_y_radps", "variance_y_rad2ps2"}));
  // Fields in the message's order, both axes each: raw 0 1, compensated 2 3, denoised 4 5, variance 6 7.
  const double expected[] = {0, 2, 4, 6, 1, 3, 5, 7};
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    for (std::size_t n = 0; n < 3; ++n)
      EXPECT_EQ(table.columns[c].values[n], 100.0 * static_cast<double>(n) + expected[c]) << names[c];
  EXPECT_NEAR(table.time_s[2], 0.002, 1e-12);
}

TEST_F(LcmLog, SeveralSensorsMustBeChosenFrom) {
  add("IFOG_NOSE", sample(0, 1));
  add("IFOG_TAIL", sample(0, 1));
  EXPECT_EQ(refusal(), path_ + ": has several channels, expected --channel with one of IFOG_NOSE, IFOG_TAIL");
  EXPECT_EQ(refusal("IFOG_TAIL"), "accepted");
  EXPECT_EQ(refusal("IFOG_WING"), path_ + ": has no message on channel IFOG_WING");
}

TEST_F(LcmLog, RefusesWhatIsNoLogOrHasNoRates) {
  add("HULL", channel_t{});
  EXPECT_EQ(refusal(), path_ + ": has no channel IFOG_<NAME>, and none with rates of another program's type");
  fs::remove(path_);
  EXPECT_EQ(refusal("IFOG_NOSE"), path_ + ": cannot open: No such file or directory");
}

TEST_F(LcmLog, RefusesMessagesThatCannotBe) {
  add("IFOG_NOSE", sample(1, 1));
  add("IFOG_NOSE", channel_t{});
  EXPECT_EQ(refusal(), path_ + ": message 2 on IFOG_NOSE is no ifog.rate_t of this version");
  SetUp();
  add("IFOG_NOSE", sample(0, 1));
  add("IFOG_NOSE", sample(1, 3));
  EXPECT_EQ(refusal(), path_ + ": message 2 on IFOG_NOSE has another number of axes");
  SetUp();  // one of many is damage
  for (int n = 0; n < 200; ++n) n == 100 ? add("IFOG_NOSE", channel_t{}) : add("IFOG_NOSE", sample(n, 1));
  finish();
  EXPECT_EQ(read("IFOG_NOSE").size(), 199U);
}

// Two recorders in one folder: the second one's file begins before the first one's has ended. By the fitted
// times, and by a device's own clock.
TEST_F(LcmLog, WhatCameTwiceIsLeftOutAndSaid) {
  for (const std::int64_t clock_ns : {std::int64_t{-1}, std::int64_t{5'000'000'000}}) {
    SetUp();
    const auto put = [&](int n) {
      rate_t message = sample(n, 1, clock_ns < 0 ? -1 : clock_ns + n * 1'000'000LL);
      message.seq = n;
      add("IFOG_NOSE", message);
    };
    for (int n = 0; n < 7; ++n) put(n);
    for (int n = 4; n < 10; ++n) put(n);
    finish();
    testing::internal::CaptureStderr();
    const Capture capture = read("");
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              path_ + ": t = 0 is 2023-11-14 22:13:20 UTC, the first message\n" + path_ +
                  ": 3 messages on IFOG_NOSE came twice or after one that follows, and are dropped (two "
                  "recorders wrote at once, or a clock was set back)\n");
    ASSERT_EQ(capture.time_s.size(), 10U) << clock_ns;
    for (std::size_t n = 0; n < 10; ++n) {
      EXPECT_NEAR(capture.time_s[n], 1e-3 * static_cast<double>(n), 1e-9);
      EXPECT_EQ(capture.rate_radps[0][n], 100.0 * static_cast<double>(n));
    }
  }
}

// A status tells each measurement once; a channel that is none of the sensor's comes by its own messages.
TEST_F(LcmLog, ChannelsOfTheStatusAndOfMessagesAreColumns) {
  status_t status{};
  status.axes = 0;
  status.channels = 3;
  status.channel_name = {"supply_V", "never_degC", "no,name"};
  const auto tell = [&](double utime_s, double supply, double age_s) {
    status.utime = static_cast<std::int64_t>(utime_s * 1e6);
    status.channel_value = {supply, 1.0, 2.0};
    status.channel_age_s = {age_s, std::numeric_limits<double>::infinity(), 0.0};
    add("IFOG_NOSE_STATUS", status);
  };
  channel_t hull{};
  hull.name = "hull_degC";
  channel_t supply{};
  supply.name = "supply_V";
  supply.value = -1.0;  // not as the daemon has it
  add("HULL", supply);
  for (int n = 0; n < 6; ++n) {
    if (n == 1) tell(100.0, 12.5, 0.25);
    if (n == 2) tell(101.0, 12.5, 1.25);  // the same measurement, a second older
    if (n == 3) tell(102.0, 12.5, 0.25);  // another of the same value
    if (n == 4) {
      hull.value = 30.0 + n;
      add("HULL", hull);
      add("HULL", supply);
    }
    if (n == 5) tell(103.0, 13.0, 0.25);
    add("IFOG_NOSE", sample(n, 1));
  }
  finish();
  const Capture capture = read("");
  ASSERT_EQ(capture.channels.size(), 2U);
  const auto known = [&](const CaptureColumn& column) {
    std::vector<std::pair<std::size_t, double>> out;
    for (std::size_t i = 0; i < column.values.size(); ++i)
      if (std::isfinite(column.values[i])) out.emplace_back(i, column.values[i]);
    return out;
  };
  using Known = std::vector<std::pair<std::size_t, double>>;
  EXPECT_EQ(capture.channels[0].name, "hull_degC");
  EXPECT_EQ(known(capture.channels[0]), (Known{{4, 34.0}}));
  EXPECT_EQ(capture.channels[1].name, "supply_V");
  EXPECT_EQ(known(capture.channels[1]), (Known{{1, 12.5}, {3, 12.5}, {5, 13.0}}));
}

// The daemon was started again: its sensor's clock is at another place, the fitted time advances.
TEST_F(LcmLog, ADeviceWhoseClockBeginsAnewGoesOnByTheFittedTime) {
  add("IFOG_NOSE", sample(0, 1, 5'000'000'000));
  add("IFOG_NOSE", sample(1, 1, 5'001'000'000));
  add("IFOG_NOSE", sample(11, 1, 7'000'000));
  add("IFOG_NOSE", sample(12, 1, 8'000'000));
  finish();
  EXPECT_EQ(read("").time_s, (std::vector<double>{0.0, 0.001, 0.011, 0.012}));
}

// What a daemon of before has written: labels that stood still or went back by microseconds.
TEST_F(LcmLog, ALabelThatDoesNotGoOnIsNoEndOfTheRecording) {
  for (int n = 0; n < 5; ++n) {
    rate_t message = sample(n, 1);
    message.seq = n;
    if (n == 2) message.utime -= 1011;
    add("IFOG_NOSE", message);
  }
  finish();
  const std::vector<double> time_s = read("").time_s;
  ASSERT_EQ(time_s.size(), 5U);
  for (std::size_t n = 1; n < 5; ++n) EXPECT_NEAR(time_s[n] - time_s[n - 1], 1e-3, 1.1e-3) << n;
  EXPECT_NEAR(time_s[4], 4e-3, 1.1e-3);
}

TEST_F(LcmLog, AWallClockThatWasSetMovesNoTime) {
  for (const std::int64_t set_us : {-5'000'000, 5'000'000}) {
    SetUp();
    for (int n = 0; n < 10; ++n) {
      rate_t message = sample(n, 1);
      message.seq = n;
      if (n >= 4) message.utime += set_us;
      if (n == 4) message.flags = rate_t::FLAG_CLOCK_STEP;
      add("IFOG_NOSE", message);
    }
    finish();
    const std::vector<double> time_s = read("").time_s;
    ASSERT_EQ(time_s.size(), 10U) << set_us;
    for (std::size_t n = 0; n < 10; ++n)
      EXPECT_NEAR(time_s[n], 1e-3 * static_cast<double>(n), 1e-9) << set_us;
  }
}

TEST_F(LcmLog, ALogThatIsCutOffIsReadAndSaid) {
  for (int n = 0; n < 4; ++n) add("IFOG_NOSE", sample(n, 1));
  finish();
  fs::resize_file(path_, fs::file_size(path_) - 20);
  testing::internal::CaptureStderr();
  EXPECT_EQ(read("").time_s.size(), 3U);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_TRUE(ifog::test::has(said, "\n" + path_ + ": its last "));
  EXPECT_TRUE(ifog::test::has(said, " bytes are no whole message (is the file cut off?)\n"));
  // A whole one is not complained of.
  fs::resize_file(path_, 0);
  SetUp();
  add("IFOG_NOSE", sample(0, 1));
  finish();
  testing::internal::CaptureStderr();
  EXPECT_EQ(read("").time_s.size(), 1U);
  // Its times count from 0: which moment that was is said.
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            path_ + ": t = 0 is 2023-11-14 22:13:20 UTC, the first message\n");
}

// Rows that are handed on are gone.
TEST_F(LcmLog, OfALongLogAFewThousandRowsAreHeldAtATime) {
  constexpr int kRows = 40000;
  channel_t hull{};
  hull.name = "hull_degC";
  for (int n = 0; n < kRows; ++n) {
    hull.value = n;
    if (n % 10000 == 5000) add("HULL", hull);
    add("IFOG_NOSE", sample(n, 2));
  }
  finish();
  struct Counting final : RowSink {
    void begin(const std::vector<std::string>& all) override { names = all; }
    void take(RowBlock& block) override {
      most = std::max(most, block.size());
      for (std::size_t i = 0; i < block.size(); ++i, ++rows) {
        const auto n = static_cast<double>(rows);
        wrong += std::abs(block.time_s[i] - 0.001 * n) > 1e-9 || block.columns[0][i] != 100.0 * n ||
                 block.columns[1][i] != 100.0 * n + 1.0;
        const double expected = rows % 10000 == 5000 ? n : std::nan("");
        wrong +=
            !(block.columns[2][i] == expected || (std::isnan(expected) && std::isnan(block.columns[2][i])));
      }
    }
    std::vector<std::string> names;
    std::size_t most = 0, rows = 0, wrong = 0;
  } sink;
  InputFile file(path_);
  read_lcm_log(file, "", sink);
  EXPECT_EQ(sink.names, (std::vector<std::string>{"rate_x_radps", "rate_y_radps", "hull_degC"}));
  EXPECT_EQ(sink.rows, static_cast<std::size_t>(kRows));
  EXPECT_EQ(sink.wrong, 0U);
  EXPECT_LE(sink.most, 20000U);
}

// LCM's reader wants a name; a log that came packed or through a pipe has none that it could use.
TEST_F(LcmLog, ReadsAPackedLogAndATextAtHand) {
  for (int n = 0; n < 3; ++n) add("IFOG_NOSE", sample(n, 1));
  finish();
  const std::string text = InputFile(path_).bytes();
  InputFile at_hand("-", text);
  EXPECT_EQ(read(at_hand, "").time_s, read("").time_s);
  const std::string packed = path_ + ".gz";
  write_file(packed, text);
  InputFile file(packed);
  EXPECT_EQ(read(file, "").rate_radps, read("").rate_radps);
}

}  // namespace
}  // namespace ifog::tools
