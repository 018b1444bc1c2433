// SPDX-License-Identifier: Apache-2.0
// Finds and loads protocol plugins. The file of driver NAME is NAME.so, so a sensor loads only its own
// object.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/ifog/driver.h"

namespace ifog {

// A loaded plugin. Unloaded with its last owner, so instances keep it alive.
class Plugin {
 public:
  // Throws std::runtime_error with one line: cannot be loaded, no ifog_driver_entry, another interface
  // version (with both numbers), a name that is not the file's, a missing function.
  static std::shared_ptr<const Plugin> load(const std::string& path);
  ~Plugin();
  Plugin(const Plugin&) = delete;
  Plugin& operator=(const Plugin&) = delete;

  [[nodiscard]] const ifog_driver& table() const { return *table_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  Plugin(std::string path, void* handle) : path_(std::move(path)), handle_(handle) {}
  std::string path_;
  void* handle_;
  const ifog_driver* table_ = nullptr;
};

// Search path: `first` (from the configuration), colon-separated IFOG_PLUGIN_PATH, the build tree's folder if
// the program is in one, lib/ifogd/plugins next to the program's bin, the installation prefix. Missing
// folders are skipped, except those of `first`.
std::vector<std::string> plugin_folders(const std::vector<std::string>& first = {});

// NAME.so from the first folder that has it. Throws std::runtime_error: not found (with the available plugins
// and the search path), or as Plugin::load.
std::shared_ptr<const Plugin> find_plugin(const std::string& name, const std::vector<std::string>& folders);

struct FoundPlugin {
  std::string path;
  std::shared_ptr<const Plugin> plugin;  // null if refused
  std::string refusal;                   // message from Plugin::load
  bool hidden = false;                   // an earlier folder has a plugin of the same name
};

// Loads every *.so of the folders; by folder and name.
std::vector<FoundPlugin> list_plugins(const std::vector<std::string>& folders);

}  // namespace ifog
