// SPDX-License-Identifier: Apache-2.0
// ifog denoise: the daemon's signal chain over a capture or a recording.
#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "drivers/capture/capture_builder.h"
#include "drivers/capture/files/file_kind.h"
#include "drivers/capture/recording.h"
#include "drivers/ifog/quoted.h"
#include "drivers/units/units.h"
#include "filters/estimator/walk.h"
#include "filters/series/median_step.h"
#include "filters/series/samples.h"
#include "filters/smoother/smoother.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/capture_output.h"
#include "tools/ifog/captures/flight/flight_input.h"
#include "tools/ifog/captures/lcm/lcm_events.h"
#include "tools/ifog/captures/model_axes.h"
#include "tools/ifog/captures/time_part.h"
#include "tools/ifog/captures/usable_axes.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/options/command.h"
#include "tools/ifog/console/options/filter_options.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/denoise/denoise_picture.h"
#include "tools/ifog/denoise/denoise_settings.h"
#include "tools/ifog/denoise/denoised_rows.h"
#include "tools/ifog/denoise/model_trial.h"
#include "tools/ifog/denoise/offline_chain.h"
#include "tools/ifog/denoise/reference_trial.h"
#include "tools/report/picture.h"

namespace ifog::tools {
namespace {

nlohmann::json summary(const DenoiseOptions& options, const DenoisedRows& rows, const ModelTrial& trial,
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
  trial.add_to(axes);
  const FilterSettings& filter = result.filter;
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
          {"filter",
           {{"rule", filter.rule},
            {"state", filter.state},
            {"process_noise", filter.process_noise},
            {"measurement_noise", filter.measurement_noise},
            {"from_start_up", result.noise_learned && !rows.none_filtered()},
            {"window", filter.window},
            {"weights", filter.weights},
            {"draws", filter.draws},
            {"floor", filter.floor},
            {"follow_manoeuvres", filter.follow_manoeuvres},
            {"conserve_angle", filter.conserve_angle},
            {"guard", filter.guard},
            {"steady_gain", filter.steady_gain},
            {"seed", filter.seed}}},
          {"axes", axes}};
}

void tell_unusable(const std::string& name, const DenoisedRows& rows, const OfflineResult& result) {
  for (std::size_t a = 0; a < result.axes.size(); ++a) {
    const DenoisedRows::AxisMoments& axis = rows.moments(a);
    const std::string column = result.axes[a].empty() ? "rate" : "rate_" + result.axes[a];
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

void tell(const DenoiseOptions& options, const DenoisedRows& rows, const OfflineResult& result) {
  for (const std::string& effect : result.left_out) warn("{}: not corrected: {}\n", options.model, effect);
  if (result.refused_clock)
    warn("{}: the device's clock {} by arrivals and number of samples: not used once that was seen\n",
         options.capture, clock_speed(*result.refused_clock));
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
            : "no 4096 samples in a row are white (dither, lines, drift, motion)");
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
}

// Samples that the chain dropped as invalid are not used; the effects of the model are already subtracted.
void smooth(DenoisedColumns& columns, const OfflineResult& result) {
  if (!result.noise_known)
    throw std::runtime_error("--smooth: the noise is not known; expected a --model of 'ifog tune' at rest");
  std::vector<std::span<const double>> rates;
  for (const DenoisedAxis& axis : columns.axes) rates.emplace_back(axis.compensated);
  const AxisNoise noise{result.shares.noise, result.shares.walk, result.learns_walk};
  std::vector<Smoothed> smoothed =
      ifog::smooth(result.filter, noise, rates, columns.dt_s, 1.0 / result.sample_rate_hz);
  for (std::size_t a = 0; a < columns.axes.size(); ++a) {
    columns.axes[a].smoothed = std::move(smoothed[a].rate_radps);
    columns.axes[a].smoothed_variance = std::move(smoothed[a].variance_rad2ps2);
  }
}

// With a wrong --rate, steps of the time column are counted as gaps or jitter.
void tell_other_rate(const DenoiseOptions& options, double rate_hz, const LongTable& table) {
  constexpr double kAlike = 0.2;
  if (!(rate_hz > 0.0) || table.size() < 2) return;
  const double own_hz = 1.0 / median_step(table.time_s);
  if (std::abs(rate_hz / own_hz - 1.0) > kAlike)
    warn("{}: {} is {:g} Hz, the capture's own times say {:.6g} Hz\n", options.capture,
         options.nominal_rate_hz > 0.0 ? "--rate" : "the configuration's rate", rate_hz, own_hz);
}

// Registers inputs and outputs before any of them is used.
void name_files(DenoiseOptions& options) {
  if (!options.sensor.empty() && options.config.empty())
    throw WrongUsage("--sensor", "is " + in_quotes(options.sensor) +
                                     ", expected --config with it, whose sensors have names");
  options.input.will_read("CAPTURE", options.capture);
  will_read("--model", options.model);
  will_read("--noise", options.noise);
  will_read("--config", options.config);
  will_write("--output", options.output);
  will_write("--json", options.json, kJsonEndings);
  will_write("--plot", options.picture);
}

template <class Settings>
OfflineResult denoise_table(const DenoiseOptions& options, InputFile& capture, const Settings& settings,
                            DenoisedRows& rows, OfflineSink sink) {
  LongTable table = options.input.read_long(capture);
  table.clean_and_tell(leave_out_placeholders, options.capture);
  leave_out_dead_axes(table, options.capture);
  rows.count_from(table.origin);
  OfflineSettings of = settings();
  tell_other_rate(options, of.sensor.nominal_rate_hz, table);
  const std::string model = of.model ? of.model->identity() : "";
  if (of.model && !table.dead_axes.empty())
    of.model = std::make_shared<const Model>(without_axes(*of.model, table.dead_axes));
  ReferenceTrial trial;
  if (of.model) trial.follow(table, sink);
  OfflineResult result = denoise_capture(table, options.capture, of, sink);
  trial.tell(options.capture);
  result.model = model;  // of the whole file, including effects of axes that are missing here
  return result;
}

void run_denoise(DenoiseOptions options) {
  name_files(options);
  InputFile capture(options.capture);
  const FileKind kind = options.input.kind(capture);
  std::optional<FlightInput> flight;
  if (kind == FileKind::flight && !recorded_messages(capture)) flight.emplace(capture);
  const std::optional<ConfiguredSensor> configured = configured_sensor(options, kind);
  expect_capture_name("--output", options.output, nullptr);
  const auto settings = [&] { return settings_of(options, configured, flight ? &*flight : nullptr); };
  // Filters the whole capture and writes the part, so that its bits are those of the whole.
  DenoisedRows rows(options.output, options.part, !options.picture.empty(), options.smooth);
  ModelTrial trial;
  const OfflineSink sink{[&](const std::vector<std::string>& axes) {
                           const OfflineSettings of = settings();
                           if (of.model) tell_model_of_one_axis(*of.model, of.sensor.model, axes);
                           if (of.model) trial.begin(*of.model, axes);
                           rows.begin(axes);
                         },
                         [&](const TimeOrigin& origin) { rows.count_from(origin); },
                         [&](double time_s, const Increment& increment, const ChainOutput& out) {
                           const bool inside = rows.add(time_s, increment, out);
                           if (inside) trial.add(time_s, increment.rate_radps, out.compensated_radps);
                           return inside;
                         }};
  OfflineResult result;
  const ReadingProgress progress(capture, "denoising");
  const std::vector<std::string> folders =
      configured ? configured->plugin_folders : std::vector<std::string>{};
  if (flight) {
    DriverInstance driver =
        flight->make_driver(options.input.driver_name(), options.input.settings(), folders);
    result = denoise_flight(*flight, driver, settings, !options.config.empty(), sink);
  } else if (kind == FileKind::bytes || kind == FileKind::candump ||
             (kind == FileKind::lcm_log && options.input.has_driver())) {
    if (!options.input.has_driver()) {
      const std::string foreign = foreign_container(capture.head());
      throw refusal("{}: {}", options.capture,
                    foreign.empty()
                        ? "is no capture in columns, expected --driver NAME, --dbc FILE or --config F"
                        : foreign);
    }
    DriverInstance driver = options.input.make_driver(folders);
    result = denoise_recording(options.input, capture, driver, settings(), sink);
  } else {
    result = denoise_table(options, capture, settings, rows, sink);
  }
  if (options.smooth) smooth(rows.columns(), result);
  rows.finish(options.capture);
  if (result.exchanges == 0) trial.weigh();  // otherwise there were several models
  tell(options, rows, result);
  trial.tell(options.capture);
  if (!options.json.empty()) write_json(options.json, summary(options, rows, trial, result));
  if (!options.picture.empty()) draw_denoised(options.picture, rows, result);
}

}  // namespace

void add_denoise(const Command& program) {
  const Command command = program.add_subcommand(
      "denoise", "Denoise a capture as the daemon would, bit for bit with the same settings");
  auto options = std::make_shared<DenoiseOptions>();
  command
      .add_option(
          "CAPTURE", options->capture,
          "Capture (.csv, .csv.gz, .h5), flight recording (a file or its folder), raw bytes, candump or LCM "
          "log")
      .required();
  command
      .add_option("-o,--output", options->output,
                  "CSV or HDF5 (.h5): time_s, raw, compensated, denoised, variance by axis")
      .required();
  options->input.add_to(command);
  add_filter_options(command, options->filter);
  command.add_flag("--smooth", options->smooth,
                   "Add columns smoothed, smoothed_variance: from the whole recording, later samples too");
  command.add_option("--model", options->model, "Model file of the sensor");
  command.add_option(
      "--noise", options->noise,
      "Noise that the daemon has learned (NAME.noise.toml), where neither settings nor model say");
  command.add_option("--config", options->config,
                     "Take all settings from the daemon's configuration; of a flight recording else those it "
                     "was recorded with");
  command.add_option("--sensor", options->sensor, "Which sensor of the configuration");
  command
      .add_option("--rate", options->nominal_rate_hz,
                  "Nominal sample rate, Hz; else the driver's or the capture's")
      .positive();
  command
      .add_option("--start-up", options->start_up_s,
                  "Shortest time to learn the noise in when none is given, s; at least 4096 samples (4)")
      .positive();
  command
      .add_option(
          "--sequence", options->first_sequence,
          "Number of the first sample in the recording that this one is a part of: its random weights")
      .type_name("N");
  command
      .add_option("--since-power-up", options->since_power_up_s,
                  "Seconds from power-up to the first sample; default: as a recording says it. Where nobody "
                  "does, a model's warm_up is not corrected")
      .not_negative()
      .type_name("S");
  options->part.add_to(command, "Write nothing before this time, s; filter from the beginning",
                       "Write nothing from this time on, s");
  command.add_option("--json", options->json, "Summary as JSON");
  command.add_option("--plot", options->picture, "Picture, .svg or .png").check(report::wrong_picture_name);
  command.callback([options] { run_denoise(*options); });
}

}  // namespace ifog::tools
