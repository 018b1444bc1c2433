// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/text_lines.h"

#include <algorithm>
#include <cstring>

namespace ifog {

bool TextLines::next(std::string_view& line, bool& ended) {
  std::size_t looked_at = 0;  // of the line
  for (;;) {
    const char* const begin = room_.data() + at_;
    const std::size_t there = end_ - at_;
    const auto* const found =
        there == looked_at
            ? nullptr
            : static_cast<const char*>(std::memchr(begin + looked_at, '\n', there - looked_at));
    ended = found != nullptr;
    const std::size_t length = ended ? static_cast<std::size_t>(found - begin) : there;
    if (length > kLongestLine) refuse_long_line(file_.path(), number_ + 1, {begin, length});
    if (ended || !read_more()) {
      line = {room_.data() + at_, length};
      at_ += length + (ended ? 1 : 0);
      number_ += ended || length > 0 ? 1 : 0;
      return ended || length > 0;
    }
    looked_at = there;
  }
}

// What is left of the last piece goes before the next.
bool TextLines::read_more() {
  std::copy(room_.begin() + static_cast<std::ptrdiff_t>(at_),
            room_.begin() + static_cast<std::ptrdiff_t>(end_), room_.begin());
  end_ -= at_;
  at_ = 0;
  constexpr std::size_t kPiece = std::size_t{1} << 18U;
  room_.resize(std::max(room_.size(), end_ + kPiece));
  const std::size_t n = file_.read(room_.data() + end_, kPiece);
  end_ += n;
  return n > 0;
}

}  // namespace ifog
