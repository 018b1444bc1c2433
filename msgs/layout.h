// SPDX-License-Identifier: Apache-2.0
// Checks that bytes are a possible message of a type, before LCM's generated decoder reads them. The decoder
// trusts every count and length: a count of -1 or 2^31-1, or a string of length 0, crashes the program.
//
// LCM's format (lcm-proj.github.io, "Type specification"): the type's hash, 8 bytes; then the members in
// order, big-endian. An array's counts are earlier members. A string is an int32 length including the
// terminating 0, and its bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

class MessageLayout {
 public:
  // Parses a .lcm file with one struct of numbers, strings and arrays of them. Throws std::invalid_argument
  // for anything else.
  explicit MessageLayout(std::string_view definition);

  // `members`: the message after its hash. True if all counts are valid and give exactly this number of
  // bytes.
  [[nodiscard]] bool fits(std::span<const std::uint8_t> members) const;

 private:
  struct Member {
    std::size_t size = 0;   // bytes per element; 0: a string
    std::size_t fixed = 1;  // number of elements in the type
    std::string name;
    std::vector<std::size_t> counts;  // members with the number of elements, the outermost first
  };
  void add(std::string_view type, std::string_view name);

  std::vector<Member> members_;
};

}  // namespace ifog
