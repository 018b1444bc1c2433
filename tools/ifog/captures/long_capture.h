// SPDX-License-Identifier: Apache-2.0
// A capture of any length, read once in blocks, its parts by time, and its rates corrected by a model. Long
// columns are mapped from files.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/capture/times/time_stamps.h"
#include "filters/model_file/model.h"
#include "filters/model_file/model_axes.h"
#include "filters/series/samples.h"
#include "tools/ifog/captures/table/long_table.h"
#include "tools/ifog/console/command.h"

namespace ifog::tools {

// --from and --to: a part of a capture by its own time.
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

// The table must outlive the view. path: for messages. Throws std::runtime_error with one line: no rate, or a
// reference without its rate.
[[nodiscard]] CaptureView view_of(const LongTable& table, const std::string& path);

// The rows of a view.
[[nodiscard]] CaptureView rows_of(CaptureView view, const TimePart::Rows& rows);

class LongCapture {
 public:
  // Throws as view_of().
  LongCapture(LongTable table, const std::string& path)
      : table_(std::move(table)), view_(view_of(table_, path)) {}

  [[nodiscard]] const CaptureView& view() const { return view_; }

 private:
  LongTable table_;
  CaptureView view_;  // of table_
};

// Warns on standard error if effects without an axis, from a sensor with one axis, apply to each of several.
// path: of the model.
void tell_model_of_one_axis(const Model& model, const std::string& path,
                            const std::vector<std::string>& axes);

// The model without the effects of dropped axes and those that depend on their rates; prints the latter. The
// rest is unchanged.
[[nodiscard]] Model without_axes(Model model, const std::vector<std::string>& axes);

// Rates minus the model's effects, by axis, with the code that the daemon uses. Throws std::runtime_error
// with one line if the capture lacks a channel. Without CaptureView::since_power_up_s a warm-up is not
// corrected.
[[nodiscard]] std::vector<Samples> compensated_rates(const CaptureView& capture, const Model& model);

}  // namespace ifog::tools
