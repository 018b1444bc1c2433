// SPDX-License-Identifier: Apache-2.0
// Table of several records: one line each, in the field's units.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "filters/units/field_units.h"
#include "tools/ifog/allan/allan_record.h"
#include "tools/ifog/console/say.h"
#include "tools/report/text.h"

namespace ifog::tools {
namespace {

std::string record_name(const AllanRecord& record) {
  const std::string file = std::filesystem::path(record.capture).filename().string();
  return record.label().empty() ? file : file + " " + record.label();
}

std::string coefficient_cell(const AllanRecord& record, const NamedCoefficient& named) {
  if (!record.fit) return "unknown";
  const NoiseCoefficient& c = (*record.fit).*named.member;
  if (!c.present) return "< " + report::bound_text(c.upper * named.factor);
  return fmt::format("{:.4g} ± {:.2g}", c.value * named.factor, c.std_error * named.factor);
}

void print_cell(const std::string& text) { say("{:<20}", text); }

}  // namespace

void print_comparison(const std::vector<AllanRecord>& records) {
  std::size_t width = 0;
  for (const AllanRecord& record : records)
    width = std::max(width, report::characters_in(record_name(record)) + 2);
  say("\n{:<{}}", "", width);
  for (const NamedCoefficient& named : named_coefficients())
    print_cell(std::string(named.letter) + " " + named.unit);
  say("lowest deviation °/h\n");
  for (const AllanRecord& record : records) {
    say("{:<{}}", record_name(record), width);
    for (const NamedCoefficient& named : named_coefficients()) print_cell(coefficient_cell(record, named));
    std::size_t lowest = 0;
    for (std::size_t i = 1; i < record.points.size(); ++i)
      if (record.points[i].variance < record.points[lowest].variance) lowest = i;
    say("{:.4g} at {:.4g} s\n", std::sqrt(record.points[lowest].variance) / kDegreePerHour,
        record.tau_s[lowest]);
  }
}

}  // namespace ifog::tools
