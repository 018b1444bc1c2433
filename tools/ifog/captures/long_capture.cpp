// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/long_capture.h"

#include "drivers/capture/csv/text_cells.h"
#include "tools/ifog/captures/model_axes.h"

namespace ifog::tools {

CaptureView view_of(const LongTable& table, const std::string& path) {
  const CaptureShape shape = capture_shape(table.header, path, table);
  CaptureView view;
  view.comments = lines_of(table.comments);
  view.faults = table.faults;
  view.since_power_up_s = table.since_power_up_s;
  view.origin = table.origin;
  view.time_s = table.time_s;
  view.axes = shape.axes;
  view.dead_axes = table.dead_axes;
  view.rate_radps.resize(shape.axes.size());
  view.reference_rate_radps.resize(shape.axes.size());
  using Kind = CaptureShape::Place::Kind;
  for (std::size_t h = 0, c = 0; h < table.header.size() && c < table.columns.size(); ++h) {
    const LongColumn& column = table.columns[c];
    if (column.name != table.header[h]) continue;  // not read
    ++c;
    const CaptureShape::Place& place = shape.places[h];
    if (place.kind == Kind::rate)
      view.rate_radps[place.at] = column.values;
    else if (place.kind == Kind::reference)
      view.reference_rate_radps[place.at] = column.values;
    else
      view.channels.push_back({column.name, column.values});
  }
  return view;
}

CaptureView rows_of(CaptureView view, const TimePart::Rows& rows) {
  const auto keep = [&](std::span<const double>& values) {
    if (!values.empty()) values = rows.of(values);
  };
  if (view.since_power_up_s && rows.begin < view.size())
    *view.since_power_up_s += view.time_s[rows.begin] - view.time_s.front();
  keep(view.time_s);
  for (std::span<const double>& rate : view.rate_radps) keep(rate);
  for (std::span<const double>& reference : view.reference_rate_radps) keep(reference);
  for (CaptureView::Channel& channel : view.channels) keep(channel.values);
  return view;
}

void LongCapture::cut(const TimePart& part, const std::string& name) { view_ = this->part(part, name); }

CaptureView LongCapture::part(const TimePart& part, const std::string& name) const {
  return rows_of(view_, part.rows(view_.time_s, view_.origin, name));
}

void LongCapture::correct(const Model& model) {
  corrected_ = compensated_rates(view_, model);
  view_.rate_radps.assign(corrected_.begin(), corrected_.end());
}

}  // namespace ifog::tools
