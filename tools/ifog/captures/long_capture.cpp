// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/long_capture.h"

#include <utility>

#include "drivers/capture/csv/text_cells.h"
#include "tools/ifog/captures/model_axes.h"

namespace ifog::tools {
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

LongCapture::LongCapture(LongTable table, const std::string& path) : table_(std::move(table)) {
  const CaptureShape shape = capture_shape(table_.header, path, table_);
  view_.comments = lines_of(table_.comments);
  view_.faults = table_.faults;
  view_.since_power_up_s = table_.since_power_up_s;
  view_.origin = table_.origin;
  view_.time_s = table_.time_s;
  view_.axes = shape.axes;
  view_.dead_axes = table_.dead_axes;
  view_.rate_radps.resize(shape.axes.size());
  view_.reference_rate_radps.resize(shape.axes.size());
  using Kind = CaptureShape::Place::Kind;
  for (std::size_t h = 0, c = 0; h < table_.header.size() && c < table_.columns.size(); ++h) {
    LongColumn& column = table_.columns[c];
    if (column.name != table_.header[h]) continue;  // not read
    ++c;
    const CaptureShape::Place& place = shape.places[h];
    if (place.kind == Kind::rate)
      view_.rate_radps[place.at] = column.values;
    else if (place.kind == Kind::reference)
      view_.reference_rate_radps[place.at] = column.values;
    else
      view_.channels.push_back({column.name, column.values});
  }
}

void LongCapture::cut(const TimePart& part, const std::string& name) { view_ = this->part(part, name); }

CaptureView LongCapture::part(const TimePart& part, const std::string& name) const {
  CaptureView out = view_;
  const TimePart::Rows rows = part.rows(view_.time_s, view_.origin, name);
  const auto keep = [&](std::span<const double>& values) {
    if (!values.empty()) values = rows.of(values);
  };
  if (out.since_power_up_s && rows.begin < view_.size())
    *out.since_power_up_s += view_.time_s[rows.begin] - view_.time_s.front();
  keep(out.time_s);
  for (std::span<const double>& rate : out.rate_radps) keep(rate);
  for (std::span<const double>& reference : out.reference_rate_radps) keep(reference);
  for (CaptureView::Channel& channel : out.channels) keep(channel.values);
  return out;
}

void LongCapture::correct(const Model& model) {
  corrected_ = compensated_rates(view_, model);
  view_.rate_radps.assign(corrected_.begin(), corrected_.end());
}

}  // namespace ifog::tools
