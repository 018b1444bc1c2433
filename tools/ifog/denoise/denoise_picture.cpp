// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/denoise_picture.h"

#include <utility>
#include <vector>

#include "filters/series/samples.h"
#include "filters/units/field_units.h"
#include "tools/report/picture.h"
#include "tools/report/text.h"
#include "tools/report/time_axis.h"

namespace ifog::tools {
namespace {

std::vector<double> in_degrees_per_hour(const Samples& rate_radps) {
  return report::scaled({rate_radps.begin(), rate_radps.end()}, 1.0 / kDegreePerHour);
}

}  // namespace

void draw_denoised(const std::string& path, DenoisedRows& denoised, const OfflineResult& result) {
  const DenoisedColumns& columns = denoised.columns();
  const bool filtered = !denoised.none_filtered();
  std::vector<double> time(columns.time_s.begin(), columns.time_s.end());
  for (double& t : time) t = denoised.origin().in_s(t);
  const report::TimeAxis axis_of_time(time.front(), time.back());
  time = axis_of_time(std::move(time));
  std::vector<report::PictureRow> rows;
  const auto row = [&](const std::string& title, const char* noisy, const Samples& values,
                       const DenoisedAxis& axis, bool last) {
    // The same range for raw and compensated, for comparison.
    report::Bounds range;
    for (const double value : axis.raw) range.take(value / kDegreePerHour, false);
    for (const double value : axis.compensated) range.take(value / kDegreePerHour, false);
    report::ChartAxis rate{"rate (°/h)", false, {}, {}};
    if (range.low < range.high) rate.low = range.low, rate.high = range.high;
    report::Chart chart(title, "The rate before and after the filter, over time.", axis_of_time.axis(last),
                        rate);
    chart.line_in_time(report::Role::kRaw, noisy, time, in_degrees_per_hour(values));
    if (filtered)
      chart.line_in_time(report::Role::kAfter, "denoised", time, in_degrees_per_hour(axis.denoised));
    rows.push_back({last ? 320.0 : 270.0, {{std::move(chart)}}});
  };
  const bool corrected = !result.model.empty();
  for (std::size_t a = 0; a < result.axes.size(); ++a) {
    const bool last = a + 1 == result.axes.size();
    const DenoisedAxis& axis = columns.axes[a];
    const std::string name = result.axes[a].empty() ? "" : "axis " + result.axes[a];
    row(name, "raw", axis.raw, axis, last && !corrected);
    if (corrected) row("", "compensated", axis.compensated, axis, last);
  }
  report::write_picture(
      path,
      report::picture_svg(filtered ? "Rate, denoised by " + result.filter.rule : "Rate, not denoised", rows));
}

}  // namespace ifog::tools
