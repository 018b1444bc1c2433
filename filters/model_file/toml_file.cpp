// SPDX-License-Identifier: Apache-2.0
#include "filters/model_file/toml_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"

namespace ifog {
namespace {

// Rejects dotted keys with so many parts that the recursive parser would overflow its stack (50 000 in an
// optimised program). A key is on one line, whatever else that is. Throws std::runtime_error with the line.
void require_short_keys(std::string_view text, const std::string& name) {
  std::size_t dots = 0, line = 1;
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      dots = 0;
    } else if (c == '.' && ++dots > kInputLimits.toml_dots) {
      throw std::runtime_error(name + ":" + std::to_string(line) + ": more than " +
                               std::to_string(kInputLimits.toml_dots) + " dots in a line, expected fewer");
    }
  }
}

// What follows the equals sign in a line, counted from 1.
std::string_view value_in(std::string_view text, std::size_t line) {
  for (; line > 1; --line) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  text = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(text.find('='), text.size()));
  text.remove_prefix(std::min(text.find_first_not_of("= \t"), text.size()));
  return text;
}

bool is_bare_word(std::string_view value) {
  return !value.empty() &&
         (std::isalpha(static_cast<unsigned char>(value.front())) != 0 || value.front() == '/');
}

}  // namespace

std::string read_toml_text(const std::string& path) {
  const auto reason = [] { return std::generic_category().message(errno); };
  // Non-blocking, so that opening a FIFO returns.
  const int fd = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (fd < 0) throw std::runtime_error(path + ": cannot open: " + reason());
  std::string text, wrong;
  struct stat info {};
  if (fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) wrong = "is no regular file";
  std::vector<char> block(1U << 16U);
  while (wrong.empty()) {
    const ssize_t n = read(fd, block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) wrong = "cannot read: " + reason();
    if (n <= 0) break;
    text.append(block.data(), static_cast<std::size_t>(n));
    if (text.size() > kInputLimits.toml_bytes) wrong = "has more than 16 MiB, expected a TOML file";
  }
  close(fd);
  if (!wrong.empty()) throw std::runtime_error(path + ": " + wrong);
  return text;
}

toml::table parse_toml(std::string_view text, const std::string& name) {
  require_short_keys(text, name);
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    // A capture starts with column names or numbers and commas; TOML with a key or a table.
    const std::string_view line = text.substr(0, text.find('\n'));
    if (!line.starts_with('#') && line.find(',') != std::string_view::npos &&
        line.find('=') == std::string_view::npos && !line.starts_with('['))
      throw std::runtime_error(name + ": begins as a table of columns does, as of a capture, expected TOML");
    const std::size_t number = error.source().begin.line;
    throw std::runtime_error(name + ":" + std::to_string(number) + ": " +
                             (is_bare_word(value_in(text, number)) ? "a text needs quotes; " : "") +
                             printable(error.description(), kLongestMessage));
  }
}

std::optional<SettingValue> setting_value(const toml::node& node) {
  if (const auto* const value = node.as_boolean()) return value->get();
  if (const auto* const value = node.as_integer()) return value->get();
  if (const auto* const value = node.as_floating_point()) return value->get();
  if (const auto* const value = node.as_string()) return value->get();
  const toml::array* const array = node.as_array();
  if (array == nullptr) return std::nullopt;
  std::vector<double> items;
  for (const toml::node& item : *array) {
    const auto value = item.value<double>();
    if (!item.is_number() || !value) return std::nullopt;
    items.push_back(*value);
  }
  return items;
}

}  // namespace ifog
