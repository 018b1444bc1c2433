// SPDX-License-Identifier: Apache-2.0
// A text's lines, one at a time, of a file of any length.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/input_file.h"

namespace ifog {

class TextLines {
 public:
  explicit TextLines(InputFile& file) : file_(file) {}

  // The next line without its end, valid until the next call; false: there is none. ended: whether it had an
  // end. Throws as InputFile::text().
  bool next(std::string_view& line, bool& ended);

 private:
  bool read_more();

  InputFile& file_;
  std::vector<char> room_;
  std::size_t at_ = 0, end_ = 0;  // in the room: the next line, and behind all that was read
  std::size_t number_ = 0;        // lines handed out
};

inline bool TextLines::next(std::string_view& line, bool& ended) {
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
inline bool TextLines::read_more() {
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
