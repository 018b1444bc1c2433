// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/reference_trial.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/units/field_units.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {

void ReferenceTrial::follow(const LongTable& table, OfflineSink& sink) {
  sink.begin = [this, &table, next = std::move(sink.begin)](const std::vector<std::string>& axes) {
    for (const std::string& axis : axes) {
      const std::string name = "reference_rate_" + (axis.empty() ? "" : axis + "_") + "radps";
      const auto found = std::ranges::find(table.columns, name, &LongColumn::name);
      axes_.emplace_back().reference = found == table.columns.end() ? nullptr : &*found;
    }
    next(axes);
  };
  sink.sample = [this, &table, next = std::move(sink.sample)](double time_s, const Increment& increment,
                                                              const ChainOutput& out) {
    const bool inside = next(time_s, increment, out);
    if (inside) add(table, time_s, increment.rate_radps, out.compensated_radps);
    return inside;
  };
}

void ReferenceTrial::add(const LongTable& table, double time_s, const Axes& raw_radps,
                         const Axes& compensated_radps) {
  while (row_ < table.size() && table.time_s[row_] < time_s) ++row_;
  const bool over = std::exchange(second_, std::floor(time_s)) != second_;
  for (std::size_t i = 0; i < axes_.size() && row_ < table.size(); ++i) {
    OfAxis& axis = axes_[i];
    if (axis.reference == nullptr) continue;
    if (over && axis.raw.count() > 0.0) {
      const double raw = std::pow(axis.raw.mean(), 2), compensated = std::pow(axis.compensated.mean(), 2);
      axis.raw_square.add(raw);
      axis.compensated_square.add(compensated);
      axis.growth.add(compensated - raw);
      axis.raw = axis.compensated = {};
    }
    const double reference = axis.reference->values[row_], raw = raw_radps[i] - reference,
                 compensated = compensated_radps[i] - reference;
    if (!std::isfinite(raw + compensated)) continue;
    axis.raw.add(raw);
    axis.compensated.add(compensated);
  }
}

void ReferenceTrial::tell(const std::string& capture) const {
  constexpr double kFewest = 8.0;   // means of 1 s
  constexpr double kMuch = 0.05;    // of the mean square; else the bias changed as it does from day to day
  constexpr double kCertain = 3.0;  // standard errors
  for (const OfAxis& axis : axes_) {
    const double n = axis.growth.count(), least = kCertain * axis.growth.deviation() / std::sqrt(n);
    if (n < kFewest || !(axis.growth.mean() > std::fmax(least, kMuch * axis.raw_square.mean()))) continue;
    warn(
        "{}: 1 s means of the corrected rate are {:.4g} deg/h (RMS) from {}, those of the raw rate {:.4g}: "
        "the "
        "model does not hold here; run ifog diagnose on both captures together\n",
        capture, std::sqrt(axis.compensated_square.mean()) / kDegreePerHour, axis.reference->name,
        std::sqrt(axis.raw_square.mean()) / kDegreePerHour);
  }
}

}  // namespace ifog::tools
