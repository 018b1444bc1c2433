// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/hdf5_rows.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "drivers/capture/chosen_columns.h"
#include "drivers/capture/column_names.h"
#include "drivers/capture/column_roles.h"
#include "drivers/capture/csv_header.h"
#include "drivers/capture/hdf5/hdf5_attributes.h"
#include "drivers/capture/hdf5/hdf5_input.h"
#include "drivers/capture/measurable.h"
#include "drivers/capture/row_checks.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

constexpr const char* kTime = kHdf5Time;

[[noreturn]] void refuse(const std::string& path, const std::string& what) { fail_at(path, 0, what); }

std::string unit_of_name(const std::string& name) {
  const std::size_t line = name.rfind('_');
  return line == std::string::npos ? "" : name.substr(line + 1);
}

// As a comment of a CSV file is.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

bool picks(const CsvLayout& layout) { return !layout.columns.empty(); }
std::string time_of(const CsvLayout& layout) { return layout.time.value_or(CsvTime{}).header; }

std::vector<std::string> wanted_of(const CsvLayout& layout, const std::string& path) {
  if (!picks(layout)) return {};
  std::vector<std::string> wanted{time_of(layout)};
  for (const CsvColumn& column : layout.columns) {
    if (std::find(wanted.begin(), wanted.end(), column.header) != wanted.end())
      refuse(path, "dataset " + in_quotes(column.header) + " is chosen twice");
    wanted.push_back(column.header);
  }
  return wanted;
}

// What the attributes say where the layout is silent.
CsvLayout completed(CsvLayout layout, const Hdf5Header& header, const std::string& path) {
  if (!layout.time && header.exact_time) layout.time = CsvTime{kHdf5ExactTime, 1e-9, true};
  if (layout.time)
    if (const std::string unit = other_unit(*layout.time); !unit.empty())
      refuse(path, unit_by_name(layout.time->header, unit, option_for(*layout.time, unit)));
  for (std::size_t i = 0; i < layout.columns.size(); ++i) {
    CsvColumn& column = layout.columns[i];
    if (!column.unit.empty()) continue;
    column.unit = header.units[i + 1];
    if (!column.angle_rad() && !convert_unit(column.unit, unit_of_name(column.name))) column.unit.clear();
    if (const std::string unit = other_unit(column); !unit.empty())
      refuse(path, unit_by_name(column.header, unit, option_for(column, unit)));
  }
  return layout;
}

// A name that a CSV file's header can hold, whose unit is not another than its attribute says.
void check_names(const Hdf5Header& header, const CsvLayout& layout, const std::string& path) {
  for (std::size_t i = 0; i < header.names.size(); ++i) {
    const std::string &name = header.names[i], &unit = header.units[i];
    if (layout.time && name == layout.time->header) continue;
    if (name.find_first_of(",\"\n\r") != std::string::npos || name.front() == ' ' || name.back() == ' ')
      refuse(path, "a dataset is called " + in_quotes(name) +
                       ", expected a name as a CSV file's header has it, without comma, quote or line end");
    const auto by = convert_unit(unit, unit_of_name(name));
    if (unit.empty() || !by || (by->scale == 1.0 && by->offset == 0.0)) continue;
    refuse(path, in_quotes(name) + " is in " + in_quotes(unit) + " by its attribute 'units', expected " +
                     in_quotes(unit_of_name(name)) +
                     "; to read it as it is: " + (name == kTime ? "--time " : "--column ") +
                     shell_word((name == kTime ? name : name + "=" + name) + ":" + printable(unit)));
  }
}

// Which of the file's columns is the time; of picked columns the first that was asked for.
std::size_t place_of_time(const Hdf5Header& header, const CsvLayout& layout, const std::string& path) {
  if (picks(layout)) return 0;
  check_names(header, layout, path);
  return static_cast<std::size_t>(std::find(header.names.begin(), header.names.end(), time_of(layout)) -
                                  header.names.begin());
}

// For a file that is no capture by its names: the columns that they give, or those that were asked for besides
// them. notice: how it is read.
CsvLayout layout_of(const Hdf5File& file, const std::string& group, CsvLayout asked, std::string& notice) {
  if (!asked.only_header.empty() || asked.sample_rate_hz)
    refuse(file.path, "is an HDF5 file, expected none of --only and --sample-rate with it");
  if (asked.time && picks(asked) && !asked.other_rates) return asked;
  Hdf5Input probe(file, group, {}, "");
  const Hdf5Header& header = probe.header();
  const auto has = [&](const std::string& name) {
    return std::find(header.names.begin(), header.names.end(), name) != header.names.end();
  };
  const bool rates = std::any_of(header.names.begin(), header.names.end(), [](const std::string& name) {
    return is_rate_column(name) || is_signal_column(name);
  });
  TableSample sample{header.names, {}, header.units, header.comments, true};
  const auto with_other_rates = [&](CsvLayout layout) {
    if (layout.other_rates && picks(layout))
      for (const CsvColumn& other : rates_not_chosen(sample, layout)) layout.columns.push_back(other);
    return layout;
  };
  if ((rates || picks(asked)) && has(time_of(asked))) return with_other_rates(asked);
  std::vector<std::vector<double>> block;
  constexpr std::size_t kRows = 64;
  probe.next(block);
  for (std::size_t c = 0; c < block.size(); ++c) {
    const double from =
        header.time_from && header.names[c] == kTime ? static_cast<double>(*header.time_from) : 0.0;
    sample.cells.emplace_back();
    for (std::size_t row = 0; row < std::min(kRows, block[c].size()); ++row)
      sample.cells.back().push_back(shortest(from + block[c][row]));
  }
  const Readings found = readings_of(sample, asked);
  if (found.ways.empty() && has(time_of(asked))) return asked;
  const Reading* const clear = found.clear();
  if (clear == nullptr || clear->layout.time->header.find('+') != std::string::npos)
    refuse(file.path,
           found.why + options_in_words(found) +
               (found.ways.empty() ? "; its columns are " + printable(listed(header.names), kLongestMessage)
                                   : ""));
  notice = file.path + ": read as: " + in_words(clear->layout);
  return with_other_rates(clear->layout);
}

class Hdf5Rows {
 public:
  Hdf5Rows(InputFile& file, const std::string& group, const CsvLayout& asked, RowSink& sink);
  RowNotes read();

 private:
  void take_time(std::vector<double>& time);
  [[nodiscard]] double unit_s() const { return layout_.time.value_or(CsvTime{}).unit_s; }
  // As it stands in the file.
  [[nodiscard]] std::string said(double time) const;
  void take_out_impossible(std::size_t column, std::vector<double>& values);

  InputFile& file_;
  const std::string path_;
  const Hdf5File source_;
  std::string notice_;
  const CsvLayout asked_;
  Hdf5Input input_;
  const CsvLayout layout_;
  const std::size_t time_;
  const Measurable time_range_;
  const std::optional<std::int64_t> time_from_;  // in whole numbers
  const TimeStamps stamps_;
  std::vector<FileColumn> columns_;
  std::vector<ImpossibleValues> impossible_;  // of each
  RowSink& sink_;
  RowNotes notes_;
  std::optional<RowChecks> checks_;
};

Hdf5Rows::Hdf5Rows(InputFile& file, const std::string& group, const CsvLayout& asked, RowSink& sink)
    : file_(file),
      path_(file.path()),
      source_(file),
      asked_(layout_of(source_, group, asked, notice_)),
      input_(source_, group, wanted_of(asked_, path_), time_of(asked_)),
      layout_(completed(asked_, input_.header(), path_)),
      time_(place_of_time(input_.header(), layout_, path_)),
      time_range_(measurable_in_file(layout_.time.value_or(CsvTime{}))),
      time_from_(input_.header().time_from),
      stamps_(time_from_ ? TimeStamps(*time_from_, unit_s()) : TimeStamps()),
      sink_(sink) {
  const Hdf5Header& header = input_.header();
  for (const std::string& comment : header.comments) notes_.comments += one_line(comment) + '\n';
  for (const std::string& notice : header.notices) notes_.notices.push_back(path_ + ": " + notice);
  if (!notice_.empty()) notes_.notices.push_back(notice_);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < header.names.size(); ++i) {
    if (i == time_) continue;
    const CsvColumn column =
        picks(layout_) ? layout_.columns[i - 1] : CsvColumn{header.names[i], header.names[i], ""};
    columns_.push_back({header.names[i], measurable_in_file(column), is_rate_column(column.name)});
    names.push_back(column.name);
  }
  impossible_.resize(columns_.size());
  checks_.emplace(path_, layout_, columns_, sink_, notes_);
  sink_.begin(names);
}

RowNotes Hdf5Rows::read() {
  const std::uint64_t rows_of_all = input_.header().rows;
  const ExactSteps steps = time_from_ ? ExactSteps(0, unit_s()) : ExactSteps();
  std::vector<std::vector<double>> block;
  while (input_.next(block)) {
    RowBlock rows;
    rows.origin = stamps_.origin();
    rows.time_s = std::move(block[time_]);
    take_time(rows.time_s);
    for (std::size_t i = 0, c = 0; i < block.size(); ++i) {
      if (i == time_) continue;
      take_out_impossible(c++, block[i]);
      rows.columns.push_back(std::move(block[i]));
    }
    checks_->take(rows, steps);
    file_.told(checks_->rows(), rows_of_all);
  }
  checks_->finish(impossible_, !input_.header().units[time_].empty(), steps);
  return std::move(notes_);
}

std::string Hdf5Rows::said(double time) const {
  std::int64_t whole = 0;
  if (time_from_ && std::abs(time) < 9e18 && !__builtin_add_overflow(*time_from_, std::llround(time), &whole))
    return std::to_string(whole);
  return shortest(time_from_ ? static_cast<double>(*time_from_) + time : time);
}

// What comes are differences where the time is in integers.
void Hdf5Rows::take_time(std::vector<double>& time) {
  const std::string& name = input_.header().names[time_];
  const auto from = static_cast<double>(time_from_.value_or(0));
  for (std::size_t row = 0; row < time.size(); ++row) {
    if (time_range_.holds(from + time[row])) continue;
    const std::string where = said(time[row]) + in_row(checks_->rows() + row);
    refuse(path_, std::isnan(time[row]) ? printable(name) + " is " + where + ", expected a time"
                                        : what_no_sensor_measures(name, where, time_range_));
  }
  if (time_from_)
    for (double& each : time) each += stamps_.since(from);
}

void Hdf5Rows::take_out_impossible(std::size_t column, std::vector<double>& values) {
  const FileColumn& from = columns_[column];
  ImpossibleValues& found = impossible_[column];
  for (std::size_t row = 0; row < values.size(); ++row) {
    double& value = values[row];
    if (std::isnan(value) || from.range.holds(value)) continue;
    if (std::isinf(value))
      refuse(path_, printable(from.name) + " is infinite" + in_row(checks_->rows() + row) +
                        ", expected a finite number or nan");
    if (found.count++ == 0) found = {1, checks_->rows() + row, 0, shortest(value)};
    value = kMissing;
  }
}

}  // namespace

RowNotes read_hdf5_rows(InputFile& file, const std::string& group, const CsvLayout& layout, RowSink& sink) {
  return Hdf5Rows(file, group, layout, sink).read();
}

}  // namespace ifog
