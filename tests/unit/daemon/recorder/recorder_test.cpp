// SPDX-License-Identifier: Apache-2.0
// The flight recorder in the daemon: what the reader thread puts on the tape, and what the recorder makes of
// it.
#include "daemon/recorder/recorder.h"
#include "daemon/sensor/flight_header.h"
#include "drivers/flight/decode.h"
#include "drivers/host/driver_instance.h"
#include "drivers/transport/clock.h"
#include "tests/unit/daemon/delivered.h"
#include "tests/unit/daemon/rig.h"
#include "tests/unit/flight/recordings.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

FlightHeader header() {
  FlightHeader out;
  out.sensor = "nose";
  out.driver = "kvh1750";
  out.options = {{"format", "a"}};
  out.channels = {"supply_V", "coil_degC"};
  return out;
}

// The disk stands still while a sensor sends: what it has no room for is lost, counted and reported once; the
// samples all go their way; and with room all is recorded again.
TEST(Recorder, ADiskThatStandsStillCostsNoSampleAndIsToldOnce) {
  MemoryDisk disk;
  Recorder recorder("rec", Tape::kLeastBytes, std::make_unique<MemoryFolder>(disk), {}, header());
  Rig rig(frames(30'000), 360, true, 1024, 0us, true, &recorder.tape());
  rig.transport->allowed_ = 0;
  rig.pipeline->start();
  const auto give = [&](std::size_t upto) {
    rig.transport->allowed_ = upto * kFrame;
    const auto turns = [&] { return rig.pipeline->reader().books().turns; };
    std::uint64_t before = turns();
    while (rig.pipeline->reader().books().line.bytes < upto * kFrame) {
      std::this_thread::sleep_for(1ms);
      before = turns();
    }
    while (turns() == before) std::this_thread::sleep_for(1ms);  // the reader's turn ends behind the tape
  };
  std::vector<std::pair<std::string, bool>> messages;
  std::int64_t now_ns = 0;
  const auto seconds = [&](int count) {
    for (int i = 0; i < count; ++i) {
      now_ns += kSecond;
      recorder.turn(now_ns, kWall + now_ns);
      bool good = false;
      if (std::string message = recorder.take_message(good); !message.empty())
        messages.emplace_back(message, good);
    }
  };
  give(1000);
  seconds(3);
  EXPECT_TRUE(messages.empty());
  disk.refuses = ENOSPC;
  int losing_turns = 0;
  const Counter& lost_deliveries = recorder.tape().counters().lost_deliveries;
  for (std::size_t n = 2000; n <= 21'000; n += 1000) {
    const std::uint64_t before = lost_deliveries.value();
    if (n == 21'000) disk.refuses = 0;
    give(n);
    seconds(1);
    losing_turns += lost_deliveries.value() != before ? 1 : 0;
  }
  const std::uint64_t lost_at_the_end = lost_deliveries.value();
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(
      messages[0].first,
      "recorder: memory: No space left on device, nothing is recorded until it takes more; what is lost is "
      "counted");
  seconds(15);
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_TRUE(messages[1].second);
  // It lost in the turns whose 1000 frames, and what waited, found no room: the first of them to the last.
  EXPECT_EQ(messages[1].first.substr(0, messages[1].first.find(" deliveries")),
            "recorder: memory: all is recorded again, " + std::to_string(lost_at_the_end));
  EXPECT_EQ(messages[1].first.substr(messages[1].first.find(" deliveries")),
            " deliveries are lost, all within " + std::to_string(losing_turns) + ".0 s");
  rig.transport->allowed_ = ~std::size_t{0};
  while (!rig.pipeline->ended()) {
    seconds(1);
    std::this_thread::sleep_for(1ms);
  }
  rig.wait_for_the_end();
  seconds(2);
  EXPECT_EQ(messages.size(), 2U);
  EXPECT_EQ(rig.publisher->messages().size(), 30'000U);
  const std::uint64_t lost = recorder.tape().counters().lost_bytes.value();
  EXPECT_GT(lost, 100'000U);
  const ReadBack read = read_back(all_of(disk));
  std::uint64_t recorded = 0;
  for (const auto& payload : read.payloads) recorded += payload.size();
  EXPECT_EQ(recorded + lost, 30'000 * kFrame);
  EXPECT_EQ(read.counts.lost_bytes, lost);
}

const std::vector<std::uint8_t> kBytes{1, 2, 3};

// One delivery in a file that is open since.
struct Recording {
  MemoryDisk disk;
  Recorder recorder{"rec", Tape::kLeastBytes, std::make_unique<MemoryFolder>(disk), {}, header()};
  Recording() {
    recorder.tape().put(delivery(kBytes, 1), 1, {}, 0);
    recorder.turn(1 * kSecond, kWall);
    recorder.turn(3 * kSecond, kWall);
  }
};

// How often the thread of this process by that name went to sleep, by the kernel; 0: there is none.
std::uint64_t sleeps_of(const std::string& name) {
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string word;
    if (std::getline(std::ifstream(task.path() / "comm"), word); word != name) continue;
    for (std::ifstream status(task.path() / "status"); status >> word;)
      if (std::uint64_t count = 0; word == "voluntary_ctxt_switches:" && status >> count) return count;
  }
  return 0;
}

// However many deliveries there are: every time it wakes it may stand in a reader's way.
TEST(Recorder, LooksFourTimesASecondAndIsWokenByNobody) {
  MemoryDisk disk;
  Recorder recorder("rec:asleep", 4U << 20U, std::make_unique<MemoryFolder>(disk), {}, header());
  recorder.start();
  while (sleeps_of("rec:asleep") == 0) std::this_thread::sleep_for(1ms);
  const std::int64_t began_ns = monotonic_ns();
  const std::uint64_t before = sleeps_of("rec:asleep");
  for (int n = 0; n < 1000; ++n) {
    recorder.tape().put(delivery(kBytes, n), n, {}, 0);
    std::this_thread::sleep_for(1ms);
  }
  const double seconds = 1e-9 * static_cast<double>(monotonic_ns() - began_ns);
  EXPECT_LE(static_cast<double>(sleeps_of("rec:asleep") - before), 4.0 * seconds + 4.0);
  recorder.stop();
  EXPECT_EQ(recorder.counts().lost.deliveries, 0U);
}

// New settings begin a file with the very delivery that they take effect at, also where that is within a turn
// of the recorder.
TEST(Recorder, NewSettingsBeginAFileAtTheirFirstDelivery) {
  Recording recording;
  Recorder& recorder = recording.recorder;
  FlightHeader other = header();
  other.configuration = "another model";
  recorder.set_header(other, 1);
  const std::vector<std::uint8_t> last{4}, next{5};
  recorder.tape().put(delivery(last, 2), 2, {}, 0);  // with the settings before
  recorder.tape().note_settings(1);
  recorder.tape().put(delivery(next, 3), 3, {}, 0);
  recorder.turn(4 * kSecond, kWall);
  recorder.turn(6 * kSecond, kWall);
  const ReadBack read = read_back(all_of(recording.disk));
  ASSERT_EQ(read.headers.size(), 2U);
  EXPECT_EQ(read.headers[0].configuration, "");
  EXPECT_EQ(read.headers[1].configuration, "another model");
  EXPECT_EQ(read.headers[0].settings, 0U);
  EXPECT_EQ(read.headers[1].settings, 1U);
  EXPECT_EQ(read.headers[1].began, read.headers[0].number);
  EXPECT_EQ(read.payloads, (std::vector<std::vector<std::uint8_t>>{kBytes, last, next}));
  EXPECT_TRUE(read.holes.empty());
  const ReadBack second = read_back(recording.disk.files.rbegin()->second);
  EXPECT_EQ(second.payloads, std::vector<std::vector<std::uint8_t>>{next});
}

// A disk that refuses holds new settings up, and what was read before them is not taken for theirs.
TEST(Recorder, NewSettingsWaitForWhatIsBeforeThem) {
  MemoryDisk disk;
  Recorder recorder("rec", Tape::kLeastBytes, std::make_unique<MemoryFolder>(disk), {}, header());
  disk.refuses = EIO;
  const std::vector<std::uint8_t> before{1}, after{2};
  recorder.tape().put(delivery(before, 1), 1, {}, 0);
  recorder.set_header(header(), 1);
  recorder.tape().note_settings(1);
  recorder.tape().put(delivery(after, 2), 2, {}, 0);
  for (int second = 1; second < 5; ++second) recorder.turn(second * kSecond, kWall);
  disk.refuses = 0;
  for (int second = 5; second < 10; ++second) recorder.turn(second * kSecond, kWall);
  ASSERT_EQ(disk.files.size(), 2U);
  EXPECT_EQ(read_back(disk.files.begin()->second).payloads, std::vector<std::vector<std::uint8_t>>{before});
  EXPECT_EQ(read_back(disk.files.rbegin()->second).payloads, std::vector<std::vector<std::uint8_t>>{after});
}

// Nobody took anything away: the last word is of the disk, and of what waited for it.
TEST(Recorder, ADiskThatIsFullToTheEndIsSaidToBeFull) {
  Recording recording;
  Recorder& recorder = recording.recorder;
  recording.disk.room = recording.disk.used() + 40;  // for the end of the file, not for what waits
  recorder.start();
  for (int n = 2; n < 12; ++n) recorder.tape().put(delivery(kBytes, n), n, {}, 0);
  recorder.stop();
  bool good = true;
  EXPECT_EQ(recorder.take_message(good),
            "recorder: memory: No space left on device to the end, the last 10 deliveries are not recorded");
  EXPECT_FALSE(good);
  EXPECT_EQ(recorder.counts().lost.deliveries, 10U);
  EXPECT_EQ(recorder.counts().lost.bytes, 30U);
}

// New settings that no room was left for are no entry of the record.
TEST(Recorder, OfWhatIsLeftAtTheEndOnlyEntriesAreCounted) {
  Recording recording;
  Recorder& recorder = recording.recorder;
  recording.disk.refuses = EIO;
  recorder.start();
  for (std::uint32_t n = 0; n < 3; ++n) {
    recorder.tape().put(delivery(kBytes, 2), 2, {}, 0);
    recorder.set_header(header(), n + 1);
    recorder.tape().note_settings(n + 1);
  }
  recorder.stop();
  EXPECT_EQ(recorder.counts().lost.deliveries, 3U);
  EXPECT_EQ(recorder.counts().entries_unwritten, 3U);
}

TEST(Recorder, ARecordingThatIsTakenAwayIsToldAndCounted) {
  MemoryDisk disk;
  Recorder recorder("rec", Tape::kLeastBytes, std::make_unique<MemoryFolder>(disk), {}, header());
  const std::vector<std::uint8_t> bytes{1, 2, 3};
  for (int second = 1; second < 20; ++second) {
    if (second == 10) disk.files.clear();
    recorder.tape().put(delivery(bytes, second), second, {}, 0);
    recorder.turn(second * kSecond, kWall);
  }
  bool good = false;
  const std::string message = recorder.take_message(good);
  EXPECT_TRUE(test::has(message, "the recording in work has been removed"));
  EXPECT_GE(recorder.counts().lost.deliveries, 7U);
  EXPECT_EQ(recorder.counts().lost.bytes, 3 * recorder.counts().lost.deliveries);
}

// A source that keeps its bytes until they are read loses none to a recorder that is slower than the decoding
// of a file; one that nobody attends holds nothing up.
TEST(Recorder, AFileAtFreePaceIsRecordedWhole) {
  MemoryDisk disk;
  const std::vector<std::uint8_t> sent = frames(60'000);  // eight times the tape
  ASSERT_GT(sent.size(), 8 * Tape::kLeastBytes);
  Recorder recorder("rec", Tape::kLeastBytes, std::make_unique<MemoryFolder>(disk), {}, header());
  recorder.start();
  Rig rig(sent, 3600, true, 1024, 0us, true, &recorder.tape());
  rig.run_to_the_end();
  recorder.stop();
  EXPECT_EQ(recorder.counts().lost.deliveries, 0U);
  EXPECT_EQ(recorder.counts().entries_unwritten, 0U);
  EXPECT_EQ(recorder.tape().counters().bytes.value(), sent.size());
  EXPECT_EQ(recorder.counts().file_bytes, disk.used());
  const ReadBack read = read_back(all_of(disk));
  EXPECT_TRUE(losses(read.counts).empty());
  std::vector<std::uint8_t> recorded;
  for (const auto& payload : read.payloads) recorded.insert(recorded.end(), payload.begin(), payload.end());
  EXPECT_EQ(recorded, sent);
  Tape alone(Tape::kLeastBytes);
  Rig other(sent, 3600, true, 1024, 0us, true, &alone);
  other.run_to_the_end();
  EXPECT_GT(alone.counters().lost_deliveries.value(), 0U);
}

// What the daemon writes in front of a recording.

// A log's frames go back onto the interface that they came on: by the first that the driver wants.
TEST(RecordedHeader, OfALogOfCandumpTheInterfaceIsKept) {
  const test::OwnFolder folder;
  const std::string log = folder.path("frames.log");
  const DriverInstance driver = make_driver(
      "dbc", {{"dbc", std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/goetting_hg_g_84300.dbc"},
              {"signal", "Angle"},
              {"kind", "angle"}});
  ASSERT_EQ(driver.description().can_ids, 1U);
  std::array<char, 4> id{};
  std::snprintf(id.data(), id.size(), "%03X", driver.description().can_id[0].id);
  std::ofstream(log) << "(1.0) can7 7FF#00\n(1.1) vcan3 " << id.data() << "#0000000000000000\n";
  SensorConfig sensor;
  sensor.name = "nose";
  sensor.driver = "dbc";
  sensor.transport.kind = TransportConfig::Kind::file;
  sensor.transport.file.format = FileSettings::Format::candump;
  sensor.transport.file.path = log;
  Config config;
  config.file = "ifogd.toml";
  const auto interface = [&] { return flight_header(sensor, config, driver, "").interface; };
  EXPECT_EQ(interface(), "vcan3");
  sensor.transport.interface = "can1";
  EXPECT_EQ(interface(), "can1");
  sensor.transport.kind = TransportConfig::Kind::can;
  EXPECT_EQ(interface(), "can1");
  sensor.transport.kind = TransportConfig::Kind::file;
  sensor.transport.interface.clear();
  sensor.transport.file.path = log + ".not-there";
  EXPECT_EQ(interface(), "");
}

}  // namespace
}  // namespace ifog
