// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/long_holes.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "filters/diagnosis/record/record_clock.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr double kLong = 0.25;  // of the time that was recorded
constexpr double kLeastHole_s = 600.0;
constexpr double kLongestStep_s = 1.0;  // beyond, rows are averages of their own
constexpr std::size_t kFewestRows = 64;
constexpr double kFewestShare = 0.01;  // of all rows

std::vector<SampleRange> parts_of(const Record& record, double& longest_s) {
  const std::size_t rows = record.time_s.size();
  std::vector<SampleRange> parts{{0, rows}};
  const double step_s = usual_step_of(record);
  if (step_s > kLongestStep_s) return parts;
  const double least_s = std::max(kLeastHole_s, kLong * step_s * static_cast<double>(rows));
  if (record.time_s.back() - record.time_s.front() < least_s) return parts;
  for (std::size_t i = 1; i < rows; ++i) {
    const double hole_s = record.time_s[i] - record.time_s[i - 1];
    if (hole_s < least_s) continue;
    longest_s = std::max(longest_s, hole_s);
    parts.back().to = i;
    parts.push_back({i, rows});
  }
  return parts;
}

bool long_enough(const SampleRange& part, std::size_t rows) {
  return part.size() >= kFewestRows &&
         static_cast<double>(part.size()) >= kFewestShare * static_cast<double>(rows);
}

std::string in_words(const Record& record, std::size_t parts, std::size_t left_out, double longest_s) {
  std::array<char, 240> text{};
  std::snprintf(
      text.data(), text.size(),
      ": the longest hole is of %.4g s; its %zu parts were taken as captures of their own, each with a "
      "bias of its own",
      longest_s, parts);
  std::string words = record.name + text.data();
  if (left_out > 0)
    words += ", but for " + std::to_string(left_out) + " rows in parts too short to say anything";
  return words;
}

}  // namespace

PartedRecords part_at_long_holes(const std::vector<Record>& records) {
  PartedRecords out;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Record& record = records[r];
    double longest_s = 0.0;
    std::vector<SampleRange> parts = parts_of(record, longest_s);
    const std::size_t rows = record.time_s.size();
    std::size_t left_out = 0;
    for (const SampleRange& part : parts) left_out += long_enough(part, rows) ? 0 : part.size();
    if (parts.size() > 1)
      std::erase_if(parts, [&](const SampleRange& part) { return !long_enough(part, rows); });
    if (longest_s == 0.0 || parts.empty()) {
      out.records.push_back(record);
      out.parts.push_back({r, {0, rows}});
      continue;
    }
    for (const SampleRange& samples : parts) {
      Record part = part_of(record, samples);
      part.name += " (from " + told_time(part.origin.told(part.time_s.front())) + " s)";
      out.records.push_back(std::move(part));
      out.parts.push_back({r, samples});
    }
    out.remarks.push_back(in_words(record, parts.size(), left_out, longest_s));
  }
  return out;
}

PartedRecords not_parted(const std::vector<Record>& records) {
  PartedRecords out{records, {}, {}};
  for (std::size_t r = 0; r < records.size(); ++r) out.parts.push_back({r, {0, records[r].time_s.size()}});
  return out;
}

}  // namespace ifog
