// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/files/text_pieces.h"

#include <algorithm>
#include <utility>

#include "drivers/capture/files/input_file.h"

namespace ifog {

TextPieces::TextPieces(ReadBytes read, std::size_t piece)
    : read_(std::move(read)), piece_(std::max<std::size_t>(1, piece)) {}

bool TextPieces::next(std::string& to) {
  // A string that is used again is overwritten by what is read, without zeros before that.
  std::size_t before = tail_.size();
  to.reserve(before + piece_ + piece_ / 16);
  if (to.size() < before) to.resize(before);
  std::copy(tail_.begin(), tail_.end(), to.begin());
  tail_.clear();
  while (!ended_) {
    to.resize(before + piece_);
    const std::size_t n = read_(to.data() + before, piece_);
    to.resize(before + n);
    ended_ = n < piece_;
    const std::size_t last = to.rfind('\n');
    if (last == std::string::npos || last < before) {
      if (to.size() > kLongestLine) return true;
      before = to.size();
      continue;
    }
    tail_.assign(to, last + 1);
    to.resize(last + 1);
    return true;
  }
  to.resize(before);
  return !to.empty();
}

}  // namespace ifog
