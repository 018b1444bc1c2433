// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/flight/driver_of_run.h"

#include <memory>
#include <utility>

#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {

DriverInstance driver_of_run(const std::string& name, const DriverSettings& settings,
                             const std::vector<std::string>& folders) {
  std::shared_ptr<const Plugin> plugin = find_plugin(name, plugin_folders(folders));
  for (const std::string& key : file_settings(plugin->table(), settings))
    will_read("option " + key + " of driver " + name, settings.at(key));
  DriverInstance made(std::move(plugin), settings);
  for (const std::string& warning : made.warnings()) warn("%s\n", warning.c_str());
  return made;
}

}  // namespace ifog::tools
