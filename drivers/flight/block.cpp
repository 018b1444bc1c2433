// SPDX-License-Identifier: Apache-2.0
#include "drivers/flight/block.h"

#include <zlib.h>

#include <cstring>
#include <new>

#include "drivers/system/input_limits.h"

namespace ifog {
namespace {

// Half of the recorded bytes is noise: higher levels take five times as long and save 10 %.
constexpr int kLevel = 1;

uLong crc(uLong before, std::span<const std::uint8_t> bytes) {
  return crc32(before, bytes.data(), static_cast<uInt>(bytes.size()));
}

uLong crc_of(BlockPlace place) {
  std::uint8_t bytes[sizeof place];
  static_assert(sizeof place == 16);
  std::memcpy(bytes, &place, sizeof place);
  return crc(crc32(0, nullptr, 0), bytes);
}

// Checksum of a head, in its bytes 6 and 7.
std::uint16_t head_check(std::span<const std::uint8_t> head, BlockPlace place) {
  return static_cast<std::uint16_t>(crc(crc(crc_of(place), head.first(6)), head.subspan(8, 8)));
}

template <typename T>
T number_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  T out;
  std::memcpy(&out, bytes.data() + at, sizeof out);
  return out;
}

template <typename T>
void put_at(std::uint8_t* to, T number) {
  std::memcpy(to, &number, sizeof number);
}

}  // namespace

Deflater::Deflater() : stream_(std::make_unique<z_stream_s>()) {
  if (deflateInit(stream_.get(), kLevel) != Z_OK) throw std::bad_alloc();
}

Deflater::~Deflater() { deflateEnd(stream_.get()); }

bool Deflater::append(std::vector<std::uint8_t>& to, std::span<const std::uint8_t> content) {
  const std::size_t at = to.size();
  // One byte less than the content: the result must be smaller.
  const std::size_t room = content.empty() ? 0 : content.size() - 1;
  to.resize(at + room);
  deflateReset(stream_.get());
  stream_->next_in = const_cast<std::uint8_t*>(content.data());  // zlib does not write there
  stream_->avail_in = static_cast<uInt>(content.size());
  stream_->next_out = to.data() + at;
  stream_->avail_out = static_cast<uInt>(room);
  const bool good = deflate(stream_.get(), Z_FINISH) == Z_STREAM_END;
  to.resize(at + (good ? room - stream_->avail_out : 0));
  return good;
}

void append_block(std::vector<std::uint8_t>& to, BlockType type, BlockPlace place,
                  std::span<const std::uint8_t> content, Deflater& deflater) {
  const std::size_t at = to.size();
  to.resize(at + kBlockHead);
  const bool packed = type == BlockType::data && deflater.append(to, content);
  if (!packed) to.insert(to.end(), content.begin(), content.end());
  const std::size_t stored = to.size() - at - kBlockHead;
  std::uint8_t* const head = to.data() + at;
  put_at(head, kBlockSync);
  head[4] = static_cast<std::uint8_t>(type);
  head[5] = static_cast<std::uint8_t>(packed ? BlockCoding::zlib : BlockCoding::plain);
  put_at(head + 8, static_cast<std::uint32_t>(stored));
  put_at(head + 12, static_cast<std::uint32_t>(content.size()));
  put_at(head + 6, head_check({head, kBlockHead}, place));
  const auto check = static_cast<std::uint32_t>(crc(crc_of(place), {head, kBlockHead + stored}));
  to.resize(to.size() + kBlockTail);
  put_at(to.data() + to.size() - kBlockTail, check);
}

bool read_block_head(std::span<const std::uint8_t> bytes, BlockPlace place, BlockHead& out) noexcept {
  if (number_at<std::uint32_t>(bytes, 0) != kBlockSync) return false;
  if (number_at<std::uint16_t>(bytes, 6) != head_check(bytes, place)) return false;
  out.type = static_cast<BlockType>(bytes[4]);
  out.coding = static_cast<BlockCoding>(bytes[5]);
  out.stored = number_at<std::uint32_t>(bytes, 8);
  out.content = number_at<std::uint32_t>(bytes, 12);
  const bool known = bytes[4] >= 1 && bytes[4] <= 3 && bytes[5] <= 1;
  const bool packs = out.coding == BlockCoding::zlib;
  return known && out.content <= kInputLimits.block_bytes &&
         (packs ? out.stored < out.content : out.stored == out.content);
}

bool read_block(std::span<const std::uint8_t> bytes, BlockPlace place, const BlockHead& head,
                std::vector<std::uint8_t>& content) {
  const std::span<const std::uint8_t> checked = bytes.first(kBlockHead + head.stored);
  if (number_at<std::uint32_t>(bytes, checked.size()) !=
      static_cast<std::uint32_t>(crc(crc_of(place), checked)))
    return false;
  const std::span<const std::uint8_t> stored = checked.subspan(kBlockHead);
  if (head.coding == BlockCoding::plain) {
    content.assign(stored.begin(), stored.end());
    return true;
  }
  content.resize(head.content);
  uLongf length = head.content;
  return uncompress(content.data(), &length, stored.data(), static_cast<uLong>(stored.size())) == Z_OK &&
         length == head.content;
}

}  // namespace ifog
