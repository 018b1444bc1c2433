// ifog denoise: the daemon's signal chain over a capture or a recording.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/sensor/sensor_parts.h"
#include "drivers/capture/recording.h"
#include "drivers/capture/text_file.h"
#include "drivers/ifog/quoted.h"
#include "filters/settings/filter_table.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/filter_options.h"
#include "tools/ifog/denoise/offline_chain.h"
#include "tools/ifog/plot.h"

namespace ifog::tools {
namespace {

constexpr double kDegPerHour = 180.0 / 3.14159265358979323846 * 3600.0;

struct Options {
  std::string capture, output, model, config, sensor, json, picture;
  double nominal_rate_hz = 0.0, start_up_s = 0.0;
  CaptureInput input;
  FilterChoice filter;
};

struct Series {
  std::vector<double> raw, compensated, denoised, variance;
};

struct Columns {
  std::vector<double> time_s;
  std::vector<Series> axes;
  std::uint64_t gated = 0, stale = 0, out_of_range = 0, unknown_noise = 0;
};

void append(std::string& text, double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), static_cast<std::size_t>(end - digits.data()));
}

std::string as_text(const Columns& columns, const OfflineResult& result) {
  std::string text = "time_s";
  for (const std::string& axis : result.axes) {
    const std::string suffix = axis.empty() ? "" : "_" + axis;
    text += ",raw" + suffix + "_radps,compensated" + suffix + "_radps,denoised" + suffix + "_radps,variance" +
            suffix + "_rad2ps2";
  }
  text += '\n';
  for (std::size_t i = 0; i < columns.time_s.size(); ++i) {
    append(text, columns.time_s[i]);
    for (const Series& axis : columns.axes)
      for (const auto* const series : {&axis.raw, &axis.compensated, &axis.denoised, &axis.variance}) {
        text += ',';
        append(text, (*series)[i]);
      }
    text += '\n';
  }
  return text;
}

// Mean and standard deviation of what is a number.
std::pair<double, double> moments(const std::vector<double>& values) {
  double n = 0.0, mean = 0.0, square = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    n += 1.0;
    const double difference = value - mean;
    mean += difference / n;
    square += difference * (value - mean);
  }
  return {mean, n > 1.0 ? std::sqrt(square / (n - 1.0)) : 0.0};
}

nlohmann::json summary(const Options& options, const Columns& columns, const OfflineResult& result) {
  nlohmann::json axes = nlohmann::json::array();
  for (std::size_t a = 0; a < result.axes.size(); ++a) {
    const Series& series = columns.axes[a];
    nlohmann::json one{{"axis", result.axes[a]}};
    for (const auto& [name, values] :
         {std::pair{"raw", &series.raw}, std::pair{"compensated", &series.compensated},
          std::pair{"denoised", &series.denoised}}) {
      const auto [mean, deviation] = moments(*values);
      one[std::string(name) + "_mean_radps"] = mean;
      one[std::string(name) + "_std_radps"] = deviation;
    }
    axes.push_back(std::move(one));
  }
  const FilterSettings& filter = result.filter;
  return {{"schema", "ifog.denoise/1"},
          {"capture", options.capture},
          {"samples", columns.time_s.size()},
          {"sample_rate_hz", result.sample_rate_hz},
          {"model", result.model},
          {"gaps", result.counts.gaps},
          {"missing", result.counts.missing},
          {"invalid", result.counts.invalid},
          {"gated", columns.gated},
          {"stale_channel", columns.stale},
          {"out_of_range", columns.out_of_range},
          {"samples_before_noise_known", columns.unknown_noise},
          {"filter",
           {{"rule", filter.rule},
            {"state", filter.state},
            {"process_noise", filter.process_noise},
            {"measurement_noise", filter.measurement_noise},
            {"from_start_up", result.noise_learned},
            {"window", filter.window},
            {"weights", filter.weights},
            {"draws", filter.draws},
            {"floor", filter.floor},
            {"follow_manoeuvres", filter.follow_manoeuvres},
            {"conserve_angle", filter.conserve_angle},
            {"seed", filter.seed}}},
          {"axes", axes}};
}

void draw(const std::string& path, const Columns& columns, const OfflineResult& result) {
  constexpr std::size_t kMostPoints = 4000;
  const std::size_t step = std::max<std::size_t>(1, columns.time_s.size() / kMostPoints);
  std::vector<Panel> panels;
  for (std::size_t a = 0; a < result.axes.size(); ++a) {
    Panel panel;
    panel.title = result.axes[a].empty() ? "Rate" : "Rate, axis " + result.axes[a];
    panel.x_label = "time, s";
    panel.y_label = "°/h";
    const auto curve = [&](const char* title, const std::vector<double>& values, const char* color) {
      Curve out;
      out.title = title;
      out.color = color;
      for (std::size_t i = 0; i < values.size(); i += step) {
        out.x.push_back(columns.time_s[i]);
        out.y.push_back(values[i] * kDegPerHour);
      }
      return out;
    };
    panel.curves.push_back(curve("raw", columns.axes[a].raw, "#b0b0b0"));
    if (!result.model.empty())
      panel.curves.push_back(curve("compensated", columns.axes[a].compensated, "#7fa8d9"));
    panel.curves.push_back(curve("denoised", columns.axes[a].denoised, "#c02020"));
    panels.push_back(std::move(panel));
  }
  plot(path, panels);
}

OfflineSettings settings_of(Options& options) {
  OfflineSettings out;
  if (!options.config.empty()) {
    const Config config = read_config(options.config);
    const auto found =
        std::find_if(config.sensors.begin(), config.sensors.end(), [&](const SensorConfig& sensor) {
          return options.sensor.empty() ? config.sensors.size() == 1 : sensor.name == options.sensor;
        });
    if (found == config.sensors.end())
      throw std::runtime_error(options.config + ": " +
                               (options.sensor.empty()
                                    ? "has several sensors; expected --sensor NAME"
                                    : "has no sensor \"" + printable(options.sensor) + "\""));
    out.sensor = *found;
    if (file_kind(options.capture) != FileKind::capture && !options.input.has_driver()) {
      options.input.driver = out.sensor.driver;
      for (const auto& [key, value] : out.sensor.options) options.input.options.push_back(key + "=" + value);
    }
  }
  // What is said on the command line stands over the configuration.
  out.sensor.filter = over(options.filter, std::move(out.sensor.filter));
  if (!options.model.empty()) out.sensor.model = options.model;
  if (options.nominal_rate_hz > 0.0) out.sensor.nominal_rate_hz = options.nominal_rate_hz;
  if (options.start_up_s > 0.0) out.sensor.start_up_s = options.start_up_s;
  out.model = read_sensor_model(out.sensor);
  return out;
}

void tell(const Options& options, const Columns& columns, const OfflineResult& result) {
  for (const std::string& effect : result.left_out)
    std::fprintf(stderr, "%s: not corrected: %s\n", options.model.c_str(), effect.c_str());
  if (!result.noise_known)
    std::fprintf(
        stderr,
        "%s: shorter than the start-up that would show its noise: denoised is the compensated rate; expected "
        "--process-noise and --measurement-noise, or a shorter --start-up\n",
        options.capture.c_str());
  std::printf("%s: %zu samples at %g Hz, %llu gap(s), %llu missing\n", options.capture.c_str(),
              columns.time_s.size(), result.sample_rate_hz,
              static_cast<unsigned long long>(result.counts.gaps),
              static_cast<unsigned long long>(result.counts.missing));
  std::printf("filter %s, state %s, process noise %.4g (rad/s)^2/s, measurement noise %.4g (rad/s)^2%s\n",
              result.filter.rule.c_str(), result.filter.state.c_str(), result.filter.process_noise,
              result.filter.measurement_noise,
              result.noise_learned ? " (from the first seconds of the capture)" : "");
  for (std::size_t a = 0; a < result.axes.size(); ++a)
    std::printf("%s%sstd raw %.4g, compensated %.4g, denoised %.4g deg/h\n",
                result.axes[a].empty() ? "" : "axis ",
                result.axes[a].empty() ? "" : (result.axes[a] + ": ").c_str(),
                moments(columns.axes[a].raw).second * kDegPerHour,
                moments(columns.axes[a].compensated).second * kDegPerHour,
                moments(columns.axes[a].denoised).second * kDegPerHour);
}

void run(Options options) {
  const OfflineSettings settings = settings_of(options);
  Columns columns;
  columns.axes.resize(kMaxAxes);
  const auto sink = [&](double time_s, const Increment& increment, const ChainOutput& out) {
    columns.time_s.push_back(time_s);
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      Series& axis = columns.axes[a];
      axis.raw.push_back(increment.rate_radps[a]);
      axis.compensated.push_back(out.compensated_radps[a]);
      axis.denoised.push_back(out.estimate.denoised_radps[a]);
      axis.variance.push_back(out.estimate.variance_rad2ps2[a]);
    }
    if ((out.estimate.flags & kGated) != 0) ++columns.gated;
    if ((out.compensator_flags & (kStaleChannel | kNoChannelYet)) != 0) ++columns.stale;
    if ((out.compensator_flags & kOutOfRange) != 0) ++columns.out_of_range;
    if ((out.flags & kNoiseUnknown) != 0) ++columns.unknown_noise;
  };
  OfflineResult result;
  if (!options.input.is_csv(options.capture) && file_kind(options.capture) != FileKind::lcm_log) {
    if (!options.input.has_driver())
      throw std::runtime_error(options.capture +
                               ": is no CSV capture, expected --driver NAME, --dbc FILE or --config F");
    DriverInstance driver = options.input.make_driver();
    result = denoise_recording(options.input, options.capture, driver, settings, sink);
  } else {
    result = denoise_capture(options.input.read(options.capture), settings, sink);
  }
  columns.axes.resize(result.axes.size());
  write_text_file(options.output, as_text(columns, result));
  if (options.output != "/dev/stdout") tell(options, columns, result);
  if (!options.json.empty()) write_text_file(options.json, summary(options, columns, result).dump(2) + "\n");
  if (!options.picture.empty()) draw(options.picture, columns, result);
}

}  // namespace

void add_denoise(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "denoise", "Denoise a capture as the daemon would, bit for bit with the same settings");
  auto options = std::make_shared<Options>();
  command->add_option("CAPTURE", options->capture, "CSV capture, raw bytes, candump or LCM log")->required();
  command
      ->add_option("--output", options->output, "CSV: time_s, raw, compensated, denoised, variance by axis")
      ->required()
      ->type_name("FILE");
  options->input.add_to(*command);
  add_filter_options(*command, options->filter);
  command->add_option("--model", options->model, "Model file of the sensor")->type_name("FILE");
  command->add_option("--config", options->config, "Take all settings from the daemon's configuration")
      ->type_name("FILE");
  command->add_option("--sensor", options->sensor, "Which sensor of the configuration")->type_name("NAME");
  command
      ->add_option("--rate", options->nominal_rate_hz,
                   "Nominal sample rate, Hz; else the driver's or the capture's")
      ->check(CLI::PositiveNumber);
  command->add_option("--start-up", options->start_up_s, "Seconds that show the noise when none is given (4)")
      ->check(CLI::PositiveNumber);
  command->add_option("--json", options->json, "Summary as JSON")->type_name("FILE");
  command->add_option("--plot", options->picture, "Picture, .svg or .png")->type_name("FILE");
  command->callback([options] { run(*options); });
}

}  // namespace ifog::tools
