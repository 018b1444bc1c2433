// SPDX-License-Identifier: Apache-2.0
// What the reader thread puts on the tape, and what comes off it.
#include <sys/resource.h>

#include "daemon/recorder/tape.h"
#include "drivers/flight/decode.h"
#include "tests/unit/daemon/delivered.h"
#include "tests/unit/flight/recordings.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

struct Taken {
  std::vector<FlightEntryHead> heads;
  std::vector<FlightKind> kinds;
  std::vector<std::vector<std::uint8_t>> payloads;
};

Taken all_of(Tape& tape) {
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
  const std::vector<std::uint8_t> bytes{1, 2, 3};
  std::vector<ChannelValue> channels(2);
  tape.put(delivery(bytes, 10), 11, channels, 0);
  channels[1] = {12.5, 9};
  tape.put(delivery(bytes, 20), 21, channels, 0);
  tape.put(delivery(bytes, 30), 31, channels, 5);
  tape.put(delivery(bytes, 40), 41, channels, 5);
  channels[1].value = 13.0;  // set between the reading of its time and of its value
  tape.put(delivery(bytes, 0), 51, channels, 5);
  const Taken taken = all_of(tape);
  using K = FlightKind;
  EXPECT_EQ(taken.kinds, (std::vector<K>{K::bytes, K::channel, K::bytes, K::wall, K::bytes, K::bytes,
                                         K::channel, K::bytes}));
  EXPECT_EQ(taken.heads[1].time_ns, 9);
  EXPECT_EQ(taken.heads[1].index, 1);
  EXPECT_EQ(taken.heads[5].flags, 0);
  EXPECT_EQ(taken.heads[7].flags, kFlightReadTime);  // when it arrived is not known
  EXPECT_EQ(taken.heads[7].time_ns, 51);
}

TEST(Tape, WhatWasMergedIsSaidBeforeTheDeliveryItWasSeenAt) {
  Tape tape(Tape::kLeastBytes);
  const std::vector<std::uint8_t> bytes{1, 2, 3};
  std::uint64_t total = 0;
  for (const std::uint64_t more : {0, 3, 0, 4}) {
    total += more;
    tape.put(delivery(bytes, 10), 11, {}, 0, total);
  }
  const Taken taken = all_of(tape);
  using K = FlightKind;
  ASSERT_EQ(taken.kinds, (std::vector<K>{K::bytes, K::merged, K::bytes, K::bytes, K::merged, K::bytes}));
  EXPECT_EQ(taken.payloads[1], (std::vector<std::uint8_t>{3, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(taken.payloads[4], (std::vector<std::uint8_t>{4, 0, 0, 0, 0, 0, 0, 0}));
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
  EXPECT_EQ(all_of(tape).heads.size(), 300 - lost);
  // With room again: first what is missing, then the channel that changed meanwhile, then the data.
  channels[0] = {3.0, 2};
  opened.restarted = false;
  tape.put(opened, 400, channels, 0);
  const Taken taken = all_of(tape);
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
  const Taken taken = all_of(tape);
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

// Two real threads over a small queue: nothing changes on the way, and what is missing is what was counted.
TEST(Tape, BetweenTwoThreadsNothingIsTornOrOutOfOrder) {
  Tape tape(Tape::kLeastBytes);
  constexpr std::uint64_t kCount = 200'000;
  std::atomic<bool> done{false};
  std::thread producer([&] {
    for (std::uint64_t n = 0; n < kCount; ++n) {
      const std::vector<std::uint8_t> bytes = numbered(n, 50);
      tape.put(delivery(bytes, static_cast<std::int64_t>(n + 1)), 1, {}, 0);
    }
    done = true;
  });
  std::uint64_t next = 0, lost = 0;
  bool last = false;
  while (!last) {
    last = done.load();
    const Taken taken = all_of(tape);
    for (std::size_t i = 0; i < taken.heads.size(); ++i) {
      if (taken.heads[i].kind == FlightKind::lost) {
        std::uint64_t told = 0;
        std::memcpy(&told, taken.payloads[i].data(), sizeof told);
        next += told;
        lost += told;
        continue;
      }
      ASSERT_EQ(taken.payloads[i], numbered(next, 50));
      ASSERT_EQ(taken.heads[i].time_ns, static_cast<std::int64_t>(next + 1));
      ++next;
    }
    if (next % 3 == 0) std::this_thread::sleep_for(2ms);
  }
  producer.join();
  EXPECT_EQ(next + (tape.counters().lost_deliveries.value() - lost), kCount);
}

}  // namespace
}  // namespace ifog
