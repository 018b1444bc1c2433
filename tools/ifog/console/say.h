// SPDX-License-Identifier: Apache-2.0
// Text for people. All output goes through here: control characters from files, devices or the network are
// escaped, and text goes to standard error if data goes to standard output.
#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <exception>
#include <string>
#include <utility>
#include <vector>

namespace ifog::tools {

// Writes text to standard output, or to standard error if data goes there.
void say_text(const std::string& text);
// Writes text to standard error.
void warn_text(const std::string& text);

// Prints to standard output, or to standard error if data goes there. Line ends are allowed; other control
// characters are shown as \xNN. Use printable() for a name that may contain a line end.
template <typename... Values>
void say(fmt::format_string<Values...> format, Values&&... values) {
  say_text(fmt::format(format, std::forward<Values>(values)...));
}

// To standard error: errors and warnings.
template <typename... Values>
void warn(fmt::format_string<Values...> format, Values&&... values) {
  warn_text(fmt::format(format, std::forward<Values>(values)...));
}

// Reserves standard output for the data of this option; say() then prints to standard error. Call it before
// the first say(). Throws WrongUsage if another option has it.
void data_to_standard_output(const std::string& option);

// False if NO_COLOR (no-color.org) is set or the terminal has no colours.
bool colours_wanted();

enum class Tone { plain, figure, good, warning, bad };  // figure: the main figures

struct ShownLine {
  std::string text;
  Tone tone = Tone::plain;  // shown as a colour if the terminal has colours
};

// On a terminal replaces the last `before` lines; elsewhere appends. Throws as finish_saying() does.
void redraw(std::size_t before, const std::vector<ShownLine>& lines);

// Standard output was closed by its reader, e.g. `head`: ends the work without an error message. Not a
// runtime_error, so that no handler reports it.
struct ReaderGone : std::exception {};

// Flushes all output. Throws std::runtime_error with one line if that fails, e.g. disk full, or ReaderGone.
void finish_saying();

// Call it first in main. Opens descriptors 0, 1 and 2 if they are closed, because a later file must not get
// their numbers. A failed write becomes an error instead of a signal.
void prepare_standard_streams();

}  // namespace ifog::tools
