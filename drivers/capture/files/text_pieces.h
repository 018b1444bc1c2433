// SPDX-License-Identifier: Apache-2.0
// A text of any length in pieces of whole lines.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace ifog {

// Up to `most` further bytes, fewer only at the end, 0 there, as InputFile::read.
using ReadBytes = std::function<std::size_t(char* to, std::size_t most)>;

inline constexpr std::size_t kTextPiece = std::size_t{4} << 20U;  // bytes, some ten thousand rows

class TextPieces {
 public:
  // piece: bytes, about so many at once.
  explicit TextPieces(ReadBytes read, std::size_t piece = kTextPiece);

  // Replaces `to` by the next whole lines. False at the end. Only the last line may have no end, and one longer
  // than any may be, to be refused.
  bool next(std::string& to);

 private:
  ReadBytes read_;
  std::size_t piece_;
  std::string tail_;
  bool ended_ = false;
};

}  // namespace ifog
