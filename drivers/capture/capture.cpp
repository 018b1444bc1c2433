// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/capture.h"

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"

namespace ifog {

CaptureView::CaptureView(const Capture& capture)
    : comments(capture.comments),
      origin(capture.origin),
      time_s(capture.time_s),
      axes(capture.axes),
      dead_axes(capture.dead_axes),
      rate_radps(capture.rate_radps.begin(), capture.rate_radps.end()),
      reference_rate_radps(capture.reference_rate_radps.begin(), capture.reference_rate_radps.end()),
      faults(capture.faults),
      since_power_up_s(capture.since_power_up_s) {
  for (const CaptureColumn& column : capture.channels) channels.push_back({column.name, column.values});
}

CaptureShape capture_shape(const std::vector<std::string>& names, const std::string& path,
                           const RowNotes& notes) {
  CaptureShape shape;
  std::string axis;
  for (const std::string& name : names)
    if (axis_of(name, "rate", axis)) shape.axes.push_back(axis);
  if (shape.axes.empty()) fail_at(path, notes.header_line, no_rate_among(names));
  const auto index_of = [&](const std::string& name) {
    for (std::size_t i = 0; i < shape.axes.size(); ++i)
      if (shape.axes[i] == name) return i;
    fail_at(path, notes.header_line,
            "a reference of axis " + in_quotes(name) + " has no rate column, expected the name of an axis: " +
                of_axis("reference_rate", shape.axes.front()) + "_radps");
  };
  using Kind = CaptureShape::Place::Kind;
  for (const std::string& name : names) {
    if (axis_of(name, "rate", axis))
      shape.places.push_back({Kind::rate, index_of(axis)});
    else if (axis_of(name, "reference_rate", axis))
      shape.places.push_back({Kind::reference, index_of(axis)});
    else
      shape.places.push_back({Kind::channel, shape.channels++});
  }
  return shape;
}

}  // namespace ifog
