// SPDX-License-Identifier: Apache-2.0
// The flight recorder in the daemon: what the reader thread puts on the tape, and what the recorder makes of
// it.
#include <sys/resource.h>

#include "daemon/recorder/recorder.h"
#include "drivers/flight/decode.h"
#include "drivers/transport/clock.h"
#include "tests/unit/daemon/rig.h"
#include "tests/unit/flight/recordings.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

// As a transport brings it.
Delivery delivery(const std::vector<std::uint8_t>& bytes, std::int64_t arrival_ns) {
  Delivery out;
  out.bytes = bytes;
  out.arrival_ns = arrival_ns;
  return out;
}

FlightHeader header() {
  FlightHeader out;
  out.sensor = "nose";
  out.driver = "kvh1750";
  out.options = {{"format", "a"}};
  out.channels = {"supply_V", "coil_degC"};
  return out;
}

const std::vector<std::uint8_t> kBytes{1, 2, 3};

struct Recording {
  explicit Recording(const std::string& name = "rec", std::size_t tape_bytes = Tape::kLeastBytes)
      : recorder(name, tape_bytes, std::make_unique<MemoryFolder>(disk), {}, header()) {}
  // One delivery in a file that is open since.
  void begin() {
    recorder.tape().put(delivery(kBytes, 1), 1, {}, 0);
    recorder.turn(1 * kSecond, kWall);
    recorder.turn(3 * kSecond, kWall);
  }
  void seconds(int from, int to) {
    for (int second = from; second < to; ++second) recorder.turn(second * kSecond, kWall);
  }
  MemoryDisk disk;
  Recorder recorder;
};

// The disk stands still while a sensor sends: what it has no room for is lost, counted and reported once; the
// samples all go their way; and with room all is recorded again.
TEST(Recorder, ADiskThatStandsStillCostsNoSampleAndIsToldOnce) {
  Recording recording;
  auto& [disk, recorder] = recording;
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
  Recording recording("rec:asleep", 4U << 20U);
  Recorder& recorder = recording.recorder;
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
  auto& [disk, recorder] = recording;
  recording.begin();
  FlightHeader other = header();
  other.configuration = "another model";
  recorder.set_header(other, 1);
  const std::vector<std::uint8_t> last{4}, next{5};
  recorder.tape().put(delivery(last, 2), 2, {}, 0);  // with the settings before
  recorder.tape().note_settings(1);
  recorder.tape().put(delivery(next, 3), 3, {}, 0);
  recorder.turn(4 * kSecond, kWall);
  recorder.turn(6 * kSecond, kWall);
  const ReadBack read = read_back(all_of(disk));
  ASSERT_EQ(read.headers.size(), 2U);
  EXPECT_EQ(read.headers[0].configuration, "");
  EXPECT_EQ(read.headers[1].configuration, "another model");
  EXPECT_EQ(read.headers[0].settings, 0U);
  EXPECT_EQ(read.headers[1].settings, 1U);
  EXPECT_EQ(read.headers[1].began, read.headers[0].number);
  EXPECT_EQ(read.payloads, (std::vector<std::vector<std::uint8_t>>{kBytes, last, next}));
  EXPECT_TRUE(read.holes.empty());
  const ReadBack second = read_back(disk.files.rbegin()->second);
  EXPECT_EQ(second.payloads, std::vector<std::vector<std::uint8_t>>{next});
}

// A disk that refuses holds new settings up, and what was read before them is not taken for theirs.
TEST(Recorder, NewSettingsWaitForWhatIsBeforeThem) {
  Recording recording;
  auto& [disk, recorder] = recording;
  disk.refuses = EIO;
  const std::vector<std::uint8_t> before{1}, after{2};
  recorder.tape().put(delivery(before, 1), 1, {}, 0);
  recorder.set_header(header(), 1);
  recorder.tape().note_settings(1);
  recorder.tape().put(delivery(after, 2), 2, {}, 0);
  recording.seconds(1, 5);
  disk.refuses = 0;
  recording.seconds(5, 10);
  ASSERT_EQ(disk.files.size(), 2U);
  EXPECT_EQ(read_back(disk.files.begin()->second).payloads, std::vector<std::vector<std::uint8_t>>{before});
  EXPECT_EQ(read_back(disk.files.rbegin()->second).payloads, std::vector<std::vector<std::uint8_t>>{after});
}

// Nobody took anything away: the last word is of the disk, and of what waited for it.
TEST(Recorder, ADiskThatIsFullToTheEndIsSaidToBeFull) {
  Recording recording;
  auto& [disk, recorder] = recording;
  recording.begin();
  disk.room = disk.used() + 40;  // for the end of the file, not for what waits
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
  auto& [disk, recorder] = recording;
  recording.begin();
  disk.refuses = EIO;
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
  Recording recording;
  auto& [disk, recorder] = recording;
  for (int second = 1; second < 20; ++second) {
    if (second == 10) disk.files.clear();
    recorder.tape().put(delivery(kBytes, second), second, {}, 0);
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
  Recording recording;
  auto& [disk, recorder] = recording;
  const std::vector<std::uint8_t> sent = frames(60'000);  // eight times the tape
  ASSERT_GT(sent.size(), 8 * Tape::kLeastBytes);
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

// What the reader thread puts on the tape, and what comes off it.

struct Taken {
  std::vector<FlightEntryHead> heads;
  std::vector<FlightKind> kinds;
  std::vector<std::vector<std::uint8_t>> payloads;
};

Taken taken_from(Tape& tape) {
  Taken out;
  FlightEntryHead head;
  std::vector<std::uint8_t> payload;
  while (tape.take(head, payload)) {
    out.heads.push_back(head);
    out.kinds.push_back(head.kind);
    out.payloads.push_back(payload);
  }
  return out;
}

TEST(Tape, ChannelsAndTheWallClockAreRecordedWhenTheyChange) {
  Tape tape(Tape::kLeastBytes);
  std::vector<ChannelValue> channels(2);
  tape.put(delivery(kBytes, 10), 11, channels, 0);
  channels[1] = {12.5, 9};
  tape.put(delivery(kBytes, 20), 21, channels, 0);
  tape.put(delivery(kBytes, 30), 31, channels, 5);
  tape.put(delivery(kBytes, 40), 41, channels, 5);
  channels[1].value = 13.0;  // set between the reading of its time and of its value
  tape.put(delivery(kBytes, 0), 51, channels, 5);
  const Taken taken = taken_from(tape);
  using K = FlightKind;
  EXPECT_EQ(taken.kinds, (std::vector<K>{K::bytes, K::channel, K::bytes, K::wall, K::bytes, K::bytes,
                                         K::channel, K::bytes}));
  EXPECT_EQ(taken.heads[1].time_ns, 9);
  EXPECT_EQ(taken.heads[1].index, 1);
  EXPECT_EQ(taken.heads[5].flags, 0);
  EXPECT_EQ(taken.heads[7].flags, kFlightReadTime);  // when it arrived is not known
  EXPECT_EQ(taken.heads[7].time_ns, 51);
}

TEST(Tape, WhatFindsNoRoomIsLeftOutCountedAndTold) {
  Tape tape(Tape::kLeastBytes);
  const std::vector<std::uint8_t> bytes(1000, 7);
  std::vector<ChannelValue> channels(1);
  Delivery opened = delivery(bytes, 1);
  for (int n = 0; n < 300; ++n) {
    opened.restarted = n == 280;  // among those that find no room
    tape.put(opened, n + 1, channels, 0);
  }
  const std::uint64_t lost = tape.counters().lost_deliveries.value();
  EXPECT_GT(lost, 20U);
  EXPECT_EQ(tape.counters().deliveries.value(), 300U);
  EXPECT_EQ(tape.counters().lost_bytes.value(), lost * 1000);
  EXPECT_EQ(taken_from(tape).heads.size(), 300 - lost);
  // With room again: first what is missing, then the channel that changed meanwhile, then the data.
  channels[0] = {3.0, 2};
  opened.restarted = false;
  tape.put(opened, 400, channels, 0);
  const Taken taken = taken_from(tape);
  ASSERT_EQ(taken.heads.size(), 3U);
  EXPECT_EQ(taken.heads[0].kind, FlightKind::lost);
  std::uint64_t told[2];
  ASSERT_EQ(taken.payloads[0].size(), sizeof told);
  std::memcpy(told, taken.payloads[0].data(), sizeof told);
  EXPECT_EQ(told[0], lost);
  EXPECT_EQ(told[1], lost * 1000);
  EXPECT_EQ(taken.heads[1].kind, FlightKind::channel);
  EXPECT_NE(taken.heads[2].flags & kFlightReopened, 0);
}

// Where memory is not locked, too: on the first round of the tape the reader waits for no page of it.
TEST(Tape, EveryPageIsThereBeforeTheReaderNeedsIt) {
  Tape tape(4U << 20U);
  const std::vector<std::uint8_t> bytes(4000);
  const auto faults = [] {
    rusage used{};
    getrusage(RUSAGE_THREAD, &used);
    return used.ru_minflt;
  };
  tape.put(delivery(bytes, 1), 1, {}, 0);
  const long before = faults();
  for (int n = 2; n < 1000; ++n) tape.put(delivery(bytes, n), n, {}, 0);
  EXPECT_LE(faults() - before, 2);
  EXPECT_EQ(tape.counters().lost_deliveries.value(), 0U);
}

TEST(Tape, EachCanFrameHasItsTime) {
  Tape tape(Tape::kLeastBytes);
  std::vector<ifog_can_frame> frames(3);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].id = static_cast<std::uint32_t>(0x100 + i);
    frames[i].length = static_cast<std::uint8_t>(i * 4);
    frames[i].data[0] = static_cast<std::uint8_t>(i);
    frames[i].arrival_ns = i == 2 ? 0 : static_cast<std::int64_t>(i + 50);
  }
  Delivery from_bus;
  from_bus.frames = frames;
  from_bus.restarted = true;
  tape.put(from_bus, 99, {}, 0);
  const Taken taken = taken_from(tape);
  ASSERT_EQ(taken.heads.size(), 3U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ifog_can_frame back{};
    ASSERT_TRUE(frame_of({taken.heads[i], taken.payloads[i]}, back));
    EXPECT_EQ(back.id, frames[i].id);
    EXPECT_EQ(back.length, frames[i].length);
    EXPECT_EQ(back.arrival_ns, frames[i].arrival_ns);
    EXPECT_EQ(taken.heads[i].time_ns, i == 2 ? 99 : static_cast<std::int64_t>(i + 50));
    EXPECT_EQ((taken.heads[i].flags & kFlightReopened) != 0, i == 0);
  }
}

}  // namespace
}  // namespace ifog
