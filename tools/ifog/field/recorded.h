// SPDX-License-Identifier: Apache-2.0
// The daemon's flight recordings of a sensor, for the commands that assess a model with them.
#pragma once

#include <cstdint>
#include <ctime>
#include <span>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "filters/model_file/model.h"
#include "filters/rest/rest.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/field/models.h"

namespace ifog::tools {

struct RecordedFile {
  std::uint64_t number = 0;
  std::string path;
  std::uint64_t bytes = 0;
  bool open = false;       // being written, or not closed properly
  std::time_t opened = 0;  // 0: unknown
};

// The files in the sensor's folder, by number; empty if there is no folder.
[[nodiscard]] std::vector<RecordedFile> recorded_files(const SensorConfig& sensor);

// The newest ones of so many files and bytes in total; of some at least one.
[[nodiscard]] std::vector<RecordedFile> newest(std::span<const RecordedFile> files, std::size_t most,
                                               double most_bytes);

// The files of one power-up, that with most bytes, because each power-up has its own warm-up. All files if
// they do not contain the time of power-up.
[[nodiscard]] std::vector<RecordedFile> of_one_power_up(const std::vector<RecordedFile>& files);

struct Recorded {
  LongCapture capture;
  double period_s = 0.0;
  Rest rest;
};

// Reads them with the driver that they name. Throws std::runtime_error with one line.
[[nodiscard]] Recorded read_recorded(const SensorConfig& sensor, const std::vector<RecordedFile>& files,
                                     const std::vector<std::string>& plugin_folders);

// Compares the corrections of two models on the rows from `begin` on; the rows before settle effects with
// memory. Returns the axes on which they differ. Throws std::runtime_error or std::invalid_argument with one
// line.
[[nodiscard]] std::vector<AxisGain> weigh_models(const Recorded& recorded, const Model& before,
                                                 const Model& after, std::size_t begin);

}  // namespace ifog::tools
