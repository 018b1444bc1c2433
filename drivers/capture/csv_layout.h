// SPDX-License-Identifier: Apache-2.0
// What a CSV file that is no capture by its header says under other names and in other units: which of its
// columns are those of a capture.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace ifog {

struct CsvColumn {
  std::string name;    // of the capture: rate_x_radps, temperature_degC, …
  std::string header;  // in the file
  std::string unit;    // of its values; "": that of `name`

  // "rate_x_radps=GyroX:deg/s" or "supply_V=Supply". A rate in a unit of angle is an angle, whose differences
  // become the rate; in one "per sample" (arcsec/sample) the turn within each sample. Throws
  // std::runtime_error with one line: the text and what was expected.
  static CsvColumn parse(const std::string& text);
  [[nodiscard]] bool is_rate() const;
  [[nodiscard]] bool is_angle() const;
  [[nodiscard]] bool is_increment() const;
  // rad in one unit of an angle or an increment; nothing for what is neither.
  [[nodiscard]] std::optional<double> angle_rad() const;
  // The unit that the header names where none was told, and that is not the name's; "" for none.
  [[nodiscard]] std::string other_unit() const;
};

struct CsvTime {
  std::string header = "time_s";
  double unit_s = 1.0;

  // "t:ms" or "t", which is in seconds. Throws likewise.
  static CsvTime parse(const std::string& text);
  bool told = false;                             // the unit was
  [[nodiscard]] std::string other_unit() const;  // likewise
};

struct CsvLayout {
  std::vector<CsvColumn> columns;  // empty: every column stands under its own name
  std::optional<CsvTime> time;     // nullopt: the first column is time_s
  char separator = ',';            // with another, numbers may have a decimal comma

  // ";", "tab", … : one character, or that word. Throws likewise.
  static char parse_separator(const std::string& text);
  // Reads columns by choice: those that nobody chose are passed over, whatever is in them.
  [[nodiscard]] bool chooses() const { return !columns.empty() || time.has_value(); }
};

// The options with which a file of these headers may be read, "" if nothing in them looks like a gyro's:
// "--time Time:ms --column rate_x_radps=GyroX:deg/s". UNIT stands where the header names none. Of the other
// columns those whose unit is known. dated: the times are dates, whose unit is no question.
std::string option_for(const CsvColumn& column, const std::string& unit);
std::string option_for(const CsvTime& time, const std::string& unit);
std::string suggested_options(const std::vector<std::string>& headers, bool dated = false);
// A text that is a unit of anything known here.
bool is_unit(const std::string& text);
// The name of a column of which a row below the header says the unit: as it is where it says the same, or the
// row says none ("-", "1"), "T_degC" or "gyro_x [deg/s]" where it says none; nothing where the two contradict
// each other.
std::optional<std::string> name_with_unit(const std::string& header, const std::string& unit);
// The separator that the line may have been meant with: "--separator ';'", "" for none.
std::string suggested_separator(const std::string& header_line);

}  // namespace ifog
