// SPDX-License-Identifier: Apache-2.0
// What the daemon's flight recorder has kept of a sensor, for the commands that judge a model by it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "drivers/capture/capture.h"
#include "filters/model_file/model.h"
#include "filters/rest/rest.h"
#include "tools/ifog/field/proposal.h"

namespace ifog::tools {

struct RecordedFile {
  std::uint64_t number = 0;
  std::string path;
  std::uint64_t bytes = 0;
  bool open = false;   // still being written, or left so
  std::string opened;  // UTC, as utc_now() writes it
};

// The files of the sensor's folder, by number; none where there is no such folder.
[[nodiscard]] std::vector<RecordedFile> recorded_files(const SensorConfig& sensor);

// Those of one power-up of the sensor, of several that with most bytes, where the recordings say when it was
// switched on: each power-up has its own warm-up. All of them where they do not say.
[[nodiscard]] std::vector<RecordedFile> of_one_power_up(const std::vector<RecordedFile>& files);

struct Recorded {
  Capture capture;
  double period_s = 0.0;
  Rest rest;
};

// Through the driver that they name. Throws std::runtime_error with one line.
[[nodiscard]] Recorded read_recorded(const SensorConfig& sensor, const std::vector<RecordedFile>& files,
                                     const std::vector<std::string>& plugin_folders);

// How the new model's correction compares with the old one's on rows from `begin` on; the rows before are
// there for both to settle on what has a memory. Axes on which the two differ. Throws std::runtime_error or
// std::invalid_argument with one line.
[[nodiscard]] std::vector<AxisGain> weigh_models(const Recorded& recorded, const Model& before,
                                                 const Model& after, std::size_t begin);

// The worst of the axes.
[[nodiscard]] PromiseVerdict verdict_of(const std::vector<AxisGain>& gain);

}  // namespace ifog::tools
