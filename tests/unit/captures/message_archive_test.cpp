// SPDX-License-Identifier: Apache-2.0
// Messages into recordings: what is lost is lost in one place, and a folder is one recorder's.
#include "tools/ifog/captures/lcm/message_archive.h"

#include <gtest/gtest.h>

#include <cerrno>

#include "tests/unit/flight/recordings.h"
#include "tests/unit/messages.h"

namespace ifog::tools {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000, kWall = 1'700'000'000 * kSecond;

FlightHeader of_messages() {
  FlightHeader out = some_header();
  out.carries = FlightHeader::Carries::messages;
  return out;
}

std::vector<std::uint8_t> message_of(std::int64_t seq) {
  rate_t message = rate(1);
  message.seq = seq;
  message.utime = kWall / 1000 + seq * 1000;
  message.sensor_time_ns = -1;
  message.dt = 1e-3;
  return encoded(message);
}

// A disk that takes nothing for a while, and messages that LCM lost before and after, while the disk was
// well.
TEST(MessageArchive, WhatIsLostHereIsNotLostOnTheWayAsWell) {
  MemoryDisk disk;
  MessageArchive archive(std::make_unique<MemoryFolder>(disk), {}, of_messages());
  std::int64_t now_ns = 0;
  archive.open(now_ns, kWall);
  std::uint64_t heard = 0;
  for (std::int64_t seq = 0; seq < 20'000; ++seq) {
    disk.refuses = seq >= 5000 && seq < 12'000 ? ENOSPC : 0;
    now_ns += kSecond / 1000;
    if ((seq >= 1000 && seq < 1100) || (seq >= 15'000 && seq < 15'007)) continue;
    archive.take("IFOG_NOSE", message_of(seq), (kWall + now_ns) / 1000, now_ns, kWall + now_ns);
    archive.turn(now_ns, kWall + now_ns);
    ++heard;
  }
  archive.close(now_ns, kWall + now_ns);
  const MessageArchive::Books books = archive.books();
  EXPECT_EQ(books.received, heard);
  EXPECT_EQ(books.lost_on_way, 107U);
  EXPECT_GT(books.lost_here, 1000U);
  // What the recording holds and what it says is lost is all there was.
  const std::vector<std::uint8_t> all = all_of(disk);
  FlightReader reader(all);
  std::uint64_t held = 0;
  for (auto item = reader.next(); item != FlightReader::Item::end; item = reader.next())
    if (item == FlightReader::Item::entry && reader.entry().head.kind == FlightKind::message) ++held;
  EXPECT_EQ(held, heard - books.lost_here);
  EXPECT_EQ(reader.counts().lost_messages, books.lost_here + books.lost_on_way);
  EXPECT_EQ(held + reader.counts().lost_messages, 20'000U);
}

}  // namespace
}  // namespace ifog::tools
