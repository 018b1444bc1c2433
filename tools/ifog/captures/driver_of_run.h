// SPDX-License-Identifier: Apache-2.0
// A driver as the commands make it.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/host/driver_instance.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {

// Its warnings are told, and the files that its settings name are read: no output of the run is one of them
// (command_files.h). folders: that plugins are looked for in; empty: the standard places. Throws as
// DriverInstance does.
[[nodiscard]] DriverInstance driver_of_run(const std::string& name, const DriverSettings& settings,
                                           const std::vector<std::string>& folders = {});

inline DriverInstance driver_of_run(const std::string& name, const DriverSettings& settings,
                                    const std::vector<std::string>& folders) {
  std::shared_ptr<const Plugin> plugin = find_plugin(name, plugin_folders(folders));
  for (const std::string& key : file_settings(plugin->table(), settings))
    will_read("option " + key + " of driver " + name, settings.at(key));
  DriverInstance made(std::move(plugin), settings);
  for (const std::string& warning : made.warnings()) warn("%s\n", warning.c_str());
  return made;
}

}  // namespace ifog::tools
