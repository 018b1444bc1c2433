// SPDX-License-Identifier: Apache-2.0
// A flight recording is a row of blocks. Each says how long it is and carries a checksum over its content,
// the file's own number and its place in the file: what is torn or changed is found, and nothing that merely
// looks like a block (a recording within a recording) is read as one.
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

inline constexpr std::uint32_t kBlockSync = 0x524649F1;  // bytes F1 'I' 'F' 'R', of a file's first block, too
inline constexpr std::size_t kBlockHead = 16, kBlockTail = 4;

// Where a block stands: its checksum holds only there. Header blocks have {0, 0}.
struct BlockPlace {
  std::uint64_t file = 0;    // the random number in the file's header
  std::uint64_t offset = 0;  // of the block's first byte in the file
};

struct BlockHead {
  BlockType type = BlockType::data;
  BlockCoding coding = BlockCoding::plain;
  std::uint32_t stored = 0;   // bytes of payload in the file
  std::uint32_t content = 0;  // bytes of it, unpacked
  [[nodiscard]] std::size_t size() const { return kBlockHead + stored + kBlockTail; }
};

// The 260 kB that deflating needs are kept from block to block: allocated for each, every processor that
// runs a thread of the process would be interrupted for the pages that go.
class Deflater {
 public:
  Deflater();  // throws std::bad_alloc
  ~Deflater();
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  // Appends content as zlib has it; false, and nothing is appended: it does not get smaller.
  bool append(std::vector<std::uint8_t>& to, std::span<const std::uint8_t> content);

 private:
  std::unique_ptr<z_stream_s> stream_;
};

// Appends the block. What deflates to less is deflated, of data blocks. content: at most kInputLimits.block_bytes.
void append_block(std::vector<std::uint8_t>& to, BlockType type, BlockPlace place,
                  std::span<const std::uint8_t> content, Deflater& deflater);

// At least kBlockHead bytes. False: no block begins here.
bool read_block_head(std::span<const std::uint8_t> bytes, BlockPlace place, BlockHead& out) noexcept;
// `bytes`: head.size() of them. False: the checksum is wrong, or it does not unpack to what it says.
bool read_block(std::span<const std::uint8_t> bytes, BlockPlace place, const BlockHead& head,
                std::vector<std::uint8_t>& content);

}  // namespace ifog
