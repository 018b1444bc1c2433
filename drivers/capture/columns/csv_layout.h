// SPDX-License-Identifier: Apache-2.0
// How a file of columns is read, from the options --time, --column, --sample-rate, --separator, --only,
// --repeats.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/units/units.h"

namespace ifog {

struct CsvColumn {
  std::string name;    // in the capture: rate_x_radps, temperature_degC, …
  std::string header;  // in the file, or "#3": the third column
  std::string unit;    // of its values; "": the unit of `name`
  double scale = 1.0;  // number of units per value, as in "0.00763deg/s" for counts

  // Parses "rate_x_radps=GyroX:deg/s" or "supply_V=Supply". A rate with a unit of angle is an angle and is
  // differentiated; "per sample" (arcsec/sample) is the turn in each sample. A number before the unit is the
  // scale of counts. Throws std::runtime_error with one line: the text and what was expected.
  static CsvColumn parse(const std::string& text);
  // Unit of `name`: "degC".
  [[nodiscard]] std::string own_unit() const;
  [[nodiscard]] bool is_rate() const;
  // rad per unit of an angle or increment; nullopt otherwise.
  [[nodiscard]] std::optional<double> angle_rad() const;
  // Conversion to the capture's unit; of an angle to rad.
  [[nodiscard]] UnitConversion conversion() const;
};

// Time in which the increments in other columns turned; without it they are of the time between rows.
inline constexpr const char* kInterval = "interval_s";

struct CsvTime {
  std::string header = "time_s";  // "sec+nsec" or "date+time": two columns form one time
  // Unit, "ms" or "100us"; for dates like 5/6/2026 the order, "d/m/y" or "m/d/y"; "": seconds, or month
  // first.
  std::string unit;
  std::string remark{};  // about a unit that no name states: " (not named; gives 100 Hz)"

  // Parses "t:ms", "t:100us", "t". Throws likewise.
  static CsvTime parse(const std::string& text);
  [[nodiscard]] double unit_s() const;
};

inline constexpr const char *kDayFirst = "d/m/y", *kMonthFirst = "m/d/y";

struct CsvLayout {
  std::vector<CsvColumn> columns;        // empty: given by the file's names
  std::optional<CsvTime> time;           // nullopt: given by the file's names
  std::optional<double> sample_rate_hz;  // rows are equidistant, regardless of a time column
  char separator = '\0';  // '\0': detected; numbers may have a decimal comma if the separator is no comma
  std::string only_header, only_value;  // only rows with this text in that column; all if one is empty
  bool keep_repeats = false;            // rows that repeat the one before are kept
  bool other_rates = false;             // also read the sensor's other rates, as other_rate_y_radps

  // Parses one character, or a word: ";", "tab", … Throws likewise.
  static char parse_separator(const std::string& text);
  // Parses "sensor_id=0", or "sensor_id=*" for all rows. Throws likewise.
  void parse_only(const std::string& text);
  // True if columns or time were chosen; then the others are ignored.
  [[nodiscard]] bool chooses() const {
    return !columns.empty() || time.has_value() || sample_rate_hz.has_value();
  }
};

// "#3": the third column.
bool is_number_of_column(const std::string& header);
// Columns in a header option: two in "sec+nsec", unless a column has this name with its plus sign.
std::vector<std::string> parts_of_time(const std::string& header,
                                       const std::function<bool(const std::string&)>& is_column);

// Option text as a user types it.
std::string option_for(const CsvColumn& column, const std::string& unit);
std::string option_for(const CsvTime& time);

// "gyro_rad" of "gyro_rad[0]", a column of a matrix.
std::string without_index(const std::string& name);
// Unit at the end of a column's name, "GyroX (deg/s)" or "gyro_x_dps", or "". A counter `k`, a `gps_t` or an
// `adc_c` is not in kelvin, tesla or degrees.
std::string unit_in_name(const std::string& name);
// True for a known unit.
bool is_unit(const std::string& text);
// "deg/s" of "[deg/s]" or "(deg/s)".
std::string without_brackets(const std::string& unit);
// Name of a column with a separate unit: unchanged if it contains the same unit or the unit is ""; with the
// unit appended, "T_degC" or "gyro_x [deg/s]", if it contains none; nullopt if they contradict.
std::optional<std::string> name_with_unit(const std::string& header, const std::string& unit);

}  // namespace ifog
