// SPDX-License-Identifier: Apache-2.0
// Blocks of a flight recording. Each has its length and a checksum over its content, the file's number and
// its offset. So torn or changed blocks are detected, and data that look like a block (a recording within a
// recording) are not read as one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

struct z_stream_s;

namespace ifog {

enum class BlockType : std::uint8_t { header = 1, data = 2, end = 3 };
enum class BlockCoding : std::uint8_t { plain = 0, zlib = 1 };

inline constexpr std::uint32_t kBlockSync = 0x524649F1;  // bytes F1 'I' 'F' 'R', also at the start of a file
inline constexpr std::size_t kBlockHead = 16, kBlockTail = 4;

// Position of a block, part of its checksum. Header blocks have {0, 0}.
struct BlockPlace {
  std::uint64_t file = 0;    // random number from the file's header
  std::uint64_t offset = 0;  // of the block's first byte in the file
};

struct BlockHead {
  BlockType type = BlockType::data;
  BlockCoding coding = BlockCoding::plain;
  std::uint32_t stored = 0;   // payload in the file, bytes
  std::uint32_t content = 0;  // payload unpacked, bytes
  [[nodiscard]] std::size_t size() const { return kBlockHead + stored + kBlockTail; }
};

// Keeps the 260 kB that zlib needs from block to block. Freeing them would interrupt every processor that
// runs a thread of the process.
class Deflater {
 public:
  Deflater();  // throws std::bad_alloc
  ~Deflater();
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  // Appends the compressed content. False, without effect, if it would not become smaller.
  bool append(std::vector<std::uint8_t>& to, std::span<const std::uint8_t> content);

 private:
  std::unique_ptr<z_stream_s> stream_;
};

// Appends the block; data blocks are compressed if that makes them smaller. content: at most
// kInputLimits.block_bytes.
void append_block(std::vector<std::uint8_t>& to, BlockType type, BlockPlace place,
                  std::span<const std::uint8_t> content, Deflater& deflater);

// bytes: at least kBlockHead. False: no block starts here.
bool read_block_head(std::span<const std::uint8_t> bytes, BlockPlace place, BlockHead& out) noexcept;
// bytes: head.size(). False: wrong checksum, or the content does not unpack to the stated size.
bool read_block(std::span<const std::uint8_t> bytes, BlockPlace place, const BlockHead& head,
                std::vector<std::uint8_t>& content);

}  // namespace ifog
