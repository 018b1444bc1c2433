// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/time_part.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace ifog::tools {
namespace {

struct Rows {
  std::size_t begin, end;

  void keep(std::vector<double>& values) const {
    if (values.empty() || (begin == 0 && end == values.size())) return;
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(end), values.end());
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(begin));
  }
};

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

Rows rows_in(const TimePart& part, const std::vector<double>& time_s, const std::string& name) {
  const auto begin = std::lower_bound(time_s.begin(), time_s.end(), part.from_s);
  const auto end = std::lower_bound(begin, time_s.end(), part.to_s);
  if (begin == end && !time_s.empty())
    throw std::runtime_error(
        name + ": nothing between --from" + (std::isfinite(part.from_s) ? " " + seconds(part.from_s) : "") +
        " and --to" + (std::isfinite(part.to_s) ? " " + seconds(part.to_s) : "") +
        ", expected times within " + seconds(time_s.front()) + " … " + seconds(time_s.back()) + " s");
  return {static_cast<std::size_t>(begin - time_s.begin()), static_cast<std::size_t>(end - time_s.begin())};
}

}  // namespace

void TimePart::add_to(CLI::App& command) {
  command.add_option("--from", from_s, "Leave out what is before this time, s");
  command.add_option("--to", to_s, "Leave out what is from this time on, s");
}

std::size_t TimePart::cut(Table& table, const std::string& name) const {
  const Rows rows = rows_in(*this, table.time_s, name);
  rows.keep(table.time_s);
  for (CaptureColumn& column : table.columns) rows.keep(column.values);
  return rows.begin;
}

std::size_t TimePart::cut(std::vector<double>& time_s, std::span<std::vector<double>* const> columns,
                          const std::string& name) const {
  const Rows rows = rows_in(*this, time_s, name);
  rows.keep(time_s);
  for (std::vector<double>* const column : columns) rows.keep(*column);
  return rows.begin;
}

std::size_t TimePart::cut(Capture& capture, const std::string& name) const {
  const Rows rows = rows_in(*this, capture.time_s, name);
  if (capture.since_power_up_s && rows.begin < capture.size())
    *capture.since_power_up_s += capture.time_s[rows.begin] - capture.time_s.front();
  rows.keep(capture.time_s);
  for (std::vector<double>& rate : capture.rate_radps) rows.keep(rate);
  for (std::vector<double>& reference : capture.reference_rate_radps) rows.keep(reference);
  for (CaptureColumn& column : capture.channels) rows.keep(column.values);
  return rows.begin;
}

}  // namespace ifog::tools
