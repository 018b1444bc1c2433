// SPDX-License-Identifier: Apache-2.0
// Which column of a foreign table is its time, and in what unit: by its name, by its values, by both.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/columns/column_roles.h"
#include "drivers/capture/times/date_time.h"

namespace ifog {

// The columns that the time may be, most likely alone: one, where one is more likely than all others. Without a unit
// where neither name nor values tell it.
std::vector<CsvTime> times_of(const TableSample& table);

// A column of whole numbers one apart, which no time is: "Sample No."; "" where there is none.
std::string counting_column(const TableSample& table);

// Not the same in all of these rows, and numbers.
bool varies(const std::vector<std::string>& cells);
// Goes from row to row by little of what it has come through, as an angle does and white noise does not.
bool is_smooth(const std::vector<std::string>& cells);
// Whole numbers, of several values.
bool is_whole(const std::vector<std::string>& cells);

// Digits behind the point that a whole number in the second column of "sec+nsec" stands for: 9 for
// nanoseconds, by its name or its values; 0 where the two are a date and a time of day.
int digits_of_second(const std::string& name, const std::vector<std::string>& cells);

// What to say of a time column of whole numbers: one apart they are a count of rows, unless their unit is given;
// further apart and without decimals they are more often milliseconds than samples of a second each. It is
// said, not changed. "" for nothing.
std::string whole_times_notice(const TableSample& table, std::size_t place, const CsvTime& time);

// The order of dates as 05/06/2023, which a day above 12 tells; nothing where it is unknown; either of all
// other times.
std::optional<DateOrder> date_order(const std::vector<std::string>& cells);

// A stated sample rate, as loggers write it above the table: "Output Rate,200.0"; nothing where none is.
std::optional<double> stated_rate_hz(const std::vector<std::string>& comments);

// What a gyro's count stands for, scale and unit, as loggers write it there: "gscale,0.00122" of the gcsv format of
// Gyroflow, "Gyro_SF=0.0151515" of Epson's logger. No unit where none does.
CsvColumn stated_scale(const std::vector<std::string>& comments);

}  // namespace ifog
