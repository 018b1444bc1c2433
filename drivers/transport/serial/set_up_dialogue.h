// SPDX-License-Identifier: Apache-2.0
// Sets a device up by lines of text, one at a time, each with its answer: what is sent when, and whether what
// comes back is the answer. No I/O. As KVH's IMU take it (1775 IMU technical manual 56-0298, sections 7 and 8):
// "=DR,1000" is answered by "DR,1000", "?DR" by "DR," and the value, what is refused by "INVALID" and more,
// whatever the case of the letters; until =CONFIG,1 is answered, frames of bytes come in between.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

class SetUpDialogue {
 public:
  // A line is "=COMMAND", "?QUERY" whatever its answer, or "WORDS -> ANSWER".
  explicit SetUpDialogue(const std::vector<std::string>& lines);
  // What is wrong with such a line, "expected …"; "": nothing.
  static std::string complaint(std::string_view line);

  [[nodiscard]] bool done() const { return at_ == lines_.size(); }
  // The line that waits for its answer, as configured, and what was to come back.
  [[nodiscard]] const std::string& line() const { return lines_[at_].sent; }
  [[nodiscard]] const std::string& expected() const { return lines_[at_].answer; }
  // What has come since the line was sent. True: it is answered, the next one's turn.
  bool take(std::span<const std::uint8_t> bytes);
  // An answer that differs, "": there was none.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  // All answers so far, with commas.
  [[nodiscard]] const std::string& answers() const { return answers_; }

 private:
  struct Line {
    std::string sent, answer;
    bool any;  // whatever follows the answer's first word
  };
  bool judge(const std::string& text);

  std::vector<Line> lines_;
  std::size_t at_ = 0;
  std::string text_;  // printable characters since the last other one
  std::string refusal_, answers_;
};

}  // namespace ifog
