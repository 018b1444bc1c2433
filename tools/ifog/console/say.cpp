// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/say.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <system_error>
#include <vector>

#include "drivers/ifog/quoted.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/progress.h"

namespace ifog::tools {
namespace {

std::FILE* people = stdout;
std::string data_option;  // option that reserved standard output
int failure = 0;          // errno of the first failed write to standard output

constexpr std::size_t kWhole = std::numeric_limits<std::size_t>::max();

std::string printable_lines(const std::string& text) {
  std::string out;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    out += printable(std::string_view(text).substr(begin, end - begin), kWhole);
    if (end < text.size()) out += '\n';
    begin = end + 1;
  }
  return out;
}

void put(const std::string& text, std::FILE* where) {
  clear_progress();
  if (std::fwrite(text.data(), 1, text.size(), where) != text.size() && where == stdout && failure == 0)
    failure = errno;
}

}  // namespace

void say_text(const std::string& text) { put(printable_lines(text), people); }

void warn_text(const std::string& text) { put(printable_lines(text), stderr); }

void data_to_standard_output(const std::string& option) {
  if (!data_option.empty())
    throw WrongUsage(
        option, "is to go to standard output, as is " + data_option + "; expected only one of them there");
  data_option = option;
  people = stderr;
}

bool colours_wanted() {
  const char *const no = std::getenv("NO_COLOR"), *const term = std::getenv("TERM");
  return (no == nullptr || *no == '\0') && term != nullptr && std::string_view(term) != "dumb";
}

void redraw(std::size_t before, const std::vector<ShownLine>& lines) {
  constexpr std::array<std::string_view, 5> kColours{"", "1", "32", "33", "31"};  // by Tone: SGR of ECMA-48
  const bool terminal = isatty(fileno(people)) == 1, coloured = terminal && colours_wanted();
  std::string text = terminal && before > 0 ? "\x1b[" + std::to_string(before) + "A" : "";
  for (const ShownLine& line : lines) {
    const std::string plain = printable(line.text, kLongestMessage);
    const std::string colour(kColours[static_cast<std::size_t>(line.tone)]);
    text += coloured && !colour.empty() ? "\x1b[" + colour + "m" + plain + "\x1b[m" : plain;
    text += terminal ? "\x1b[K\n" : "\n";
  }
  put(text, people);
  finish_saying();
}

void finish_saying() {
  if (std::fflush(stdout) != 0 && failure == 0) failure = errno;
  if (failure == EPIPE) throw ReaderGone();
  if (std::ferror(stdout) != 0 || failure != 0)
    throw refusal("standard output: cannot write: {}", std::generic_category().message(failure));
}

void prepare_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(fd, F_GETFD) != -1 || errno != EBADF) continue;
    // Opened in the wrong direction, so that reading or writing fails as on a closed descriptor.
    const int stand_in = ::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    if (stand_in >= 0 && stand_in != fd) ::close(stand_in);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace ifog::tools
