// SPDX-License-Identifier: Apache-2.0
// --from and --to: a part of a capture by its own time.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>

#include "drivers/capture/times/time_stamps.h"
#include "tools/ifog/console/options/command.h"

namespace ifog::tools {

struct TimePart {
  struct Bound : SaidTime {
    std::string text;  // as given; "" if not given
  };
  Bound from{{-std::numeric_limits<double>::infinity(), 0.0}, ""};
  Bound to{{std::numeric_limits<double>::infinity(), 0.0}, ""};  // exclusive

  // Adds the two options to a command; this must outlive it.
  void add_to(const Command& command, const std::string& of_from = "Drop what is before this time, s",
              const std::string& of_to = "Drop what is from this time on, s");

  struct Rows {
    std::size_t begin, end;
    [[nodiscard]] std::span<const double> of(std::span<const double> column) const {
      return column.subspan(begin, end - begin);
    }
  };
  // The rows inside. origin: of the times; name: for messages. Throws std::runtime_error with one line if
  // there are none.
  [[nodiscard]] Rows rows(std::span<const double> time_s, const TimeOrigin& origin,
                          const std::string& name) const;
  // Throws the same error for times that were not kept.
  [[noreturn]] void refuse_empty(double first_s, double last_s, const std::string& name) const;
};

}  // namespace ifog::tools
