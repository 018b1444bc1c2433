// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/configured_files.h"

#include <memory>
#include <stdexcept>
#include <string>

#include "drivers/host/driver_instance.h"
#include "tools/ifog/console/command_files.h"

namespace ifog::tools {
namespace {

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
