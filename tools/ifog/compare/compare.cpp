// SPDX-License-Identifier: Apache-2.0
// ifog compare: every adaptation rule on one capture, with the same settings.
#include "filters/compare/compare.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "filters/allan/stretches.h"
#include "filters/estimator/walk.h"
#include "filters/model_file/model.h"
#include "filters/rest/rest.h"
#include "filters/rules/rule.h"
#include "filters/settings/filter_table.h"
#include "filters/units/field_units.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/compare/verdict.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/filter_options.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/tune/noise_at_rest.h"
#include "tools/report/picture.h"

namespace ifog::tools {
namespace {

using nlohmann::json;

struct CompareArguments {
  CaptureInput input;
  TimePart part;
  std::string capture, model, json_file, plot_file;
  FilterChoice choice;
};

// Restricts the figures to rest, as `allan` does, but keeps a record with too little rest.
struct Motion {
  Rest rest;
  bool left_out = false;
  std::string words;  // "": at rest throughout
};

Motion motion_of(const CaptureView& capture, double period_s) {
  Motion motion;
  motion.rest = rest_of(capture, period_s);
  motion.words = in_words(motion.rest, period_s, capture.shown_time_s(0));
  if (motion.words.empty()) return motion;
  try {
    require_rest(motion.rest, period_s, capture.shown_time_s(0));
    motion.left_out = motion.rest.resting() > 0;
  } catch (const std::invalid_argument&) {
  }
  motion.words += motion.left_out
                      ? "; std and Allan deviation: at rest alone; RMSE, bias, lag and heading: all samples"
                      : "; too little rest: std and Allan deviation have the motion in them";
  return motion;
}

// Default Q and R: from all axes at rest, in the first kMost rows.
void fill_noise(FilterSettings& settings, const CaptureView& capture, const std::vector<Stretch>& at_rest,
                double period_s) {
  if (settings.process_noise > 0.0 && settings.measurement_noise > 0.0) return;
  constexpr std::size_t kMost = std::size_t{1} << 23U;  // rows
  // Uses the quietest stretch of white noise and random walk; without one, the third differences.
  Walk walk;
  double quietest = 0.0, ratio = kMostRatio;
  const auto take = [&](std::size_t begin, std::size_t end) {
    walk.gap();
    for (std::size_t i = begin; i < end; ++i) {
      Axes rate{};
      std::uint32_t valid = 0;
      for (std::size_t a = 0; a < capture.axes.size(); ++a) {
        rate[a] = capture.rate_radps[a][i];
        if (std::isfinite(rate[a])) valid |= 1U << a;
      }
      const std::optional<Walk::Found> found = walk.take(rate, valid);
      if (!found) continue;
      const double mean = std::accumulate(found->noise.begin(), found->noise.end(), 0.0) /
                          static_cast<double>(capture.axes.size());
      if (mean > 0.0 && (quietest == 0.0 || mean < quietest)) quietest = mean;
      ratio = found->ratio;
    }
  };
  const std::size_t rows = std::min(capture.rate_radps.front().size(), kMost);
  if (at_rest.empty()) take(0, rows);
  for (const Stretch& part : at_rest) take(std::min(part.begin, rows), std::min(part.end, rows));
  if (quietest == 0.0)
    for (const auto& axis : capture.rate_radps)
      quietest += third_difference_noise(axis.first(std::min(axis.size(), kMost))) /
                  static_cast<double>(capture.axes.size());
  if (!(quietest > 0.0 && std::isfinite(quietest)))
    throw std::runtime_error("the record shows no noise; expected --process-noise and --measurement-noise");
  if (settings.measurement_noise <= 0.0) settings.measurement_noise = quietest;
  if (settings.process_noise <= 0.0) settings.process_noise = ratio * settings.measurement_noise / period_s;
}

json row_json(const ComparisonRow& row, const std::string& axis, const FilterSettings& settings) {
  json adev = json::object();
  for (std::size_t i = 0; i < kComparedTaus.size(); ++i)
    adev[fmt::format("{:g}", kComparedTaus[i])] = row.adev_radps[i];
  json out{{"rule", row.rule},
           {"axis", axis},
           {"settings", filter_json(settings)},
           {"rmse_radps", row.rmse_radps},
           {"bias_radps", row.bias_radps},
           {"lag_s", row.lag_s},
           {"std_radps", row.std_radps},
           {"adev_radps", adev}};
  out["settings"]["rule"] = row.rule;
  if (row.rule == "raw") {
    out["settings"] = nullptr;
    return out;
  }
  out["heading_end_rad"] = row.heading_end_rad;
  out["heading_max_rad"] = row.heading_max_rad;
  out["whiteness"] = {{"lag1", row.whiteness_lag1}, {"excess", row.whiteness_excess}};
  out["nis_mean"] = row.nis_mean;
  out["nis_typical"] = row.nis_typical;
  out["share_at_rest"] = row.share_at_rest;
  json steps = json::array();
  for (const StepResponse& step : row.step)
    steps.push_back({{"size_sigma", step.size_sigma}, {"samples_to_90_percent", step.samples}});
  out["step_response"] = steps;
  return out;
}

std::string figure_cell(const std::optional<double>& value, double scale, fmt::format_string<double> format) {
  if (!value || !std::isfinite(*value)) return "-";
  return fmt::format(format, *value * scale);
}

void print_axis(const Comparison& result, int axis, bool reference, const Verdict& verdict) {
  say("{:<10} {:>7} {:>10}", "rule", "above", "std");
  for (const double tau : kComparedTaus) say(" {:>9}", fmt::format("ADEV {:g}s", tau));
  if (reference) say(" {:>10} {:>10} {:>8}", "RMSE", "bias", "lag s");
  say(" {:>11} {:>8} {:>7} {:>7} {:>6} {:>7} {:>7}\n", "heading deg", "max", "at rest", "lag-1", "NIS",
      "20s 90%", "5s 90%");
  std::size_t rule = 0;
  for (const ComparisonRow& row : result.rows) {
    if (row.axis != axis) continue;
    const bool is_rule = row.rule != "raw";
    say("{:<10} {:>7} {:>10}", row.rule, is_rule ? figure_cell(verdict.above[rule++], 100.0, "{:.2g} %") : "",
        figure_cell(row.std_radps, 1.0 / kDegreePerHour, "{:.4g}"));
    for (const auto& value : row.adev_radps)
      say(" {:>9}", figure_cell(value, 1.0 / kDegreePerHour, "{:.4g}"));
    if (reference)
      say(" {:>10} {:>10} {:>8}", figure_cell(row.rmse_radps, 1.0 / kDegreePerHour, "{:.4g}"),
          figure_cell(row.bias_radps, 1.0 / kDegreePerHour, "{:.3g}"), figure_cell(row.lag_s, 1.0, "{:.4f}"));
    if (!is_rule) {
      say("\n");
      continue;
    }
    say(" {:11.2e} {:8.1e} {:7.3f} {:>7} {:>6} {:>7} {:>7}\n", row.heading_end_rad / kDegree,
        row.heading_max_rad / kDegree, row.share_at_rest, figure_cell(row.whiteness_lag1, 1.0, "{:.3f}"),
        figure_cell(row.nis_typical, 1.0, "{:.2f}"), figure_cell(row.step[0].samples, 1.0, "{:.0f}"),
        figure_cell(row.step[1].samples, 1.0, "{:.0f}"));
  }
}

std::vector<Verdict> print_axes(const CaptureView& capture, const Comparison& result, bool moves) {
  std::vector<Verdict> verdicts;
  for (std::size_t a = 0; a < capture.axes.size(); ++a) {
    if (!capture.axes[a].empty()) say("\naxis {}\n", capture.axes[a]);
    Verdict& verdict = verdicts.emplace_back(verdict_of(result, static_cast<int>(a)));
    if (moves && verdict.figure != "rmse_radps")
      verdict.text =
          "not judged: the rule that removes most motion would be best; expected rest, or a reference";
    print_axis(result, static_cast<int>(a), !capture.reference_rate_radps[a].empty(), verdict);
    say("{}\n", verdict.text);
  }
  return verdicts;
}

void write_comparison(const CompareArguments& options, const CaptureView& capture, double period_s,
                      const Motion& motion, const Comparison& result, const FilterSettings& settings,
                      const std::vector<Verdict>& verdicts) {
  json rows = json::array(), raw = json::array(), best = json::array();
  for (const ComparisonRow& row : result.rows)
    (row.rule == "raw" ? raw : rows)
        .push_back(row_json(row, capture.axes[static_cast<std::size_t>(row.axis)], settings));
  // By rule, then by axis.
  for (std::size_t r = 0; r < rows.size(); ++r)
    rows[r]["above_best"] = verdicts[r % verdicts.size()].above[r / verdicts.size()];
  for (std::size_t a = 0; a < verdicts.size(); ++a)
    best.push_back({{"axis", capture.axes[a]},
                    {"figure", verdicts[a].figure},
                    {"best", rows[verdicts[a].best * verdicts.size() + a]["rule"]},
                    {"best_radps", verdicts[a].best_radps},
                    {"raw_radps", verdicts[a].raw_radps},
                    {"text", verdicts[a].text}});
  write_json(options.json_file, json{{"schema", "ifog.compare/1"},
                                     {"capture", options.capture},
                                     {"samples", capture.size()},
                                     {"samples_at_rest", motion.rest.resting()},
                                     {"motion", motion.words},
                                     {"sample_rate_hz", 1.0 / period_s},
                                     {"verdict", best},
                                     {"raw", raw},
                                     {"rows", rows}});
}

void run_compare(const CompareArguments& options) {
  const PreparedCaptures prepared = options.input.prepared(
      {options.capture}, {.part = options.part, .wanted = [](const std::string& column) {
                            return is_rate_column(column) || is_other_rate(column);
                          }});
  const CaptureView& capture = prepared.views.front();
  ComparisonInput in;
  in.time_s = capture.time_s;
  if (capture.size() < 16)
    throw refusal("{}: {} rows, expected at least 16", options.capture, capture.size());
  in.period_s = sample_clock(capture.time_s).period_s;
  const Motion motion = motion_of(capture, in.period_s);
  if (motion.left_out) in.at_rest = motion.rest.at_rest;
  for (std::size_t a = 0; a < capture.axes.size(); ++a) {
    in.rate.emplace_back(capture.rate_radps[a]);
    in.reference.emplace_back(capture.reference_rate_radps[a]);
  }
  FilterSettings base;
  if (!options.model.empty()) base = read_model(options.model).filter.value_or(base);
  ComparisonOptions compare;
  compare.settings = settings_in_force(options.choice, base);
  for (const RuleEntry& entry : rules()) compare.rules.emplace_back(entry.name);
  Progress progress("comparing", compare.rules.size());
  compare.progress = progress.teller();
  compare.keep_denoised = !options.plot_file.empty();
  naming(options.capture, [&] { fill_noise(compare.settings, capture, in.at_rest, in.period_s); });
  const Comparison result = compare_rules(in, compare);

  const FilterSettings& s = compare.settings;
  say("{}: {} samples at {:.6g} Hz; state {}, Q {:.4g} (rad/s)^2/s, R {:.4g} (rad/s)^2, window {}\n",
      options.capture, capture.size(), 1.0 / in.period_s, s.state, s.process_noise, s.measurement_noise,
      s.window);
  if (!motion.words.empty()) say("note: {}\n", motion.words);
  say("above: excess of the verdict's figure over the best rule's; std, ADEV, max: deg/h\n"
      "heading: integral of denoised - compensated; at rest: share of samples outside manoeuvres\n"
      "of their innovations, lag-1: correlation; NIS: squares over their variance, median over a normal "
      "law's\n"
      "20s, 5s: samples to 90 % of a step of 20 and 5 sigma\n");
  const std::vector<Verdict> verdicts =
      print_axes(capture, result, !motion.words.empty() && !motion.left_out);
  write_comparison(options, capture, in.period_s, motion, result, s, verdicts);
  if (!options.plot_file.empty()) {
    draw_comparison(options.plot_file, capture, result, compare.rules, verdicts);
    say("picture: {}\n", options.plot_file);
  }
}

}  // namespace

void add_compare(const Command& program) {
  const Command command =
      program.add_subcommand("compare", "Every adaptation rule on one capture, with the same settings");
  auto options = std::make_shared<CompareArguments>();
  options->input.other_rates = true;
  command.add_option("capture", options->capture, "a capture", {.required = true, .file = FileUse::read});
  command.add_option("--model", options->model, "model file whose [filter] gives the settings", kReadsFile);
  command.add_option("--json", options->json_file, "write the figures as JSON", kWritesJson);
  command.add_option("--plot", options->plot_file, "write a picture, .svg or .png",
                     {.check = report::wrong_picture_name, .file = FileUse::written});
  options->input.add_to(command);
  options->part.add_to(command);
  add_filter_options(command, options->choice, false);
  command.callback([options] { run_compare(*options); });
}

}  // namespace ifog::tools
