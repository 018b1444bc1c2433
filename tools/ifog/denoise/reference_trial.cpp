// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/reference_trial.h"

#include <cmath>
#include <utility>

#include "filters/units/field_units.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {

namespace {
constexpr double kFewest = 8.0;   // means of 1 s
constexpr double kMuch = 0.05;    // of the mean square; else the bias changed as it does from day to day
constexpr double kCertain = 3.0;  // standard errors
}  // namespace

void ReferenceTrial::follow(const LongTable& table, OfflineSink& sink) {
  sink.begin = [this, &table, next = std::move(sink.begin)](const std::vector<std::string>& axes) {
    begin(table, axes);
    next(axes);
  };
  sink.sample = [this, next = std::move(sink.sample)](double time_s, const Increment& increment,
                                                      const ChainOutput& out) {
    const bool inside = next(time_s, increment, out);
    if (inside) add(time_s, increment.rate_radps, out.compensated_radps);
    return inside;
  };
}

void ReferenceTrial::begin(const LongTable& table, const std::vector<std::string>& axes) {
  time_s_ = table.time_s;
  for (const std::string& axis : axes) {
    OfAxis of;
    of.name = axis;
    const std::string name = "reference_rate_" + (axis.empty() ? "" : axis + "_") + "radps";
    for (const auto& column : table.columns)
      if (column.name == name) of.reference = column.values;
    axes_.push_back(std::move(of));
  }
}

void ReferenceTrial::add(double time_s, const Axes& raw_radps, const Axes& compensated_radps) {
  while (row_ < time_s_.size() && time_s_[row_] < time_s) ++row_;
  if (row_ == time_s_.size()) return;
  if (std::floor(time_s) != second_) close_second();
  second_ = std::floor(time_s);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    OfAxis& axis = axes_[i];
    if (axis.reference.empty()) continue;
    const double raw = raw_radps[i] - axis.reference[row_];
    const double compensated = compensated_radps[i] - axis.reference[row_];
    if (!std::isfinite(raw + compensated)) continue;
    axis.raw += raw, axis.compensated += compensated, axis.count += 1.0;
  }
}

void ReferenceTrial::close_second() {
  for (OfAxis& axis : axes_) {
    if (axis.count > 0.0) {
      const double raw = std::pow(axis.raw / axis.count, 2);
      const double compensated = std::pow(axis.compensated / axis.count, 2);
      axis.raw_square.add(raw);
      axis.compensated_square.add(compensated);
      axis.growth.add(compensated - raw);
    }
    axis.raw = axis.compensated = axis.count = 0.0;
  }
}

void ReferenceTrial::tell(const std::string& capture) const {
  for (const OfAxis& axis : axes_) {
    const double n = axis.growth.count();
    if (n < kFewest || axis.growth.mean() * std::sqrt(n) < kCertain * axis.growth.deviation()) continue;
    if (axis.growth.mean() <= kMuch * axis.raw_square.mean()) continue;
    warn(
        "{}: {}1 s means of the corrected rate are {:.4g} deg/h (RMS) from the reference, those of the raw "
        "rate "
        "{:.4g}: the model does not hold here; run ifog diagnose on both captures together\n",
        capture, axis.name.empty() ? "" : "axis " + axis.name + ": ",
        std::sqrt(axis.compensated_square.mean()) / kDegreePerHour,
        std::sqrt(axis.raw_square.mean()) / kDegreePerHour);
  }
}

}  // namespace ifog::tools
