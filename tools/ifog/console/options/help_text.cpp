// SPDX-License-Identifier: Apache-2.0
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "tools/ifog/console/options/parser_texts.h"
#include "tools/report/text.h"

namespace ifog::tools {
namespace {

constexpr std::string_view kExample = "  ifog ";

std::string broken(std::string_view line, std::size_t indent, std::size_t width) {
  std::string out(line.substr(0, indent));
  std::size_t at = report::characters_in(out);
  const std::size_t begin = at;
  line.remove_prefix(indent);
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    const std::size_t word = report::characters_in(line.substr(0, end));
    if (at > begin && at + 1 + word > width) {
      out += "\n" + std::string(begin, ' ');
      at = begin;
    } else if (at > begin) {
      out += ' ';
      ++at;
    }
    out += line.substr(0, end);
    at += word;
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return out;
}

// Breaks the parser's two columns, the second of which begins at `column`, into lines of at most `width`,
// without repeated empty lines. Examples are not broken.
std::string broken_lines(const std::string& help, std::size_t column, std::size_t width) {
  std::string out;
  bool empty = false;
  for (std::size_t from = 0; from < help.size();) {
    const std::size_t end = std::min(help.find('\n', from), help.size());
    const std::string_view line = std::string_view(help).substr(from, end - from);
    from = end + 1;
    if (line.empty() && empty) continue;
    empty = line.empty();
    const bool described = line.starts_with("  ") && line.size() > column && line[column - 1] == ' ';
    if (line.starts_with(kExample) || report::characters_in(line) <= width)
      out += line;
    else
      out += broken(line, described ? column : 0, width);
    out += '\n';
  }
  return out;
}

// Width of the terminal on standard output, limited to readable lines; 100 for other outputs.
std::size_t help_width() {
  constexpr std::size_t kUsual = 100, kLeast = 60;
  winsize size{};
  if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return kUsual;
  return std::clamp<std::size_t>(size.ws_col, kLeast, 2 * kLeast);
}

class HelpFormat final : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    return broken_lines(Formatter::make_help(app, std::move(name), mode), column_width_, help_width());
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_format() { return std::make_shared<HelpFormat>(); }

}  // namespace ifog::tools
