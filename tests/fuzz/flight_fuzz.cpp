// SPDX-License-Identifier: Apache-2.0
// Any bytes as a flight recording, as entries of a valid block, and as text of a valid header: no crash, no
// payload beyond its data, and every byte of a file without blocks counted.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <vector>

#include "drivers/flight/block.h"
#include "drivers/flight/decode.h"
#include "drivers/flight/flight_reader.h"

namespace {

using namespace ifog;

void read_all(std::span<const std::uint8_t> recording) {
  FlightReader reader(recording);
  std::uint64_t sum = 0, entries = 0;
  try {
    for (auto item = reader.next(); item != FlightReader::Item::end; item = reader.next()) {
      if (item != FlightReader::Item::entry) continue;
      ++entries;
      for (const std::uint8_t byte : reader.entry().payload) sum += byte;
      ifog_can_frame frame;
      if (frame_of(reader.entry(), frame) && frame.length > sizeof frame.data) std::abort();
    }
  } catch (const std::runtime_error&) {
    return;  // not a recording, or another version
  }
  const FlightCounts& counts = reader.counts();
  if (entries > counts.entries ||
      counts.torn_bytes + counts.damaged_bytes > recording.size() + sum + (4U << 20U))
    std::abort();
}

std::vector<std::uint8_t> header_block(std::span<const std::uint8_t> text) {
  std::vector<std::uint8_t> payload{1, 0, 0, 0, 0, 0, 0, 0, 1, 0}, out;
  payload.insert(payload.end(), text.begin(), text.end());
  Deflater deflater;
  append_block(out, BlockType::header, {}, payload, deflater);
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> rest(data + 1, size - 1);
  if (data[0] == 'h') {
    const std::vector<std::uint8_t> recording = header_block(rest);
    try {
      const FlightHeader header = parse_header(std::span(recording).subspan(kBlockHead, rest.size() + 10));
      // Parsed content is written unchanged.
      if (!(parse_header(header_payload(header)) == header)) std::abort();
    } catch (const std::runtime_error&) {
    }
    read_all(recording);
  } else if (data[0] == 'e') {
    std::vector<std::uint8_t> recording = header_block({});
    Deflater deflater;
    append_block(recording, BlockType::data, {1, recording.size()}, rest, deflater);
    append_block(recording, BlockType::end, {1, recording.size()},
                 rest.first(std::min<std::size_t>(16, rest.size())), deflater);
    read_all(recording);
  } else {
    std::vector<std::uint8_t> recording = header_block({});
    recording.insert(recording.end(), rest.begin(), rest.end());
    read_all(recording);
    read_all({data, size});
  }
  return 0;
}
