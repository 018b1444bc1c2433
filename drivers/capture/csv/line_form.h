// SPDX-License-Identifier: Apache-2.0
// Lines that are no rows of cells yet, as sketches print them and terminals log them:
//   "10:00:00.123 -> 1,2,3"          the Arduino IDE's monitor puts its time in front of each line
//   "2018-03-24 22:19:17"            a time on a line of its own, above its rows
//   "gx:0.1 gy:0.2", "gx=0.1, gy=0.2", {"gx":0.1,"gy":0.2}       each value has its name before it
//   "%RAWIMUSXA,2075,507495.165;00,…*3c6da5d7"     NovAtel ends the head of a line with ";"
//   "UncalGyro,1690000000123,0.1,0.2,0.3"     each line is of a record, whose cells another line names
//   "Gyro: 0.1 0.2 0.3 Acc: 0 0 9.8"     a name stands before three values: its axes
// They become rows of cells, line by line, and all that follows reads them as any other.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

class LineForm {
 public:
  LineForm() = default;  // rows as they are
  // Of a file that begins so.
  explicit LineForm(std::string_view beginning);

  [[nodiscard]] bool is_plain() const {
    return stamps_ == Stamps::none && labels_.empty() && record_.empty();
  }
  // The names of the columns, where the lines have them; a stamp is the first.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  // The next whole lines as rows of cells, as many lines. A line of another form becomes a comment.
  [[nodiscard]] std::string rows_of(std::string_view text);

 private:
  enum class Stamps { none, before, above };
  void find_record(std::string_view text);
  void append_row(std::string_view line, std::string& out);

  Stamps stamps_ = Stamps::none;
  std::string record_;  // "%RAWIMUSXA," or "UncalGyro,": that of the lines that are read; "" of other files
  std::string stamp_;   // of the rows that follow
  std::string begin_;   // of the lines that are read, in small letters; "" for any
  std::vector<std::string> labels_;  // before each value; "" where none stands
  std::vector<std::string> names_;
};

}  // namespace ifog
