// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/denoised_rows.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/usable_axes.h"

namespace ifog::tools {

DenoisedRows::DenoisedRows(std::string output, TimePart part, bool keep, bool smooth)
    : output_(std::move(output)), part_(std::move(part)), keep_(keep || smooth), smooth_(smooth) {}

void DenoisedRows::begin(const std::vector<std::string>& axes, const OfflineSettings& settings) {
  if (settings.model) {
    tell_model_of_one_axis(*settings.model, settings.sensor.model, axes);
    model_trial_.begin(*settings.model, axes);
  }
  moments_.resize(axes.size());
  columns_.axes.resize(axes.size());
  std::vector<std::string> names{"time_s"};
  for (const std::string& axis : axes) {
    for (const char* const name : {"raw", "compensated", "denoised"})
      names.push_back(of_axis(name, axis) + "_radps");
    names.push_back(of_axis("variance", axis) + "_rad2ps2");
    if (!smooth_) continue;
    names.push_back(of_axis("smoothed", axis) + "_radps");
    names.push_back(of_axis("smoothed_variance", axis) + "_rad2ps2");
  }
  file_.emplace(output_, "", names);
}

std::vector<Samples*> DenoisedRows::written_columns() {
  std::vector<Samples*> out{&columns_.time_s};
  for (DenoisedAxis& axis : columns_.axes) {
    out.insert(out.end(), {&axis.raw, &axis.compensated, &axis.denoised, &axis.variance});
    if (smooth_) out.insert(out.end(), {&axis.smoothed, &axis.smoothed_variance});
  }
  return out;
}

void DenoisedRows::write() {
  std::vector<std::span<const double>> columns;
  for (const Samples* const column : written_columns()) columns.emplace_back(*column);
  file_->rows(columns, origin_);
}

void DenoisedRows::count(const ChainOutput& out) {
  if ((out.estimate.flags & kGated) != 0) ++counts_.gated;
  if ((out.compensator_flags & (kStaleChannel | kNoChannelYet)) != 0) ++counts_.stale;
  if ((out.compensator_flags & kOutOfRange) != 0) ++counts_.out_of_range;
  if ((out.compensator_flags & kRampUnknown) != 0) ++counts_.ramp_unknown;
  if ((out.flags & kNoiseUnknown) != 0) ++counts_.unknown_noise;
}

bool DenoisedRows::add(double time_s, const Increment& increment, const ChainOutput& out) {
  const double shown_s = origin_.in_s(time_s);
  if (extent_.rows++ == 0) extent_.first_s = shown_s;
  extent_.last_s = shown_s;
  const bool begun = !part_.from.is_after(origin_, time_s);
  extent_.over = extent_.over || (begun && !part_.to.is_after(origin_, time_s));
  const bool inside = begun && !extent_.over;
  if (inside) {
    ++extent_.written;
    count(out);
    model_trial_.add(time_s, increment.rate_radps, out.compensated_radps);
    reference_trial_.add(time_s, increment.rate_radps, out.compensated_radps);
  } else if (!smooth_) {  // which uses all rows
    return false;
  }
  if (!begun) ++extent_.kept_before;
  columns_.time_s.push_back(time_s);
  if (smooth_) columns_.dt_s.push_back(increment.dt_s);
  for (std::size_t a = 0; a < columns_.axes.size(); ++a) {
    const double raw = increment.rate_radps[a], compensated = out.compensated_radps[a],
                 denoised = out.estimate.denoised_radps[a];
    DenoisedAxis& axis = columns_.axes[a];
    axis.raw.push_back(raw);
    axis.compensated.push_back(compensated);
    axis.denoised.push_back(denoised);
    axis.variance.push_back(out.estimate.variance_rad2ps2[a]);
    if (!inside) continue;
    AxisMoments& of_axis = moments_[a];
    if (!std::isfinite(raw) && of_axis.missing++ == 0) of_axis.first_missing_s = shown_s;
    if ((increment.stuck_axes >> a & 1U) != 0) ++of_axis.stuck;
    of_axis.raw.add(raw);
    of_axis.compensated.add(compensated);
    of_axis.denoised.add(denoised);
  }
  if (!keep_ && columns_.time_s.size() == RowBatch::kRows) {
    write();
    for (Samples* const column : written_columns()) column->keep(0, 0);
  }
  return inside;
}

void DenoisedRows::finish(const std::string& name) {
  if (extent_.written == 0 && extent_.rows > 0) part_.refuse_empty(extent_.first_s, extent_.last_s, name);
  if (extent_.written > 0 &&
      std::ranges::all_of(moments_, [&](const AxisMoments& axis) { return axis.missing == extent_.written; }))
    refuse_without_rates(name, extent_.written);
  if (smooth_)
    for (Samples* const column : written_columns())
      column->keep(extent_.kept_before, extent_.kept_before + extent_.written);
  write();
  file_->finish();
}

}  // namespace ifog::tools
