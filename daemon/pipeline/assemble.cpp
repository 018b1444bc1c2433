// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/assemble.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "daemon/sensor/flight_header.h"
#include "daemon/state/state_folder.h"
#include "drivers/ifog/quoted.h"
#include "filters/model_file/model_axes.h"
#include "msgs/channel_name.h"

namespace ifog {

namespace {

std::unique_ptr<Recorder> make_recorder(const SensorConfig& sensor, const Config& config,
                                        const DriverInstance& driver, const NoiseMemory& noise) {
  const RecordConfig& record = sensor.record;
  if (record.folder.empty()) return nullptr;
  if (std::error_code none;
      std::filesystem::exists(record.folder, none) && !std::filesystem::is_directory(record.folder, none))
    throw std::runtime_error("sensor.record.folder = \"" + printable(record.folder, kLongestMessage) +
                             "\": is no folder, expected one, or a path that is free for it");
  ArchiveLimits limits;
  limits.bytes = record.bytes;
  limits.age_ns = static_cast<std::int64_t>(record.days * 86'400e9);
  limits.file_bytes = record.file_bytes;
  limits.file_ns = static_cast<std::int64_t>(record.file_s * 1e9);
  return std::make_unique<Recorder>(sensor.name + ":rec", record.buffer_bytes,
                                    make_flight_folder(record.folder + "/" + sensor.name), limits,
                                    flight_header(sensor, config, driver, noise.text(noise.recalled())));
}

std::shared_ptr<SharedProcessors> shared(ReadersProcessors& all, std::vector<int> cpus) {
  std::sort(cpus.begin(), cpus.end());
  cpus.erase(std::unique(cpus.begin(), cpus.end()), cpus.end());
  const auto any = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::shared_ptr<SharedProcessors>& out = all[cpus];
  if (out == nullptr)
    out = std::make_shared<SharedProcessors>(cpus.empty() ? any : static_cast<int>(cpus.size()));
  return out;
}

}  // namespace

AssembledSensor assemble(const SensorConfig& sensor, const Config& config,
                         std::unique_ptr<Publisher> publisher, ReadersProcessors& processors) {
  DriverInstance driver = make_sensor_driver(sensor, config.plugin_folders);
  std::unique_ptr<Transport> transport = make_sensor_transport(sensor, driver);
  const std::shared_ptr<const Model> model = read_sensor_model(sensor);
  ChainSettings settings = sensor_chain_settings(sensor, driver.description(), model);
  AssembledSensor out;
  out.choice = chain_choice(sensor, model.get());
  out.channels = settings.channels;
  out.outside = std::make_shared<ChannelTable>(settings.facts.channels - settings.facts.frame_channels);
  out.noise = NoiseMemory(state_folder(config.state_folder), sensor.name, sensor.driver, settings.facts);
  settings.learned = out.noise.recalled();
  settings.powered_ns = powered_ns(sensor);
  std::unique_ptr<ChainParts> parts = make_chain_parts(sensor, settings);
  out.left_out = parts->left_out();
  if (model != nullptr) out.remarks = remarks_on_axes(*model, settings.axes);
  out.recorder = make_recorder(sensor, config, driver, out.noise);
  PipelinePlan plan;
  if (out.recorder != nullptr) plan.tape = &out.recorder->tape();
  plan.lcm_channel = sensor.lcm_channel();
  if (sensor.imu)
    plan.also.push_back({std::string(kImuType), sensor.lcm_channel() + std::string(kImuEnding)});
  plan.also.insert(plan.also.end(), sensor.publish.begin(), sensor.publish.end());
  plan.facts = settings.facts;
  plan.ring_slots = static_cast<std::size_t>(sensor.realtime.ring_slots);
  plan.reader = {sensor.name + ":read", sensor.realtime.reader_priority, sensor.realtime.reader_cpus};
  plan.filter = {sensor.name + ":filt", sensor.realtime.filter_priority, sensor.realtime.filter_cpus};
  plan.processors = shared(processors, sensor.realtime.reader_cpus);
  plan.spin = sensor.realtime.spin;
  // If the filter has its own processors, its steps are done there.
  plan.direct = sensor.realtime.direct && (sensor.realtime.filter_cpus.empty() ||
                                           sensor.realtime.filter_cpus == sensor.realtime.reader_cpus);
  out.pipeline = std::make_unique<Pipeline>(std::move(plan), std::move(transport), std::move(driver),
                                            out.outside, std::move(parts), std::move(publisher));
  return out;
}

}  // namespace ifog
