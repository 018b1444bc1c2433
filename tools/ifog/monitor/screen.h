// SPDX-License-Identifier: Apache-2.0
// The whole terminal, with ncurses: lines that scroll, a line at the foot, and keys. Nothing else may write
// to the terminal while it exists.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/ifog/monitor/sensor_view.h"

namespace ifog::tools {

class Screen {
 public:
  // Throws std::runtime_error if the terminal has no such capability.
  Screen();
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  // The next character that does not scroll; 0: none.
  int key();

  [[nodiscard]] std::size_t width() const;
  // Draws what fits, from the scroll position on.
  void draw(const std::vector<ShownLine>& lines, const std::string& foot);

 private:
  int first_ = 0;  // the line on top
  void* screen_ = nullptr;
};

}  // namespace ifog::tools
