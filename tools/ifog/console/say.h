// SPDX-License-Identifier: Apache-2.0
// Text for people. Everything that a command says goes through here, so that no name or value from
// a file, a device or the network reaches the terminal as a command to it, and so that it stands on standard
// error when standard output is where the data goes.
#pragma once

#include <cstddef>
#include <exception>
#include <string>
#include <vector>

namespace ifog::tools {

// To standard output, or to standard error once data goes there. The text may have several lines; every
// other control character in it is shown as \xNN. A name that could hold a line end goes through printable().
[[gnu::format(printf, 1, 2)]] void say(const char* format, ...);

// To standard error: what went wrong or was ignored.
[[gnu::format(printf, 1, 2)]] void warn(const char* format, ...);

// The data of this option takes standard output, and people read standard error from then on. Before the
// first say(). Throws WrongUsage (usage) when a second one wants it, too.
void data_to_standard_output(const std::string& option);

// Whether a terminal may show colours: NO_COLOR (no-color.org) is not set, and it is no dumb one.
bool colours_wanted();

enum class Tone { plain, figure, good, warning, bad };  // figure: what is read first

struct ShownLine {
  std::string text;
  Tone tone = Tone::plain;  // a colour at a terminal where they are wanted
};

// Lines that take the place of the `before` lines drawn last, where people sit at a terminal; elsewhere they
// follow. Throws as finish_saying() does: nobody reads any more.
void redraw(std::size_t before, const std::vector<ShownLine>& lines);

// People have read enough, as `head` has: the end of the work, and nothing to complain of. No runtime_error,
// so that nobody makes a complaint of it on the way.
struct ReaderGone : std::exception {};

// Makes sure that all output of the run has arrived. Throws std::runtime_error with one line: full, closed, …, or
// ReaderGone.
void finish_saying();

// Before anything else in main: descriptors 0, 1 and 2 are open (a file opened later must not become standard
// output), and a write that cannot be done is an error to report, not a signal to die from.
void prepare_standard_streams();

}  // namespace ifog::tools
