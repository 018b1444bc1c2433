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
#include <cwchar>
#include <utility>

#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

constexpr std::array kColours{std::pair{Tone::good, static_cast<short>(COLOR_GREEN)},
                              std::pair{Tone::warning, static_cast<short>(COLOR_YELLOW)},
                              std::pair{Tone::bad, static_cast<short>(COLOR_RED)}};

// Truncates, because longer text would continue in the next line.
std::string cut(const std::string& text, int columns) {
  std::mbstate_t state{};
  int used = 0;
  for (std::size_t at = 0; at < text.size();) {
    wchar_t wide = 0;
    const std::size_t length = std::mbrtowc(&wide, text.data() + at, text.size() - at, &state);
    if (length == 0 || length > text.size() - at) return text.substr(0, at);
    used += std::max(0, wcwidth(wide));
    if (used > columns) return text.substr(0, at);
    at += length;
  }
  return text;
}

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
        scroll(-1);
        break;
      case KEY_DOWN:
      case 'j':
        scroll(1);
        break;
      case KEY_PPAGE:
        scroll(-kPage);
        break;
      case KEY_NPAGE:
        scroll(kPage);
        break;
      case KEY_RESIZE:
        break;
      default:
        return key;
    }
  }
}

void Screen::scroll(int by) {
  const auto last = static_cast<std::ptrdiff_t>(lines_) - 1;
  first_ = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(first_) + by, 0,
                                                               std::max<std::ptrdiff_t>(0, last)));
}

void Screen::draw(const std::vector<ShownLine>& lines, const std::string& foot) {
  const int rows = getmaxy(stdscr), columns = getmaxx(stdscr);
  lines_ = lines.size();
  const auto room = static_cast<std::size_t>(std::max(1, rows - 1));
  // Limits scrolling to lines that do not fit.
  first_ = std::min(first_, lines_ > room ? lines_ - room : 0);
  erase();
  for (std::size_t row = 0; row < room && first_ + row < lines_; ++row) {
    const ShownLine& line = lines[first_ + row];
    // A pair that was not defined has no colour.
    const int look =
        line.tone == Tone::figure ? static_cast<int>(A_BOLD) : COLOR_PAIR(static_cast<int>(line.tone));
    attron(look);
    mvaddnstr(static_cast<int>(row), 0, cut(line.text, columns).c_str(), -1);
    attroff(look);
  }
  if (rows > 1) {
    attron(A_REVERSE);
    mvhline(rows - 1, 0, ' ', columns);
    mvaddnstr(rows - 1, 0, cut(foot, columns - 1).c_str(), -1);
    attroff(A_REVERSE);
  }
  refresh();
}

}  // namespace ifog::tools
