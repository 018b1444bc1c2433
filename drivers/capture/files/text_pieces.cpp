// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/files/text_pieces.h"

#include <algorithm>
#include <utility>

#include "drivers/capture/files/input_file.h"

namespace ifog {

TextPieces::TextPieces(ReadBytes read, std::size_t piece)
    : read_(std::move(read)), piece_(std::max<std::size_t>(1, piece)) {}

bool TextPieces::next(std::string& to) {
  to.assign(tail_);
  tail_.clear();
  while (!ended_) {
    const std::size_t before = to.size();
    to.resize(before + piece_);
    const std::size_t n = read_(to.data() + before, piece_);
    to.resize(before + n);
    ended_ = n < piece_;
    const std::size_t last = to.rfind('\n');
    if (last == std::string::npos || last < before) {
      if (to.size() > kLongestLine) return true;
      continue;
    }
    tail_.assign(to, last + 1);
    to.resize(last + 1);
    return true;
  }
  return !to.empty();
}

}  // namespace ifog
