// SPDX-License-Identifier: Apache-2.0
// ifog denoise: the daemon's signal chain over a capture or a recording.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/sensor/sensor_parts.h"
#include "daemon/state/state_folder.h"
#include "drivers/capture/capture_builder.h"
#include "drivers/capture/files/file_kind.h"
#include "drivers/capture/recording.h"
#include "drivers/ifog/quoted.h"
#include "drivers/row_times/sample_clock.h"
#include "filters/model_file/kept_noise.h"
#include "filters/series/samples.h"
#include "filters/settings/filter_table.h"
#include "filters/smoother/smoother.h"
#include "filters/units/told_time.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/capture_output.h"
#include "tools/ifog/captures/flight/flight_input.h"
#include "tools/ifog/captures/lcm/lcm_events.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/usable_axes.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/filter_options.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/denoise/denoise.h"
#include "tools/ifog/denoise/denoised_rows.h"
#include "tools/ifog/denoise/offline_chain.h"
#include "tools/ifog/field/field.h"
#include "tools/report/picture.h"

namespace ifog::tools {
namespace {

// The sensor of --config.
struct ConfiguredSensor {
  SensorConfig sensor;
  std::vector<std::string> plugin_folders;
};

const SensorConfig& chosen(const Config& config, const DenoiseOptions& options) {
  const auto found = std::ranges::find_if(config.sensors, [&](const SensorConfig& sensor) {
    return options.sensor.empty() ? config.sensors.size() == 1 : sensor.name == options.sensor;
  });
  if (found != config.sensors.end()) return *found;
  throw refusal("{}: {}", options.config,
                options.sensor.empty() ? "has several sensors; expected --sensor NAME"
                                       : "has no sensor \"" + printable(options.sensor) + "\"");
}

void take_driver(const ConfiguredSensor& from, CaptureInput& input) {
  const SensorConfig& sensor = from.sensor;
  if (input.has_driver() && input.driver_name() != sensor.driver) return;
  input.driver = sensor.driver;
  const std::shared_ptr<const Plugin> plugin =
      find_plugin(sensor.driver, plugin_folders(from.plugin_folders));
  const DriverSettings said = input.settings();
  for (const auto& [key, value] : with_files_in(sensor.folder, plugin->table(), sensor.options))
    if (!said.contains(key)) input.options.push_back(key + "=" + value);
}

// Selects the sensor of --config and registers its files as inputs of the run (command_files.h). If the
// capture needs a driver and none is given, `options` gets the sensor's driver, with its options after those
// of the command line. Relative paths start at the folder of the configuration or the working folder. Throws
// std::runtime_error or ConfigError.
std::optional<ConfiguredSensor> configured_sensor(DenoiseOptions& options, FileKind kind) {
  if (options.config.empty()) return std::nullopt;
  Config config = read_config(options.config);
  // systemd gives the service its state folder; on a terminal there may be none.
  if (std::error_code none; state_folder(config.state_folder).empty() &&
                            std::filesystem::equivalent(options.config, kServiceConfig, none))
    use_adopted_models(config, kServiceState);
  will_read_files_of(config);
  ConfiguredSensor out{chosen(config, options), config.plugin_folders};
  if (kind == FileKind::bytes || kind == FileKind::candump || kind == FileKind::flight)
    take_driver(out, options.input);
  return out;
}

// flight: null for other captures; its settings are those of the present file. The command line overrides the
// configuration, and that the recording.
OfflineSettings settings_of(const DenoiseOptions& options, const std::optional<ConfiguredSensor>& configured,
                            const FlightInput* flight) {
  OfflineSettings out;
  if (configured)
    out.sensor = configured->sensor;
  else if (flight != nullptr)
    out.sensor = flight->sensor();
  const bool as_recorded = flight != nullptr && !configured;
  out.sensor.filter = over(options.filter, std::move(out.sensor.filter));
  if (!options.model.empty()) out.sensor.model_adopted = false, out.sensor.model = options.model;
  if (options.nominal_rate_hz > 0.0) out.sensor.nominal_rate_hz = options.nominal_rate_hz;
  if (options.start_up_s > 0.0) out.sensor.start_up_s = options.start_up_s;
  out.model =
      as_recorded && options.model.empty() ? flight->model(out.sensor) : read_sensor_model(out.sensor);
  out.first_sequence = options.first_sequence;
  out.since_power_up_s = options.since_power_up_s;
  if (!options.noise.empty())
    out.learned = read_kept_noise(options.noise).noise;
  else if (as_recorded)
    out.learned = flight->noise(out.sensor);
  return out;
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
void tell_other_rate(const DenoiseOptions& options, double rate_hz, std::span<const double> time_s) {
  constexpr double kAlike = 0.2;
  if (!(rate_hz > 0.0) || time_s.size() < 2) return;
  const double own_hz = 1.0 / sample_clock(time_s).period_s;
  if (std::abs(rate_hz / own_hz - 1.0) > kAlike)
    warn("{}: {} is {:g} Hz, the capture's own times say {:.6g} Hz\n", options.capture,
         options.nominal_rate_hz > 0.0 ? "--rate" : "the configuration's rate", rate_hz, own_hz);
}

template <class Settings>
OfflineResult denoise_table(const DenoiseOptions& options, InputFile& capture, const Settings& settings,
                            DenoisedRows& rows) {
  LongTable table = options.input.read_long(capture);
  table.clean_and_tell(leave_out_full_scale, options.capture);
  leave_out_dead_axes(table, options.capture);
  const CaptureView view = view_of(table, options.capture);
  rows.count_from(view.origin);
  OfflineSettings of = settings();
  tell_other_rate(options, of.sensor.nominal_rate_hz, view.time_s);
  const std::string model = of.model ? of.model->identity() : "";
  if (of.model && !view.dead_axes.empty())
    of.model = std::make_shared<const Model>(without_axes(*of.model, view.dead_axes));
  if (of.model) rows.follow(view);
  OfflineResult result = denoise_capture(view, options.capture, of, rows);
  rows.reference_trial().tell(options.capture);
  result.model = model;  // of the whole file, including effects of axes that are missing here
  return result;
}

void run_denoise(DenoiseOptions options) {
  if (!options.sensor.empty() && options.config.empty())
    throw WrongUsage("--sensor", "is " + in_quotes(options.sensor) +
                                     ", expected --config with it, whose sensors have names");
  InputFile capture(options.capture);
  const FileKind kind = options.input.kind(capture);
  std::optional<FlightInput> flight;
  if (kind == FileKind::flight && !recorded_messages(capture)) flight.emplace(capture);
  const std::optional<ConfiguredSensor> configured = configured_sensor(options, kind);
  expect_capture_name("--output", options.output, nullptr);
  const auto settings = [&] { return settings_of(options, configured, flight ? &*flight : nullptr); };
  // Filters the whole capture and writes the part, so that its bits are those of the whole.
  DenoisedRows rows(options.output, options.part, !options.picture.empty(), options.smooth);
  OfflineResult result;
  const ReadingProgress progress(capture, "denoising");
  const std::vector<std::string> folders =
      configured ? configured->plugin_folders : std::vector<std::string>{};
  if (flight) {
    DriverInstance driver =
        flight->make_driver(options.input.driver_name(), options.input.settings(), folders);
    result = denoise_flight(*flight, driver, settings, !options.config.empty(), rows);
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
    // Of unknown rate, its samples have the times of their arrivals, as every command reads them.
    const bool known = options.nominal_rate_hz > 0.0 || driver.description().nominal_rate_hz > 0.0 ||
                       (configured && configured->sensor.nominal_rate_hz > 0.0);
    result = known ? denoise_recording(options.input, capture, driver, settings(), rows)
                   : denoise_table(options, capture, settings, rows);
  } else {
    result = denoise_table(options, capture, settings, rows);
  }
  if (options.smooth) smooth(rows.columns(), result);
  rows.finish(options.capture);
  if (result.exchanges == 0) rows.model_trial().weigh();  // otherwise there were several models
  tell_denoised(options, rows, result);
  write_json(options.json, denoise_json(options, rows, result));
  if (!options.picture.empty()) draw_denoised(options.picture, rows, result);
}

}  // namespace

void add_denoise(const Command& program) {
  const Command command = program.add_subcommand(
      "denoise", "Denoise a capture as the daemon would, bit for bit with the same settings");
  auto options = std::make_shared<DenoiseOptions>();
  command.add_option(
      "CAPTURE", options->capture,
      "Capture (.csv, .csv.gz, .h5), flight recording (a file or its folder), raw bytes, candump or LCM "
      "log",
      {.required = true, .file = FileUse::read});
  command.add_option("-o,--output", options->output,
                     "CSV or HDF5 (.h5): time_s, raw, compensated, denoised, variance by axis",
                     {.required = true, .file = FileUse::written});
  options->input.add_to(command);
  add_filter_options(command, options->filter);
  command.add_flag("--smooth", options->smooth,
                   "Add columns smoothed, smoothed_variance: from the whole recording, later samples too");
  command.add_option("--model", options->model, "Model file of the sensor", kReadsFile);
  command.add_option(
      "--noise", options->noise,
      "Noise that the daemon has learned (NAME.noise.toml), where neither settings nor model say",
      kReadsFile);
  command.add_option("--config", options->config,
                     "Take all settings from the daemon's configuration; of a flight recording else those it "
                     "was recorded with",
                     kReadsFile);
  command.add_option("--sensor", options->sensor, "Which sensor of the configuration");
  command.add_option("--rate", options->nominal_rate_hz,
                     "Nominal sample rate, Hz; else the driver's or the capture's", {.range = positive()});
  command.add_option("--start-up", options->start_up_s,
                     "Shortest time to learn the noise in when none is given, s; at least 4096 samples (4)",
                     {.range = positive()});
  command.add_option(
      "--sequence", options->first_sequence,
      "Number of the first sample in the recording that this one is a part of: its random weights",
      {.type = "N"});
  command.add_option(
      "--since-power-up", options->since_power_up_s,
      "Seconds from power-up to the first sample; default: as a recording says it. Where nobody "
      "does, a model's warm_up is not corrected",
      {.type = "S", .range = not_negative()});
  options->part.add_to(command, "Write nothing before this time, s; filter from the beginning",
                       "Write nothing from this time on, s");
  command.add_option("--json", options->json, "Summary as JSON", kWritesJson);
  command.add_option("--plot", options->picture, "Picture, .svg or .png",
                     {.check = report::wrong_picture_name, .file = FileUse::written});
  command.callback([options] { run_denoise(*options); });
}

}  // namespace ifog::tools
