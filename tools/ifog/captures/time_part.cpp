// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/time_part.h"

#include <optional>
#include <span>

#include "drivers/ifog/quoted.h"
#include "filters/units/told_time.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/options/command.h"

namespace ifog::tools {
namespace {

// Index of the first row from `begin` on that is not before `wanted`.
std::size_t first_from(std::span<const double> time_s, const TimeOrigin& origin, std::size_t begin,
                       const SaidTime& wanted) {
  std::size_t end = time_s.size();
  while (begin < end) {
    const std::size_t middle = begin + (end - begin) / 2;
    if (wanted.is_after(origin, time_s[middle]))
      begin = middle + 1;
    else
      end = middle;
  }
  return begin;
}

}  // namespace

void TimePart::add_to(const Command& command, const std::string& of_from, const std::string& of_to) {
  const auto add = [&command](const char* name, Bound& bound, const std::string& help) {
    const auto take = [name, &bound](const std::string& text) {
      const std::optional<SaidTime> said = SaidTime::parse(text);
      if (!said)
        throw WrongUsage(
            name, "is " + in_quotes(text) + ", expected a number of seconds or a date, 2026-05-01T12:00:00Z");
      static_cast<SaidTime&>(bound) = *said;
      bound.text = text;
    };
    command.add_taken<std::string>(name, take, help, {.type = "TIME"});
  };
  add("--from", from, of_from);
  add("--to", to, of_to);
}

TimePart::Rows TimePart::rows(std::span<const double> time_s, const TimeOrigin& origin,
                              const std::string& name) const {
  const std::size_t begin = first_from(time_s, origin, 0, from);
  const std::size_t end = first_from(time_s, origin, begin, to);
  if (begin == end && !time_s.empty())
    refuse_empty(origin.in_s(time_s.front()), origin.in_s(time_s.back()), name);
  return {begin, end};
}

void TimePart::refuse_empty(double first_s, double last_s, const std::string& name) const {
  throw refusal("{}: nothing between --from{} and --to{}, expected times within {} … {} s", name,
                from.text.empty() ? "" : " " + from.text, to.text.empty() ? "" : " " + to.text,
                told_time(first_s), told_time(last_s));
}

}  // namespace ifog::tools
