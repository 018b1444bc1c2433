// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "drivers/units/units.h"
#include "filters/estimator/walk.h"
#include "filters/series/samples.h"
#include "filters/settings/filter_table.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"
#include "tools/ifog/captures/usable_axes.h"
#include "tools/ifog/console/filter_options.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/denoise/denoise.h"
#include "tools/ifog/denoise/denoised_rows.h"
#include "tools/report/picture.h"
#include "tools/report/scale.h"
#include "tools/report/text.h"

namespace ifog::tools {
namespace {

bool says_anything(const FilterChoice& choice) {
  const auto& table = filter_table();
  return std::ranges::any_of(table, [&](const FilterSetting& setting) {
    return std::visit([&](const auto& member) { return (choice.*member.choice).has_value(); },
                      setting.member);
  });
}

void tell_unusable(const std::string& name, const DenoisedRows& rows, const OfflineResult& result) {
  for (std::size_t a = 0; a < result.axes.size(); ++a) {
    const DenoisedRows::AxisMoments& axis = rows.moments(a);
    const std::string column = of_axis("rate", result.axes[a]);
    const std::string missing = missing_in_words(column, axis.missing, rows.written(), axis.first_missing_s);
    if (!missing.empty()) warn("{}: {}\n", name, missing);
    if (axis.stuck > 0)
      warn(
          "{}: {} repeats one value in {} of {} rows, stuck, at full scale or finer than its steps: no "
          "measurement "
          "there\n",
          name, column, axis.stuck, rows.written());
  }
  const IncrementerCounts& counts = result.counts;
  for (const std::string& line :
       not_measured_in_words(counts.saturated, counts.implausible, counts.ambiguous))
    warn("{}: {}\n", name, line);
  if (result.model.empty()) return;
  const auto of_model = [&](std::uint64_t samples, const char* what) {
    if (samples != 0) warn("{}: {} samples {}\n", name, samples, what);
  };
  of_model(rows.counts().stale,
           "without a value of a channel that the model wants, or with one too old: corrected with the last "
           "one, or not at all");
  of_model(rows.counts().out_of_range, "with a channel outside the range that the model was fitted on");
  of_model(rows.counts().ramp_unknown, "whose phase on the model's ramp was not known");
}

void tell_axis(const std::string& axis, const DenoisedRows::AxisMoments& moments) {
  const std::string name = axis.empty() ? "" : "axis " + axis + ": ";
  if (std::isnan(moments.raw.mean())) return say("{}no value\n", name);
  say("{}std raw {:.4g}, compensated {:.4g}, denoised {:.4g} deg/h\n", name,
      moments.raw.deviation() / kDegreePerHour, moments.compensated.deviation() / kDegreePerHour,
      moments.denoised.deviation() / kDegreePerHour);
}

// Samples without a row. Rows without a value are reported by axis.
std::string gaps_in_words(const OfflineResult& result) {
  const IncrementerCounts& counts = result.counts;
  const bool one_run = result.runs == 1;
  std::string out = one_run ? "no gap between them" : "no gap within a run";
  if (counts.gaps > 0)
    out = std::to_string(counts.missing) + " more lost in " + std::to_string(counts.gaps) +
          (counts.gaps == 1 ? " gap" : " gaps");
  if (!one_run)
    out += fmt::format(", {:.6g} s between {} runs not recorded", result.between_runs_s, result.runs);
  return out;
}

// Warns if the rows may differ from what the daemon published.
void tell_not_as_published(const DenoiseOptions& options, const DenoisedRows& rows,
                           const OfflineResult& result) {
  if (!options.config.empty()) return;
  if (result.not_as_published_from_s)
    warn(
        "{}: from {} s on, until the filter has settled, this need not be what was published: the "
        "recording lacks something there\n",
        options.capture, told_time(rows.origin().in_s(*result.not_as_published_from_s)));
  if (result.merged > 0)
    warn(
        "{}: {} samples, the first about {} s, were published as one with others (the ring was full): so "
        "many rows more than messages, and until the filter has settled behind each not what was published\n",
        options.capture, result.merged, told_time(rows.origin().in_s(result.merged_from_s.value_or(0.0))));
}

std::vector<double> in_degrees_per_hour(const Samples& rate_radps) {
  return report::scaled({rate_radps.begin(), rate_radps.end()}, 1.0 / kDegreePerHour);
}

}  // namespace

bool DenoiseOptions::overrides_recording() const {
  return says_anything(filter) || !model.empty() || !noise.empty() || nominal_rate_hz > 0.0 ||
         start_up_s > 0.0 || since_power_up_s || first_sequence || input.has_driver() ||
         !input.options.empty();
}

nlohmann::json denoise_json(const DenoiseOptions& options, const DenoisedRows& rows,
                            const OfflineResult& result) {
  nlohmann::json axes = nlohmann::json::array();
  for (std::size_t a = 0; a < result.axes.size(); ++a) {
    const DenoisedRows::AxisMoments& of_axis = rows.moments(a);
    nlohmann::json one{{"axis", result.axes[a]}};
    for (const auto& [name, moments] :
         {std::pair{"raw", &of_axis.raw}, std::pair{"compensated", &of_axis.compensated},
          std::pair{"denoised", &of_axis.denoised}}) {
      one[std::string(name) + "_mean_radps"] = moments->mean();
      one[std::string(name) + "_std_radps"] = moments->deviation();
    }
    one["missing"] = of_axis.missing;
    one["stuck"] = of_axis.stuck;
    axes.push_back(std::move(one));
  }
  rows.model_trial().add_to(axes);
  nlohmann::json filter = filter_json(result.filter);
  filter["from_start_up"] = result.noise_learned && !rows.none_filtered();
  return {{"schema", "ifog.denoise/1"},
          {"capture", options.capture},
          {"samples", rows.written()},
          {"sample_rate_hz", result.sample_rate_hz},
          {"model", result.model},
          {"gaps", result.counts.gaps},
          {"missing", result.counts.missing},
          {"runs", result.runs},
          {"between_runs_s", result.between_runs_s},
          {"merged", result.merged},
          {"invalid", result.counts.invalid},
          {"gated", rows.counts().gated},
          {"stale_channel", rows.counts().stale},
          {"out_of_range", rows.counts().out_of_range},
          {"ramp_phase_unknown", rows.counts().ramp_unknown},
          {"samples_before_noise_known", rows.counts().unknown_noise},
          {"filter", filter},
          {"axes", axes}};
}

void tell_denoised(const DenoiseOptions& options, const DenoisedRows& rows, const OfflineResult& result) {
  for (const std::string& effect : result.left_out) warn("{}: not corrected: {}\n", options.model, effect);
  if (result.refused_clock)
    warn("{}: the device's clock {} by arrivals and number of samples: not used once that was seen\n",
         options.capture, clock_speed(*result.refused_clock, kRightButJumps));
  if (result.counts.mixed > 0)
    warn("{}: {} samples come from two devices, mixed, and are dropped: which of them is wanted?\n",
         options.capture, result.counts.mixed);
  if (rows.none_filtered())
    warn(
        "{}: {}: denoised is the compensated rate; expected a --model of 'ifog tune' at rest, or "
        "--process-noise and --measurement-noise\n",
        options.capture,
        result.noise_known ? "these rows are before the noise is known"
        : static_cast<double>(result.counts.samples) < Walk::kStretch
            ? "4096 samples at rest are needed to learn the noise"
            : "rests of 512 and more samples, 4096 in all, are not white (dither, lines, drift, motion)");
  tell_unusable(options.capture, rows, result);
  tell_not_as_published(options, rows, result);
  say("{}: {} samples at {:g} Hz, {}\n", options.capture, rows.written(), result.sample_rate_hz,
      gaps_in_words(result));
  if (result.runs > 1 || result.exchanges > 0)
    say("{} run(s) of the daemon, model or filter exchanged {} time(s): {}; at the end\n", result.runs,
        result.exchanges,
        !options.config.empty()         ? "each run from its beginning, as configured"
        : options.overrides_recording() ? "each as it was, but for what the command line says"
                                        : "each as it was");
  const FilterSettings& filter = result.filter;
  if (rows.none_filtered())
    say("filter {}, state {}: not run\n", filter.rule, filter.state);
  else
    say("filter {}, state {}, process noise {:.4g} (rad/s)^2/s, measurement noise {:.4g} (rad/s)^2{}\n",
        filter.rule, filter.state, filter.process_noise, filter.measurement_noise,
        result.noise_learned ? " (from the first seconds of the capture)" : "");
  for (std::size_t a = 0; a < result.axes.size(); ++a) tell_axis(result.axes[a], rows.moments(a));
  rows.model_trial().tell(options.capture);
}

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
