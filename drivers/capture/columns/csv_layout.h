// SPDX-License-Identifier: Apache-2.0
// How a file of columns is to be read, as a user types it: --time, --column, --sample-rate, --separator,
// --only, --repeats.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/units/units.h"

namespace ifog {

struct CsvColumn {
  std::string name;    // of the capture: rate_x_radps, temperature_degC, …
  std::string header;  // in the file, or "#3": the third column
  std::string unit;    // of its values; "": that of `name`
  double scale = 1.0;  // units in one, as of "0.00763deg/s", the counts of a converter

  // "rate_x_radps=GyroX:deg/s" or "supply_V=Supply". A rate in a unit of angle is an angle, whose differences
  // become the rate; in one "per sample" (arcsec/sample) the turn within each sample. A number before the unit
  // is the scale of counts. Throws
  // std::runtime_error with one line: the text and what was expected.
  static CsvColumn parse(const std::string& text);
  // That of `name`: "degC".
  [[nodiscard]] std::string own_unit() const;
  [[nodiscard]] bool is_rate() const;
  [[nodiscard]] bool is_increment() const;
  // rad in one unit of an angle or an increment; nothing for what is neither.
  [[nodiscard]] std::optional<double> angle_rad() const;
  // From its values to the capture's; of an angle to rad.
  [[nodiscard]] UnitConversion conversion() const;
};

struct CsvTime {
  std::string header = "time_s";  // "sec+nsec" or "date+time": two columns that are one time
  // Of its values, "ms" or "100us"; of dates as 5/6/2026 their order, "d/m/y" or "m/d/y"; "": not given, which reads
  // as seconds, and the month first.
  std::string unit;

  // "t:ms", "t:100us", "t". Throws likewise.
  static CsvTime parse(const std::string& text);
  [[nodiscard]] double unit_s() const;
};

inline constexpr const char *kDayFirst = "d/m/y", *kMonthFirst = "m/d/y";

struct CsvLayout {
  std::vector<CsvColumn> columns;        // empty: those that the file's names give
  std::optional<CsvTime> time;           // likewise
  std::optional<double> sample_rate_hz;  // rows are even, whatever a time column says
  char separator = '\0';  // '\0': as the file shows; numbers may have a decimal comma where it is no comma
  std::string only_header, only_value;  // rows whose cell of that column is this text; "": all rows
  bool keep_repeats = false;            // a row that repeats the one before is a sample
  bool other_rates = false;  // the sensor's rates that were not chosen are read too, as other_rate_y_radps

  // ";", "tab", … : one character, or that word. Throws likewise.
  static char parse_separator(const std::string& text);
  // "sensor_id=0". Throws likewise.
  void parse_only(const std::string& text);
  // Columns or the time were chosen: the others are ignored, whatever they hold.
  [[nodiscard]] bool chooses() const {
    return !columns.empty() || time.has_value() || sample_rate_hz.has_value();
  }
};

// "#3": the third column.
bool is_number_of_column(const std::string& header);
// The columns that a header asks for: "sec+nsec" is two of them, unless a column is called so; for a name may hold
// a plus itself.
std::vector<std::string> parts_of_time(const std::string& header,
                                       const std::function<bool(const std::string&)>& is_column);

// As a user types them.
std::string option_for(const CsvColumn& column, const std::string& unit);
std::string option_for(const CsvTime& time);

// The unit that a column's name ends in, "GyroX (deg/s)" or "gyro_x_dps"; "" where it names none. A counter `k`, a
// `gps_t` or an `adc_c` is in no kelvin, tesla or degrees.
std::string unit_in_name(const std::string& name);
// Where no unit was given: the one that the header names, when it is not the capture's. "" for none.
std::string other_unit(const CsvColumn& column);
std::string other_unit(const CsvTime& time);
// A text that is a unit of anything known here.
bool is_unit(const std::string& text);
// "deg/s" of "[deg/s]" and "(deg/s)".
std::string without_brackets(const std::string& unit);
// The name of a column whose unit stands apart: as it is where it says the same, or the unit is "";
// "T_degC" or "gyro_x [deg/s]" where it says none; nothing where the two contradict each other.
std::optional<std::string> name_with_unit(const std::string& header, const std::string& unit);

}  // namespace ifog
