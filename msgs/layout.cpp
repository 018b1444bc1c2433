// SPDX-License-Identifier: Apache-2.0
#include "msgs/layout.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>
#include <utility>

namespace ifog {
namespace {

constexpr std::array<std::pair<std::string_view, std::size_t>, 9> kTypes{{{"int8_t", 1},
                                                                          {"byte", 1},
                                                                          {"boolean", 1},
                                                                          {"int16_t", 2},
                                                                          {"int32_t", 4},
                                                                          {"float", 4},
                                                                          {"int64_t", 8},
                                                                          {"double", 8},
                                                                          {"string", 0}}};

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = std::min(text.find_first_not_of(kBlanks), text.size());
  text.remove_prefix(first);
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

// Removes `bytes` from the front; false if there are fewer.
bool take(std::span<const std::uint8_t>& from, std::size_t bytes) {
  if (bytes > from.size()) return false;
  from = from.subspan(bytes);
  return true;
}

// Big-endian, signed; the caller has checked the length.
std::int64_t number(std::span<const std::uint8_t> from, std::size_t bytes) {
  std::uint64_t value = (from[0] & 0x80U) != 0 ? ~std::uint64_t{0} : 0;
  for (std::size_t i = 0; i < bytes; ++i) value = value << 8U | from[i];
  return static_cast<std::int64_t>(value);
}

// Length of an array if the type defines it; 0: in another member.
std::size_t fixed_count(std::string_view text) {
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  return error == std::errc() && end == text.data() + text.size() ? count : 0;
}

bool take_string(std::span<const std::uint8_t>& from) {
  constexpr std::size_t kLength = 4;
  if (from.size() < kLength) return false;
  const std::int64_t length = number(from, kLength);
  from = from.subspan(kLength);
  return length >= 1 && static_cast<std::uint64_t>(length) <= from.size() &&
         from[static_cast<std::size_t>(length) - 1] == 0 && take(from, static_cast<std::size_t>(length));
}

}  // namespace

MessageLayout::MessageLayout(std::string_view definition) {
  const std::size_t open = definition.find("{\n"), close = definition.rfind('}');
  if (open == std::string_view::npos || close == std::string_view::npos)
    throw std::invalid_argument("no struct in an LCM definition");
  std::string_view rest = definition.substr(open + 1, close - open - 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    line = trimmed(line.substr(0, line.find("//")));
    if (line.empty() || line.starts_with("const ")) continue;
    const std::size_t blank = line.find(' ');
    if (blank == std::string_view::npos || line.back() != ';' || line.find(';') != line.size() - 1)
      throw std::invalid_argument("not one member a line in an LCM definition: " + std::string(line));
    line.remove_suffix(1);
    add(line.substr(0, blank), trimmed(line.substr(blank)));
  }
}

void MessageLayout::add(std::string_view type, std::string_view name) {
  const auto known =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.first == type; });
  if (known == kTypes.end()) throw std::invalid_argument("unknown LCM type: " + std::string(type));
  Member member;
  member.size = known->second;
  std::size_t bracket = name.find('[');
  member.name = name.substr(0, bracket);
  while (bracket != std::string_view::npos) {
    const std::size_t close = name.find(']', bracket);
    const std::string_view count = name.substr(bracket + 1, close - bracket - 1);
    if (const std::size_t fixed = fixed_count(count); fixed > 0) {
      member.fixed *= fixed;
      bracket = name.find('[', close);
      continue;
    }
    const auto said = std::find_if(members_.begin(), members_.end(),
                                   [&](const Member& other) { return other.name == count; });
    if (said == members_.end() || said->size == 0 || !said->counts.empty())
      throw std::invalid_argument("no number before it counts an LCM array: " + std::string(name));
    member.counts.push_back(static_cast<std::size_t>(said - members_.begin()));
    bracket = name.find('[', close);
  }
  members_.push_back(std::move(member));
}

bool MessageLayout::fits(std::span<const std::uint8_t> bytes) const {
  const std::size_t total = bytes.size();
  // Values of integer members, for use as counts.
  std::vector<std::int64_t> value(members_.size(), 0);
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const Member& member = members_[m];
    std::size_t elements = member.fixed;
    for (const std::size_t count : member.counts) {
      // A count may not exceed the message's bytes, so that no product overflows. Also checked if an inner
      // count is 0, because the decoder allocates the outer array.
      if (value[count] < 0 || static_cast<std::uint64_t>(value[count]) > total || elements > total)
        return false;
      elements *= static_cast<std::size_t>(value[count]);
    }
    if (elements > bytes.size()) return false;
    if (member.size == 0) {
      for (std::size_t i = 0; i < elements; ++i)
        if (!take_string(bytes)) return false;
      continue;
    }
    if (elements * member.size > bytes.size()) return false;
    if (member.counts.empty() && member.fixed == 1) value[m] = number(bytes, member.size);
    bytes = bytes.subspan(elements * member.size);
  }
  return bytes.empty();
}

}  // namespace ifog
