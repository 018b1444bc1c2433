// SPDX-License-Identifier: Apache-2.0
// A text of any length in pieces of whole lines.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace ifog {

// Up to `most` further bytes, fewer only at the end, 0 there, as InputFile::read.
using ReadBytes = std::function<std::size_t(char* to, std::size_t most)>;

// Bytes of a text in memory that is used again for the next: nothing is written there but what is read.
class TextRoom {
 public:
  [[nodiscard]] std::string_view text() const { return {room_.get(), size_}; }
  // Room for so many behind the text, of which took() says how many there are now.
  [[nodiscard]] char* behind(std::size_t most);
  void took(std::size_t bytes) { size_ += bytes; }
  void assign(std::string_view text);
  void end_at(std::size_t size) { size_ = size; }

 private:
  std::unique_ptr<char[]> room_;
  std::size_t capacity_ = 0, size_ = 0;
};

inline constexpr std::size_t kTextPiece = std::size_t{4} << 20U;  // bytes, some ten thousand rows

class TextPieces {
 public:
  // piece: bytes, about so many at once.
  explicit TextPieces(ReadBytes read, std::size_t piece = kTextPiece);

  // False at the end. Only the last line may have no end, and one longer than any may be, to be refused.
  bool next(TextRoom& to);

 private:
  ReadBytes read_;
  std::size_t piece_;
  std::string tail_;
  bool ended_ = false;
};

}  // namespace ifog
