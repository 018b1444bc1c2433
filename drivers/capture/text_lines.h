// SPDX-License-Identifier: Apache-2.0
// A text's lines, one at a time, of a file of any length.
#pragma once

#include <cstddef>
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

}  // namespace ifog
