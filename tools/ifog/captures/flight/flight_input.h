// SPDX-License-Identifier: Apache-2.0
// A flight recording as the commands read it: what its header says becomes the driver and the sensor.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "drivers/capture/capture.h"
#include "drivers/capture/capture_builder.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/recording.h"
#include "drivers/flight/decode.h"
#include "drivers/host/driver_instance.h"
#include "filters/estimator/learned_noise.h"
#include "filters/model_file/model.h"

namespace ifog::tools {

// A driver as the commands make it: its warnings are printed, and the files that its settings name are
// read: no output of the run is one of them (command_files.h). folders: that plugins are looked for in;
// empty: the standard places. Throws as DriverInstance does.
[[nodiscard]] DriverInstance driver_of_run(const std::string& name, const DriverSettings& settings,
                                           const std::vector<std::string>& folders = {});

class FlightInput {
 public:
  // Reads the header; the file must outlive this. Throws std::runtime_error with one line.
  explicit FlightInput(InputFile& file);

  [[nodiscard]] const FlightHeader& header() const { return reader_.header(); }
  // Counts of what has been read of it.
  [[nodiscard]] const FlightCounts& counts() const { return reader_.counts(); }
  [[nodiscard]] const std::string& path() const { return file_.path(); }

  // The driver of the recording with its options, those of `options` over them; another one, which then has
  // only `options`, where `driver` names it.
  // folders: that plugins are looked for in; empty: the standard places. configured: whose files serve where the
  // recording does not carry them; it outlives this. Where a later file of the recording names other options, it is
  // made from them.
  [[nodiscard]] DriverInstance make_driver(const std::string& driver, const DriverSettings& options,
                                           const std::vector<std::string>& folders = {},
                                           const SensorConfig* configured = nullptr);
  // As the daemon had it configured, and the model it used, which the recording carries. Null: none. Throws as above
  // where it carries none of that name.
  [[nodiscard]] SensorConfig sensor() const;
  [[nodiscard]] std::shared_ptr<const Model> model(const SensorConfig& sensor) const;
  // The noise that the daemon's filter began with; nothing where it learned it in this recording.
  [[nodiscard]] std::optional<LearnedNoise> noise(const SensorConfig& sensor) const;

  // All samples; what is missing is printed on standard error. Throws as above, also when there is no sample.
  RecordingCounts for_each_sample(DriverInstance& driver, const RecordedSamples& sink);
  // As columns, channels from elsewhere, too.
  Capture capture(DriverInstance& driver);
  // The same in pieces, with every axis and channel that there may be.
  RowNotes rows(DriverInstance& driver, RowSink& sink);
  // What came as it came, for `ifog replay`: `bytes`, `can` and `message` entries.
  void for_each_entry(const std::function<void(const FlightEntry&)>& sink);

 private:
  // Returns the time since power-up of the first sample, where the header tells it.
  std::optional<double> build(DriverInstance& driver, CaptureBuilder& builder,
                              const std::function<void()>& added);
  void tell_losses() const;
  [[nodiscard]] DriverInstance made() const;
  [[nodiscard]] bool names_the_driver() const;

  InputFile& file_;
  FlightReader reader_;
  // By make_driver().
  std::string driver_;
  DriverSettings options_;
  std::vector<std::string> folders_;
  const SensorConfig* configured_ = nullptr;
};

}  // namespace ifog::tools
