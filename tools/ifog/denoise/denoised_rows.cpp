// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/denoised_rows.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "drivers/capture/times/row_sink.h"
#include "tools/ifog/captures/usable_axes.h"

namespace ifog::tools {

constexpr std::size_t kRowsTogether = std::size_t{1} << 14U;  // rows per write

DenoisedRows::DenoisedRows(std::string output, TimePart part, bool keep, bool smooth)
    : output_(std::move(output)), part_(std::move(part)), keep_(keep || smooth), smooth_(smooth) {}

void DenoisedRows::begin(const std::vector<std::string>& axes) {
  axes_ = axes;
  moments_.resize(axes.size());
  columns_.axes.resize(axes.size());
  std::vector<std::string> names{"time_s"};
  for (const std::string& axis : axes_) {
    const std::string suffix = (axis.empty() ? "" : "_" + axis) + "_";
    for (const char* const name : {"raw", "compensated", "denoised"})
      names.push_back(name + suffix + "radps");
    names.push_back("variance" + suffix + "rad2ps2");
    if (!smooth_) continue;
    names.push_back("smoothed" + suffix + "radps");
    names.push_back("smoothed_variance" + suffix + "rad2ps2");
  }
  pending_.resize(names.size());
  file_.emplace(output_, "", names);
}

void DenoisedRows::append(double value) { pending_[place_++].push_back(value); }

void DenoisedRows::end_row() {
  place_ = 0;
  if (pending_.front().size() >= kRowsTogether) flush();
}

void DenoisedRows::flush() {
  if (pending_.front().empty()) return;
  file_->rows(std::vector<std::span<const double>>(pending_.begin(), pending_.end()), origin_);
  for (std::vector<double>& column : pending_) column.clear();
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
  if (keep_) {
    columns_.time_s.push_back(time_s);
    columns_.dt_s.push_back(increment.dt_s);
  }
  const bool begun = !part_.from.is_after(origin_, time_s);
  extent_.over = extent_.over || (begun && !part_.to.is_after(origin_, time_s));
  const bool inside = begun && !extent_.over;
  if (inside) {
    ++extent_.written;
    count(out);
    if (!smooth_) append(time_s);
  }
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const double raw = increment.rate_radps[a], compensated = out.compensated_radps[a],
                 denoised = out.estimate.denoised_radps[a], variance = out.estimate.variance_rad2ps2[a];
    if (keep_) {
      DenoisedAxis& axis = columns_.axes[a];
      axis.raw.push_back(raw);
      axis.compensated.push_back(compensated);
      axis.denoised.push_back(denoised);
      axis.variance.push_back(variance);
    }
    if (!inside) continue;
    AxisMoments& of_axis = moments_[a];
    if (!std::isfinite(raw) && of_axis.missing++ == 0) of_axis.first_missing_s = shown_s;
    if ((increment.stuck_axes >> a & 1U) != 0) ++of_axis.stuck;
    of_axis.raw.add(raw);
    of_axis.compensated.add(compensated);
    of_axis.denoised.add(denoised);
    if (smooth_) continue;
    for (const double value : {raw, compensated, denoised, variance}) append(value);
  }
  if (inside && !smooth_) end_row();
  return inside;
}

void DenoisedRows::finish(const std::string& name) {
  if (extent_.written == 0 && extent_.rows > 0) part_.refuse_empty(extent_.first_s, extent_.last_s, name);
  if (extent_.written > 0 && std::all_of(moments_.begin(), moments_.end(), [&](const AxisMoments& axis) {
        return axis.missing == extent_.written;
      }))
    refuse_without_rates(name, extent_.written);
  if (keep_) {
    std::vector<Samples*> all{&columns_.dt_s};
    for (DenoisedAxis& axis : columns_.axes)
      all.insert(all.end(), {&axis.raw, &axis.compensated, &axis.denoised, &axis.variance, &axis.smoothed,
                             &axis.smoothed_variance});
    part_.cut(columns_.time_s, origin_, all, name);
  }
  for (std::size_t i = 0; smooth_ && i < columns_.time_s.size(); ++i) {
    append(columns_.time_s[i]);
    for (const DenoisedAxis& axis : columns_.axes)
      for (const auto* const series : {&axis.raw, &axis.compensated, &axis.denoised, &axis.variance,
                                       &axis.smoothed, &axis.smoothed_variance})
        append((*series)[i]);
    end_row();
  }
  flush();
  file_->finish();
}

}  // namespace ifog::tools
