// SPDX-License-Identifier: Apache-2.0
// Dialogue that sets up a device with lines of text, one at a time, each with its answer. No I/O. As for
// KVH's IMU (1775 IMU technical manual 56-0298, sections 7 and 8): "=DR,1000" is answered by "DR,1000", "?DR"
// by "DR," and the value, errors by "INVALID" and a text, in any case; frames of bytes may be in between
// until =CONFIG,1 is answered.
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
  // A line is "=COMMAND", "?QUERY" with any answer, or "WORDS -> ANSWER".
  explicit SetUpDialogue(const std::vector<std::string>& lines);
  // Error in such a line, "expected …"; "": none.
  static std::string complaint(std::string_view line);

  [[nodiscard]] bool done() const { return at_ == lines_.size(); }
  // The line that waits for its answer, as configured, and the expected answer.
  [[nodiscard]] const std::string& line() const { return lines_[at_].sent; }
  [[nodiscard]] const std::string& expected() const { return lines_[at_].answer; }
  // Takes received bytes. True: the line is answered.
  bool take(std::span<const std::uint8_t> bytes);
  // The wrong answer; "": no answer.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  // All answers so far, separated by "; ".
  [[nodiscard]] const std::string& answers() const { return answers_; }

 private:
  struct Line {
    std::string sent, answer;
    bool any;  // anything may follow the answer's first word
  };
  bool judge(const std::string& text);

  std::vector<Line> lines_;
  std::size_t at_ = 0;
  std::string text_;  // printable characters since the last other one
  std::string refusal_, answers_;
};

}  // namespace ifog
