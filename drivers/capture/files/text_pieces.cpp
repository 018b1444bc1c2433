// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/files/text_pieces.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "drivers/capture/files/input_file.h"

namespace ifog {

char* TextRoom::behind(std::size_t most) {
  if (size_ + most > capacity_) {
    capacity_ = std::max(size_ + most, capacity_ + capacity_ / 2);
    auto larger = std::make_unique_for_overwrite<char[]>(capacity_);
    if (size_ > 0) std::memcpy(larger.get(), room_.get(), size_);
    room_ = std::move(larger);
  }
  return room_.get() + size_;
}

void TextRoom::assign(std::string_view text) {
  size_ = 0;
  if (!text.empty()) std::memcpy(behind(text.size()), text.data(), text.size());
  size_ = text.size();
}

TextPieces::TextPieces(ReadBytes read, std::size_t piece)
    : read_(std::move(read)), piece_(std::max<std::size_t>(1, piece)) {}

bool TextPieces::next(TextRoom& to) {
  // With room for what follows, or the beginning of a line is moved for it.
  to.end_at(0);
  (void)to.behind(tail_.size() + piece_);
  to.assign(tail_);
  tail_.clear();
  while (!ended_) {
    const std::size_t before = to.text().size();
    const std::size_t n = read_(to.behind(piece_), piece_);
    to.took(n);
    ended_ = n < piece_;
    const std::size_t last = to.text().rfind('\n');
    if (last == std::string_view::npos || last < before) {
      if (to.text().size() > kLongestLine) return true;
      continue;
    }
    tail_ = to.text().substr(last + 1);
    to.end_at(last + 1);
    return true;
  }
  return !to.text().empty();
}

}  // namespace ifog
