// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/time_part.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace ifog::tools {
namespace {

void keep(const TimePart::Rows& rows, std::vector<double>& values) {
  if (values.empty() || (rows.begin == 0 && rows.end == values.size())) return;
  values.erase(values.begin() + static_cast<std::ptrdiff_t>(rows.end), values.end());
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rows.begin));
}

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

// The first of the rows from `begin` on that is not before `wanted`, both rounded as an option is.
std::size_t first_from(const SeriesView& time_s, double origin_s, std::size_t begin, double wanted) {
  std::size_t end = time_s.size();
  while (begin < end) {
    const std::size_t middle = begin + (end - begin) / 2;
    if (origin_s + time_s.at(middle) < wanted)
      begin = middle + 1;
    else
      end = middle;
  }
  return begin;
}

}  // namespace

void TimePart::add_to(CLI::App& command) {
  command.add_option("--from", from_s, "Leave out what is before this time, s");
  command.add_option("--to", to_s, "Leave out what is from this time on, s");
}

TimePart::Rows TimePart::rows(const SeriesView& time_s, std::int64_t origin_s,
                              const std::string& name) const {
  const auto origin = static_cast<double>(origin_s);
  const std::size_t begin = first_from(time_s, origin, 0, from_s);
  const std::size_t end = first_from(time_s, origin, begin, to_s);
  if (begin == end && !time_s.empty())
    refuse_empty(origin + time_s.at(0), origin + time_s.at(time_s.size() - 1), name);
  return {begin, end};
}

void TimePart::refuse_empty(double first_s, double last_s, const std::string& name) const {
  throw std::runtime_error(name + ": nothing between --from" +
                           (std::isfinite(from_s) ? " " + seconds(from_s) : "") + " and --to" +
                           (std::isfinite(to_s) ? " " + seconds(to_s) : "") + ", expected times within " +
                           seconds(first_s) + " … " + seconds(last_s) + " s");
}

std::size_t TimePart::cut(std::vector<double>& time_s, std::int64_t origin_s,
                          std::span<std::vector<double>* const> columns, const std::string& name) const {
  const Rows kept = rows(time_s, origin_s, name);
  keep(kept, time_s);
  for (std::vector<double>* const column : columns) keep(kept, *column);
  return kept.begin;
}

std::size_t TimePart::cut(Capture& capture, const std::string& name) const {
  const Rows kept = rows(capture.time_s, capture.origin_s, name);
  if (capture.since_power_up_s && kept.begin < capture.size())
    *capture.since_power_up_s += capture.time_s[kept.begin] - capture.time_s.front();
  keep(kept, capture.time_s);
  for (std::vector<double>& rate : capture.rate_radps) keep(kept, rate);
  for (std::vector<double>& reference : capture.reference_rate_radps) keep(kept, reference);
  for (CaptureColumn& column : capture.channels) keep(kept, column.values);
  return kept.begin;
}

}  // namespace ifog::tools
