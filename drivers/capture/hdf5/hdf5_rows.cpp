// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/hdf5_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "drivers/capture/chosen_columns.h"
#include "drivers/capture/column_names.h"
#include "drivers/capture/hdf5/hdf5_input.h"
#include "drivers/capture/leaps.h"
#include "drivers/capture/measurable.h"
#include "drivers/ifog/quoted.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

constexpr double kMostImpossible = 0.01;  // of a rate's values, as in a CSV file
constexpr double kMostAngle_rad = 1e9;    // likewise
constexpr const char* kTime = "time_s";

[[noreturn]] void refuse(const std::string& path, const std::string& what) { fail_at(path, 0, what); }

std::string in_row(std::size_t row) { return " in row " + std::to_string(row + 1); }

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

bool is_rate(const std::string& column) {
  std::string axis;
  return axis_of(column, "rate", axis) || axis_of(column, "reference_rate", axis);
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
CsvLayout completed(CsvLayout layout, const Hdf5Header& header) {
  for (std::size_t i = 0; i < layout.columns.size(); ++i) {
    CsvColumn& column = layout.columns[i];
    if (!column.unit.empty()) continue;
    column.unit = header.units[i + 1];
    if (!column.is_angle() && !convert_unit(column.unit, unit_of_name(column.name))) column.unit.clear();
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
                     in_quotes(unit_of_name(name)) + "; to read it as it is: " +
                     (name == kTime ? "--time " + name : "--column " + name + "=" + name) + ":" +
                     printable(unit));
  }
}

// Which of the file's columns is the time; of picked columns the first that was asked for.
std::size_t place_of_time(const Hdf5Header& header, const CsvLayout& layout, const std::string& path) {
  if (picks(layout)) return 0;
  const std::string name = time_of(layout);
  const auto time = std::find(header.names.begin(), header.names.end(), name);
  if (time == header.names.end())
    refuse_header(path, 0, "no dataset " + in_quotes(name) + " in its group", header.names);
  check_names(header, layout, path);
  return static_cast<std::size_t>(time - header.names.begin());
}

Measurable in_file_unit(const Measurable& range, const UnitConversion& by) {
  const double a = (range.least - by.offset) / by.scale, b = (range.most - by.offset) / by.scale;
  return {std::min(a, b), std::max(a, b)};
}

// A column beside the time, and what of it said more than any sensor measures.
struct Column {
  std::string shown;  // its name in the file
  Measurable range;   // in the file's unit
  bool rate = false;
  std::size_t impossible = 0, first_row = 0;
  double first = 0.0;
};

class Hdf5Rows {
 public:
  Hdf5Rows(InputFile& file, const std::string& group, const CsvLayout& asked, RowSink& sink);
  RowNotes read();

 private:
  void take_time(const std::vector<double>& time);
  void take_out_impossible(Column& column, std::vector<double>& values) const;
  void pass_on(RowBlock& rows);
  void finish();
  void tell_impossible();
  void tell_leaps();

  InputFile& file_;
  const std::string path_;
  Hdf5Input input_;
  const CsvLayout layout_;
  const std::size_t time_;
  Measurable time_range_;  // in the file's unit
  std::vector<Column> columns_;
  std::vector<std::size_t> rates_;
  RowSink& sink_;
  RowNotes notes_;
  std::optional<Leaps> leaps_;
  std::optional<RowBlock> all_;  // where angles become rates
  WholeTimes times_;
  std::size_t rows_ = 0;
  double last_ = -std::numeric_limits<double>::infinity();    // time in the file's unit
  double last_s_ = -std::numeric_limits<double>::infinity();  // and in seconds
};

Hdf5Rows::Hdf5Rows(InputFile& file, const std::string& group, const CsvLayout& asked, RowSink& sink)
    : file_(file),
      path_(file.path()),
      input_(file, group, wanted_of(asked, path_)),
      layout_(completed(asked, input_.header())),
      time_(place_of_time(input_.header(), layout_, path_)),
      time_range_(in_file_unit(measurable(kTime), {layout_.time.value_or(CsvTime{}).unit_s, 0.0})),
      sink_(sink) {
  const Hdf5Header& header = input_.header();
  for (const std::string& comment : header.comments) notes_.comments += one_line(comment) + '\n';
  for (const std::string& notice : header.notices) notes_.notices.push_back(path_ + ": " + notice);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < header.names.size(); ++i) {
    if (i == time_) continue;
    const CsvColumn column =
        picks(layout_) ? layout_.columns[i - 1] : CsvColumn{header.names[i], header.names[i], ""};
    const Measurable range =
        column.is_angle() ? Measurable{-kMostAngle_rad, kMostAngle_rad} : measurable(column.name);
    if (is_rate(column.name)) rates_.push_back(names.size());
    columns_.push_back({header.names[i], in_file_unit(range, conversion_of(column)), is_rate(column.name)});
    names.push_back(column.name);
    if (column.is_angle()) all_.emplace();
  }
  leaps_.emplace(rates_, [this](RowBlock& rows) { sink_.take(rows); });
  sink_.begin(names);
}

RowNotes Hdf5Rows::read() {
  std::vector<std::vector<double>> block;
  while (input_.next(block)) {
    RowBlock rows;
    rows.time_s = std::move(block[time_]);
    take_time(rows.time_s);
    for (std::size_t i = 0, c = 0; i < block.size(); ++i) {
      if (i == time_) continue;
      take_out_impossible(columns_[c++], block[i]);
      rows.columns.push_back(std::move(block[i]));
    }
    last_ = rows.time_s.back();
    pass_on(rows);
    file_.told(rows_, input_.header().rows);
  }
  finish();
  return std::move(notes_);
}

void Hdf5Rows::take_time(const std::vector<double>& time) {
  for (std::size_t row = 0; row < time.size(); ++row) {
    const double before = row == 0 ? last_ : time[row - 1];
    const auto wrong = [&](const std::string& expected) {
      refuse(path_, printable(input_.header().names[time_]) + " is " + shortest(time[row]) +
                        in_row(rows_ + row) + ", expected " + expected);
    };
    if (std::isnan(time[row])) wrong("a time");
    if (!time_range_.holds(time[row]))
      wrong(shortest(time_range_.least) + " to " + shortest(time_range_.most));
    if (time[row] <= before) wrong("more than in the row before");
  }
}

void Hdf5Rows::take_out_impossible(Column& column, std::vector<double>& values) const {
  for (std::size_t row = 0; row < values.size(); ++row) {
    double& value = values[row];
    if (std::isnan(value) || column.range.holds(value)) continue;
    if (std::isinf(value))
      refuse(path_, printable(column.shown) + " is infinite" + in_row(rows_ + row) +
                        ", expected a finite number or nan");
    if (column.impossible++ == 0) column.first_row = rows_ + row, column.first = value;
    value = std::numeric_limits<double>::quiet_NaN();
  }
}

void Hdf5Rows::pass_on(RowBlock& rows) {
  if (layout_.chooses()) convert(rows, layout_, notes_, path_, rows_, last_s_);
  last_s_ = rows.time_s.back();
  times_.take(rows.time_s);
  rows_ += rows.size();
  if (!all_) return leaps_->take(rows);
  all_->columns.resize(rows.columns.size());
  all_->time_s.insert(all_->time_s.end(), rows.time_s.begin(), rows.time_s.end());
  for (std::size_t c = 0; c < rows.columns.size(); ++c)
    all_->columns[c].insert(all_->columns[c].end(), rows.columns[c].begin(), rows.columns[c].end());
}

void Hdf5Rows::finish() {
  tell_impossible();
  if (all_) {
    as_rates(*all_, layout_, notes_, path_);
    leaps_->take(*all_);
  }
  leaps_->finish();
  tell_leaps();
  const auto notice = times_.notice(path_);
  if (notice && !layout_.time && input_.header().units[time_].empty()) notes_.notices.push_back(*notice);
}

// A value here and there is a fault of the logger, and is missing; where many are, a rate is not what its
// name says.
void Hdf5Rows::tell_impossible() {
  for (const Column& column : columns_) {
    if (column.impossible == 0) continue;
    const std::string what = printable(column.shown) + " is " + shortest(column.first) +
                             in_row(column.first_row) + ", which no sensor measures, expected " +
                             shortest(column.range.least) + " to " + shortest(column.range.most);
    const auto rows = static_cast<double>(rows_), count = static_cast<double>(column.impossible);
    if (column.rate && (rows_ == 1 || (column.impossible > 1 && count > kMostImpossible * rows)))
      refuse(path_, what + (column.impossible > 1
                                ? "; nor " + std::to_string(column.impossible - 1) + " more of its values"
                                : ""));
    notes_.faults.push_back(path_ + ": " + what + "; " + std::to_string(column.impossible) +
                            (column.impossible == 1 ? " such value" : " such values") + " taken for missing");
  }
}

void Hdf5Rows::tell_leaps() {
  for (std::size_t r = 0; r < rates_.size(); ++r) {
    const Leaps::Found& found = leaps_->found()[r];
    if (found.count == 0) continue;
    notes_.faults.push_back(
        path_ + ": " + printable(columns_[rates_[r]].shown) +
        " says more than half a turn within one sample, from standstill to standstill, first" +
        in_row(found.first_row) + "; " + std::to_string(found.count) +
        (found.count == 1 ? " such value" : " such values") + " taken for missing");
  }
}

}  // namespace

RowNotes read_hdf5_rows(InputFile& file, const std::string& group, const CsvLayout& layout, RowSink& sink) {
  return Hdf5Rows(file, group, layout, sink).read();
}

}  // namespace ifog
