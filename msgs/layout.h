// SPDX-License-Identifier: Apache-2.0
// Which bytes can be a message of a type at all: asked before LCM's generated decoder is let loose on them.
// That decoder believes every count and length it finds, and allocates and indexes by them: a count of -1 or
// 2^31-1, or a string of length 0, ends the program.
//
// LCM's format (lcm-proj.github.io, "Type specification"): the type's hash, 8 bytes; then the members in
// order, big-endian; an array's counts are members before it; a string is its length with the ending 0, an
// int32, and its bytes.
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
  // Reads the text of a .lcm file with one struct of numbers, strings and arrays of them. Throws
  // std::invalid_argument for anything else.
  explicit MessageLayout(std::string_view definition);

  // `members`: the message behind its hash. True: every count is one, and with them it has exactly these
  // bytes.
  [[nodiscard]] bool fits(std::span<const std::uint8_t> members) const;

 private:
  struct Member {
    std::size_t size = 0;   // bytes of an element; 0: a string
    std::size_t fixed = 1;  // elements that the type itself says
    std::string name;
    std::vector<std::size_t> counts;  // the members that say how many, the outermost first
  };
  void add(std::string_view type, std::string_view name);

  std::vector<Member> members_;
};

}  // namespace ifog
