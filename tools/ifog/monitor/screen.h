// SPDX-License-Identifier: Apache-2.0
// A terminal as a whole, on ncurses: lines that can be scrolled, a line at its foot, keys. As long as it
// lives nothing else may write there.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/ifog/monitor/view_lines.h"

namespace ifog::tools {

class Screen {
 public:
  // Throws std::runtime_error where the terminal cannot be drawn on.
  Screen();
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  // The next key that was pressed and does not scroll, a character; 0: none is waiting.
  int key();

  [[nodiscard]] std::size_t width() const;
  // Draws what fits, from the line that was scrolled to.
  void draw(const std::vector<ShownLine>& lines, const std::string& foot);

 private:
  void scroll(int by);

  std::size_t first_ = 0, lines_ = 0;
  void* screen_ = nullptr;
};

}  // namespace ifog::tools
