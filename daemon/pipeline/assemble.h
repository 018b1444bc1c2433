// SPDX-License-Identifier: Apache-2.0
// Builds a pipeline from a sensor's configuration.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/recorder/recorder.h"
#include "daemon/sensor/noise_memory.h"
#include "daemon/sensor/sensor_parts.h"

namespace ifog {

struct AssembledSensor {
  // Must outlive the pipeline, whose reader writes its tape; null without flight recorder.
  std::unique_ptr<Recorder> recorder;
  std::unique_ptr<Pipeline> pipeline;
  std::shared_ptr<ChannelTable> outside;
  std::vector<std::string> channels;  // names, as in ChainSettings
  NoiseMemory noise;
  ChainChoice choice;                 // in use, or offered to the filter
  std::vector<std::string> left_out;  // effects of the model that are not corrected, as text
  std::vector<std::string> remarks;   // about axes of the model that the sensor does not have
};

// By the readers' processors, sorted and unique; empty: all.
using ReadersProcessors = std::map<std::vector<int>, std::shared_ptr<SharedProcessors>>;

// processors: of earlier sensors; this one's are added. Throws std::runtime_error with one line.
AssembledSensor assemble(const SensorConfig& sensor, const Config& config,
                         std::unique_ptr<Publisher> publisher, ReadersProcessors& processors);

}  // namespace ifog
