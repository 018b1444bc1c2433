// SPDX-License-Identifier: Apache-2.0
// The format to the byte, by hand, against its description (drivers/flight/format.md).
#include "tests/unit/flight/recordings.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using Bytes = std::vector<std::uint8_t>;

// CRC-32 by its definition (ISO-HDLC: reflected polynomial EDB88320, all ones before and after), bit by bit.
std::uint32_t crc32_by_hand(const Bytes& bytes) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

void put(Bytes& to, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) to.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void put(Bytes& to, const std::string& text) { to.insert(to.end(), text.begin(), text.end()); }

// A plain block at `offset` of file `file`, as format.md says.
Bytes block_by_hand(int type, std::uint64_t file, std::uint64_t offset, const Bytes& payload) {
  Bytes place, out{0xF1, 'I', 'F', 'R', static_cast<std::uint8_t>(type), 0};
  put(place, file, 8);
  put(place, offset, 8);
  Bytes lengths;
  put(lengths, payload.size(), 4);
  put(lengths, payload.size(), 4);
  Bytes checked = place;
  checked.insert(checked.end(), out.begin(), out.end());
  checked.insert(checked.end(), lengths.begin(), lengths.end());
  put(out, crc32_by_hand(checked) & 0xFFFFU, 2);
  out.insert(out.end(), lengths.begin(), lengths.end());
  out.insert(out.end(), payload.begin(), payload.end());
  checked = place;
  checked.insert(checked.end(), out.begin(), out.end());
  put(out, crc32_by_hand(checked), 4);
  return out;
}

void add_block(Bytes& recording, int type, std::uint64_t file, const Bytes& payload) {
  const Bytes block = block_by_hand(type, file, recording.size(), payload);
  recording.insert(recording.end(), block.begin(), block.end());
}

void add_entry(Bytes& entries, int kind, int flags, std::uint64_t time_ns, const Bytes& payload) {
  put(entries, static_cast<std::uint64_t>(kind), 1);
  put(entries, static_cast<std::uint64_t>(flags), 1);
  put(entries, 0, 2);
  put(entries, payload.size(), 4);
  put(entries, time_ns, 8);
  entries.insert(entries.end(), payload.begin(), payload.end());
}

TEST(FlightFormat, AFileMadeByHandIsRead) {
  constexpr std::uint64_t kFile = 0x1122334455667788;
  Bytes recording, header, entries, end;
  put(header, kFile, 8);
  put(header, 1, 2);
  put(header,
      "sensor=nose\ncarries=bytes\ndriver=kvh1750\noption.format=b\nchannel=supply_V\nrun=7\nnumber=3\n"
      "a_key_of_later=x\nconfiguration=a\\nb\\\\c\n");
  recording = block_by_hand(1, 0, 0, header);
  add_entry(entries, 3, 0, 41, {0, 0, 0, 0, 0, 0, 0x29, 0x40});  // a channel, 12.5 V
  add_entry(entries, 1, 4, 42, {'a', 'b', 'c'});                 // bytes, stamped
  add_block(recording, 2, kFile, entries);
  put(end, 2, 8);
  put(end, 43, 8);
  add_block(recording, 3, kFile, end);

  std::size_t at = 0;
  FlightReader reader([&](char* to, std::size_t most) {
    const std::size_t n = std::min(most, recording.size() - at);
    std::memcpy(to, recording.data() + at, n);
    at += n;
    return n;
  });
  ASSERT_EQ(reader.next(), FlightReader::Item::header);
  EXPECT_EQ(reader.header().sensor, "nose");
  EXPECT_EQ(reader.header().run, 7U);
  EXPECT_EQ(reader.header().number, 3U);
  EXPECT_EQ(reader.header().options.at("format"), "b");
  EXPECT_EQ(reader.header().channels, std::vector<std::string>{"supply_V"});
  EXPECT_EQ(reader.header().configuration, "a\nb\\c");
  ASSERT_EQ(reader.next(), FlightReader::Item::entry);
  double value = 0.0;
  EXPECT_EQ(reader.entry().head.kind, FlightKind::channel);
  ASSERT_TRUE(reader.entry().value(value));
  EXPECT_EQ(value, 12.5);
  EXPECT_EQ(reader.entry().head.time_ns, 41);
  ASSERT_EQ(reader.next(), FlightReader::Item::entry);
  EXPECT_EQ(reader.entry().head.flags, kFlightStamped);
  EXPECT_EQ(reader.entry().head.time_ns, 42);
  EXPECT_EQ(std::string(reader.entry().payload.begin(), reader.entry().payload.end()), "abc");
  EXPECT_EQ(reader.next(), FlightReader::Item::end);
  EXPECT_EQ(reader.next(), FlightReader::Item::end);
  EXPECT_TRUE(losses(reader.counts()).empty());
}

TEST(FlightFormat, WhatIsWrittenIsWhatTheDescriptionSays) {
  const Bytes payload{1, 2, 3};
  Bytes written;
  Deflater deflater;
  append_block(written, BlockType::data, {99, 1234}, payload, deflater);  // too short to get smaller
  EXPECT_EQ(written, block_by_hand(2, 99, 1234, payload));
  written.clear();
  append_block(written, BlockType::header, {}, payload, deflater);
  EXPECT_EQ(written, block_by_hand(1, 0, 0, payload));
  // Each is deflated by itself.
  const Bytes even(5000, 0x2A);
  Bytes first, second;
  for (Bytes* const block : {&first, &second}) append_block(*block, BlockType::data, {99, 0}, even, deflater);
  EXPECT_EQ(first[5], 1);
  EXPECT_LT(first.size(), 100U);
  EXPECT_EQ(second, first);
}

TEST(FlightFormat, AHeaderComesBackAsItWas) {
  FlightHeader header = some_header();
  header.file = 1;
  header.run = ~std::uint64_t{0};
  header.number = 12;
  header.opened_ns = -5;
  for (const auto carries :
       {FlightHeader::Carries::bytes, FlightHeader::Carries::can, FlightHeader::Carries::messages}) {
    header.carries = carries;
    EXPECT_EQ(parse_header(header_payload(header)), header);
  }
}

TEST(FlightFormat, WhatIsNoneSaysSo) {
  EXPECT_THROW(read_back({}), std::runtime_error);
  EXPECT_THROW(read_back({1, 2, 3}), std::runtime_error);
  Bytes header;
  put(header, 1, 8);
  put(header, 2, 2);  // a version of the format that is not known
  EXPECT_EQ(test::refusal([&] { read_back(block_by_hand(1, 0, 0, header)); }),
            "is a flight recording of version 2, expected version 1");
}

// A data block whose entries do not fill it: the checksum is right, so it is the writer that was wrong.
TEST(FlightFormat, AnEntryLongerThanItsBlockIsCountedAndTheNextBlockRead) {
  Bytes header;
  put(header, 5, 8);
  put(header, 1, 2);
  Bytes recording = block_by_hand(1, 0, 0, header);
  Bytes bad;
  append_entry(bad, {FlightKind::bytes, 0, 0, 0, 1}, Bytes{7});
  bad[4] = 200;
  Bytes good;
  append_entry(good, {FlightKind::bytes, 0, 0, 0, 2}, Bytes{8});
  add_block(recording, 2, 5, bad);
  add_block(recording, 2, 5, good);
  const ReadBack read = read_back(recording);
  EXPECT_EQ(read.payloads, std::vector<Bytes>{Bytes{8}});
  EXPECT_EQ(read.counts.damaged_bytes, bad.size());
  EXPECT_EQ(read.holes, std::vector<std::size_t>{0});
}

}  // namespace
}  // namespace ifog
