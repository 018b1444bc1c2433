// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/flight/flight_input.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "daemon/sensor/flight_header.h"
#include "daemon/sensor/noise_memory.h"
#include "daemon/sensor/sensor_parts.h"
#include "drivers/capture/capture_builder.h"
#include "drivers/host/driver_instance.h"
#include "drivers/system/fd.h"
#include "filters/model_file/kept_noise.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

// A driver's options with their values and the content of the files that they name.
std::map<std::string, std::pair<std::string, std::string>> options_in(const FlightHeader& header) {
  std::map<std::string, std::pair<std::string, std::string>> out;
  for (const auto& [key, value] : header.options) {
    const auto file = header.files.find(value);
    out[key] = {value, file == header.files.end() ? "" : file->second};
  }
  return out;
}

void add(const ifog_driver_counters& from, ifog_driver_counters& to) {
  for (std::uint64_t ifog_driver_counters::*count :
       {&ifog_driver_counters::frames_good, &ifog_driver_counters::frames_crc,
        &ifog_driver_counters::frames_format, &ifog_driver_counters::bytes_skipped,
        &ifog_driver_counters::frames_repeated, &ifog_driver_counters::samples_incomplete,
        &ifog_driver_counters::bytes_framed, &ifog_driver_counters::bytes_pending,
        &ifog_driver_counters::values_refused, &ifog_driver_counters::frames_other})
    to.*count += from.*count;
}

// If the driver is not installed here, it reads no file.
void will_read_options_of(const SensorConfig& sensor, const std::vector<std::string>& folders) {
  std::shared_ptr<const Plugin> plugin;
  try {
    plugin = find_plugin(sensor.driver, folders);
  } catch (const std::runtime_error&) {
    return;
  }
  const DriverSettings options = with_files_in(sensor.folder, plugin->table(), sensor.options);
  for (const std::string& key : file_settings(plugin->table(), options))
    will_read("the configuration's option " + key + " of sensor " + sensor.name, options.at(key));
}

}  // namespace

DriverInstance driver_of_run(const std::string& name, const DriverSettings& settings,
                             const std::vector<std::string>& folders) {
  std::shared_ptr<const Plugin> plugin = find_plugin(name, plugin_folders(folders));
  for (const std::string& key : file_settings(plugin->table(), settings))
    will_read("option " + key + " of driver " + name, settings.at(key));
  DriverInstance made(std::move(plugin), settings);
  for (const std::string& warning : made.warnings()) warn("{}\n", warning);
  return made;
}

FlightInput::FlightInput(InputFile& file)
    : file_(file), reader_([&file](char* to, std::size_t most) { return file.read(to, most); }) {
  naming(file_.path(), [this] { reader_.next(); });
}

// True if the recording's own driver is used.
bool FlightInput::names_the_driver() const { return driver_.empty() || driver_ == header().driver; }

DriverInstance FlightInput::make_driver(const std::string& driver, const DriverSettings& options,
                                        const std::vector<std::string>& folders,
                                        const SensorConfig* configured) {
  driver_ = driver;
  options_ = options;
  folders_ = folders;
  configured_ = configured;
  return made();
}

// A header is not trusted: files that it names are read only from the recording itself.
DriverInstance FlightInput::made() const {
  const bool other = !names_the_driver();
  return naming(file_.path(), [&] {
    if (header().driver.empty() && !other)
      throw std::runtime_error(
          "is a recording of LCM messages, expected none of --driver and --option with it");
    if (other) return driver_of_run(driver_, options_, folders_);
    DriverSettings settings = options_;
    const std::shared_ptr<const Plugin> plugin = find_plugin(header().driver, plugin_folders(folders_));
    const std::vector<std::string> files = file_settings(plugin->table(), header().options);
    DriverSettings own;
    if (configured_ != nullptr)
      own = with_files_in(configured_->folder, plugin->table(), configured_->options);
    std::vector<Fd>
        carried;  // in memory: some file systems do not open an unlinked file by its descriptor's name
    for (const auto& [key, value] : header().options) {
      const bool names_file = std::ranges::find(files, key) != files.end();
      const auto found = header().files.find(value);
      if (settings.contains(key)) continue;
      if (names_file && found == header().files.end() && !own.contains(key))
        throw refusal("does not carry the file of its driver's option {}, expected {}", key,
                      key == "dbc" ? "--dbc FILE" : "--option " + key + "=FILE");
      settings[key] = !names_file || found != header().files.end() ? value : own.at(key);
      if (!names_file || found == header().files.end()) continue;
      const Fd& text = carried.emplace_back(memfd_create("carried", MFD_CLOEXEC));
      const std::string& content = found->second;
      if (text < 0 || ::write(text, content.data(), content.size()) != std::ssize(content))
        throw refusal("{}: {}", key, std::generic_category().message(errno));
      settings[key] = "/proc/self/fd/" + std::to_string(text);
    }
    return driver_of_run(header().driver, settings, folders_);
  });
}

SensorConfig FlightInput::sensor() const {
  return naming(file_.path(), [this] { return recorded_sensor(header()); });
}

std::shared_ptr<const Model> FlightInput::model(const SensorConfig& sensor) const {
  const auto found = header().files.find(sensor.model);
  if (sensor.model.empty()) return nullptr;
  if (found == header().files.end())
    throw refusal(
        "{}: does not carry the model that it was recorded with, expected --model FILE or --config FILE",
        file_.path());
  return std::make_shared<const Model>(parse_model(found->second, sensor.model));
}

std::optional<LearnedNoise> FlightInput::noise(const SensorConfig& sensor) const {
  const auto found = header().files.find(noise_file_name(sensor.name));
  if (found == header().files.end()) return std::nullopt;
  return parse_kept_noise(found->second, file_.path() + ": " + found->first).noise;
}

void FlightInput::tell_losses() const {
  for (const std::string& loss : losses(reader_.counts())) warn("{}: {}\n", file_.path(), loss);
}

RecordingCounts FlightInput::for_each_sample(DriverInstance& driver, const RecordedSamples& sink) {
  return naming(file_.path(), [&] {
    RecordingCounts counts;
    auto options = options_in(header());
    // Data recorded with other options needs a driver with those options.
    const auto file = [&](const FlightHeader& header) {
      if (auto now = options_in(header); names_the_driver() && now != options) {
        options = std::move(now);
        add(driver.counters(), counts.driver);
        driver = made();
      }
      if (sink.file) sink.file(header);
    };
    const RecordedSamples counting{[&](const RecordedSample& sample) {
                                     ++counts.samples;
                                     sink.sample(sample);
                                   },
                                   sink.discontinuity, sink.missing, file, sink.merged};
    decode_flight(reader_, driver, counting);
    const std::uint64_t before = driver.counters().bytes_skipped;
    driver.reset();
    counts.bytes_at_end = driver.counters().bytes_skipped - before;
    add(driver.counters(), counts.driver);
    tell_losses();
    if (counts.samples == 0) throw refusal("driver {} finds no sample in it", driver.table().name);
    for (const std::string& loss : losses(counts)) warn("{}: {}\n", file_.path(), loss);
    return counts;
  });
}

std::optional<double> FlightInput::build(DriverInstance& driver, CaptureBuilder& builder) {
  std::int64_t first_ns = 0;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  builder.allow_restarts();
  std::vector<ChannelValue> before(header().channels.size());
  std::vector<double> fresh(before.size());
  for_each_sample(driver, {[&](const RecordedSample& recorded) {
                             for (std::size_t i = 0; i < before.size(); ++i) {
                               const ChannelValue& now = recorded.outside[i];
                               fresh[i] = now.same(before[i]) ? kNone : now.value;
                               before[i] = now;
                             }
                             builder.add(recorded.sample, fresh);
                             if (first_ns == 0) first_ns = recorded.read_ns;
                           },
                           [&] { builder.discontinuity(); },
                           {},
                           [&](const FlightHeader&) { builder.go_on_as(driver.description()); }});
  for (const std::string& line : builder.remarks()) warn("{}: {}\n", file_.path(), line);
  // From the first file's header; later power-ups are visible in the times.
  const auto powered_ns = header().powered_ns;
  if (!powered_ns || first_ns < *powered_ns) return std::nullopt;
  return static_cast<double>(first_ns - *powered_ns) * 1e-9;
}

LongTable FlightInput::table(DriverInstance& driver) {
  LongTable table;
  LongTableSink sink(table);
  static_cast<RowNotes&>(table) = rows(driver, sink);
  table.drop_unknown(file_.path());
  return table;
}

RowNotes FlightInput::rows(DriverInstance& driver, RowSink& sink) {
  return naming(file_.path(), [&] {
    CaptureBuilder builder(driver.description(), sink, header().channels);
    RowNotes notes;
    notes.since_power_up_s = build(driver, builder);
    builder.finish();
    return notes;
  });
}

void FlightInput::for_each_entry(const std::function<void(const FlightEntry&)>& sink) {
  naming(file_.path(), [&] {
    for (auto item = reader_.next(); item != FlightReader::Item::end; item = reader_.next())
      if (item == FlightReader::Item::entry) sink(reader_.entry());
    tell_losses();
  });
}

void will_read_files_of(const Config& config) {
  const std::vector<std::string> folders = plugin_folders(config.plugin_folders);
  for (const SensorConfig& sensor : config.sensors) {
    will_read("the configuration's model", sensor.model);
    will_read("the configuration's transport of sensor " + sensor.name, sensor.transport.file.path);
    for (const ChannelConfig& channel : sensor.channels)
      for (const std::string& path : {channel.path, channel.dbc})
        will_read("the configuration's channel " + channel.name, path);
    will_read_options_of(sensor, folders);
  }
}

}  // namespace ifog::tools
