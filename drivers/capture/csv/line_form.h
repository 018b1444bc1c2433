// SPDX-License-Identifier: Apache-2.0
// Converts lines of other forms, as printed by sketches and terminals, to rows of cells:
//   "10:00:00.123 -> 1,2,3"          the Arduino IDE's monitor prepends a time to each line
//   "2018-03-24 22:19:17"            a time on a separate line above its rows
//   "gx:0.1 gy:0.2", "gx=0.1, gy=0.2", {"gx":0.1,"gy":0.2}       a name before each value
//   "%RAWIMUSXA,2075,507495.165;00,…*3c6da5d7"     NovAtel ends a line's head with ";"
//   "UncalGyro,1690000000123,0.1,0.2,0.3"     each line is a record, whose cells are named by another line
//   "Gyro: 0.1 0.2 0.3 Acc: 0 0 9.8"     a name before three values, which are its axes
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

class LineForm {
 public:
  LineForm() = default;  // rows are used unchanged
  // Determines the form from the file's beginning. Throws std::runtime_error with one line for logs without rates.
  LineForm(std::string_view beginning, const std::string& path);

  [[nodiscard]] bool is_plain() const {
    return stamps_ == Stamps::none && labels_.empty() && record_.empty();
  }
  // Column names from the lines, if any; a stamp is the first.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  // Converts whole lines to rows, keeping their number. Sentences and comments become comments.
  [[nodiscard]] std::string rows_of(std::string_view text);

 private:
  enum class Stamps { none, before, above };
  void find_record(std::string_view text, const std::string& path);
  void append_row(std::string_view line, std::string& out);

  Stamps stamps_ = Stamps::none;
  std::string record_;  // prefix of the lines that are read: "%RAWIMUSXA," or "UncalGyro,"; else ""
  std::string stamp_;   // of the following rows
  std::string begin_;   // beginning of the lines that are read, lower case; "": any
  std::vector<std::string> labels_;  // before each value; "" if none
  std::vector<std::string> names_;
};

}  // namespace ifog
