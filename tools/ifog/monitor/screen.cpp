// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/screen.h"

#define NCURSES_WIDECHAR 1
#define NCURSES_NOMACROS 1
#include <curses.h>
#include <langinfo.h>

#include <algorithm>
#include <array>
#include <clocale>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

constexpr std::array kColours{std::pair{Tone::good, static_cast<short>(COLOR_GREEN)},
                              std::pair{Tone::warning, static_cast<short>(COLOR_YELLOW)},
                              std::pair{Tone::bad, static_cast<short>(COLOR_RED)}};

}  // namespace

Screen::Screen() {
  // Units and spark lines are UTF-8 in any locale.
  if (std::setlocale(LC_CTYPE, "") == nullptr || std::strcmp(nl_langinfo(CODESET), "UTF-8") != 0)
    std::setlocale(LC_CTYPE, "C.UTF-8");
  // initscr() exits if the terminal is unknown; newterm() returns an error.
  screen_ = newterm(nullptr, stdout, stdin);
  if (screen_ == nullptr) {
    const char* const term = std::getenv("TERM");
    throw refusal("terminal {}: cannot be drawn on; --plain writes lines",
                  term != nullptr ? term : "of no name (TERM)");
  }
  cbreak();
  noecho();
  keypad(stdscr, TRUE);
  nodelay(stdscr, TRUE);
  curs_set(0);
  if (colours_wanted() && has_colors()) {
    start_color();
    use_default_colors();
    for (const auto& [tone, colour] : kColours) init_pair(static_cast<short>(tone), colour, -1);
  }
}

Screen::~Screen() {
  endwin();
  delscreen(static_cast<SCREEN*>(screen_));
}

std::size_t Screen::width() const { return static_cast<std::size_t>(std::max(1, getmaxx(stdscr))); }

int Screen::key() {
  constexpr int kPage = 20;
  for (;;) {
    switch (const int key = getch()) {
      case ERR:
        return 0;
      case KEY_UP:
      case 'k':
        --first_;
        break;
      case KEY_DOWN:
      case 'j':
        ++first_;
        break;
      case KEY_PPAGE:
        first_ -= kPage;
        break;
      case KEY_NPAGE:
        first_ += kPage;
        break;
      case KEY_RESIZE:
        break;
      default:
        return key;
    }
  }
}

void Screen::draw(const std::vector<ShownLine>& lines, const std::string& foot) {
  const int rows = getmaxy(stdscr), columns = getmaxx(stdscr);
  const int room = std::max(1, rows - 1), all = static_cast<int>(lines.size());
  first_ = std::clamp(first_, 0, std::max(0, all - room));
  erase();
  for (int row = 0; row < room && first_ + row < all; ++row) {
    const ShownLine& line = lines[static_cast<std::size_t>(first_ + row)];
    // A pair that was not defined has no colour.
    const int look =
        line.tone == Tone::figure ? static_cast<int>(A_BOLD) : COLOR_PAIR(static_cast<int>(line.tone));
    attron(look);
    mvinsstr(row, 0, line.text.c_str());  // cut at the edge
    attroff(look);
  }
  if (rows > 1) {
    attron(A_REVERSE);
    mvhline(rows - 1, 0, ' ', columns);
    mvinsstr(rows - 1, 0, foot.c_str());
    attroff(A_REVERSE);
  }
  refresh();
}

}  // namespace ifog::tools
