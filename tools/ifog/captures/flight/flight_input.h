// SPDX-License-Identifier: Apache-2.0
// Reads a flight recording with the driver and sensor of its header.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "drivers/capture/capture_builder.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/recording.h"
#include "drivers/flight/decode.h"
#include "drivers/host/driver_instance.h"
#include "filters/estimator/learned_noise.h"
#include "filters/model_file/model.h"
#include "tools/ifog/captures/table/long_table.h"

namespace ifog::tools {

// Makes a driver, prints its warnings and registers the files in its settings as inputs of the run
// (command_files.h). folders: search path of plugins; empty: the standard folders. Throws as DriverInstance
// does.
[[nodiscard]] DriverInstance driver_of_run(const std::string& name, const DriverSettings& settings,
                                           const std::vector<std::string>& folders = {});

class FlightInput {
 public:
  // Reads the header; the file must outlive this. Throws std::runtime_error with one line.
  explicit FlightInput(InputFile& file);

  [[nodiscard]] const FlightHeader& header() const { return reader_.header(); }
  // Counts of what has been read so far.
  [[nodiscard]] const FlightCounts& counts() const { return reader_.counts(); }
  [[nodiscard]] const std::string& path() const { return file_.path(); }

  // Makes the recording's driver with its options, overridden by `options`; if `driver` names another one,
  // that with `options` only. folders: search path of plugins; empty: the standard folders. configured:
  // supplies files that the recording lacks; must outlive this. A later file with other options gets a driver
  // of its own.
  [[nodiscard]] DriverInstance make_driver(const std::string& driver, const DriverSettings& options,
                                           const std::vector<std::string>& folders = {},
                                           const SensorConfig* configured = nullptr);
  // The sensor's configuration, with the model that the recording carries. Throws as above if it carries no
  // model of that name.
  [[nodiscard]] SensorConfig sensor() const;
  [[nodiscard]] std::shared_ptr<const Model> model(const SensorConfig& sensor) const;
  // Noise that the daemon's filter started with; nullopt if it learned the noise in this recording.
  [[nodiscard]] std::optional<LearnedNoise> noise(const SensorConfig& sensor) const;

  // Delivers all samples and prints losses on standard error. Throws as above, also if there is no sample.
  RecordingCounts for_each_sample(DriverInstance& driver, const RecordedSamples& sink);
  // All samples as columns, with the channels of other sources.
  LongTable table(DriverInstance& driver);
  // The same in blocks, with every axis and channel that is possible.
  RowNotes rows(DriverInstance& driver, RowSink& sink);
  // `bytes`, `can` and `message` entries as recorded, for `ifog replay`.
  void for_each_entry(const std::function<void(const FlightEntry&)>& sink);

 private:
  // Returns the time since power-up of the first sample if the header has it.
  std::optional<double> build(DriverInstance& driver, CaptureBuilder& builder);
  void tell_losses() const;
  [[nodiscard]] DriverInstance made() const;
  [[nodiscard]] bool names_the_driver() const;

  InputFile& file_;
  FlightReader reader_;
  // set by make_driver()
  std::string driver_;
  DriverSettings options_;
  std::vector<std::string> folders_;
  const SensorConfig* configured_ = nullptr;
};

// Registers the files that a daemon's configuration names as inputs of the run (command_files.h): models, files named by drivers' options, and devices
// or channels that are files. Throws WrongUsage as will_read() does.
void will_read_files_of(const Config& config);

}  // namespace ifog::tools
