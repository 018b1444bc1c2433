// SPDX-License-Identifier: Apache-2.0
// Finding and loading protocol plugins.
//
// The file of driver NAME is NAME.so, so that starting a sensor loads that one object and no other.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/ifog/driver.h"

namespace ifog {

// A loaded plugin. Unloaded when the last owner goes, so instances keep it alive.
class Plugin {
 public:
  // Throws std::runtime_error with one line: cannot be loaded, no ifog_driver_entry, another interface
  // version (both numbers are named), a name that is not the file's, a table with a function missing.
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

// Where plugins are looked for, in this order: `first` (the configuration's), the colon-separated
// IFOG_PLUGIN_PATH, the build tree's folder when the running program lies in a build tree, lib/ifogd/plugins
// next to the program's bin, the folder of the installation prefix. Folders that do not exist are skipped,
// except those of `first`.
std::vector<std::string> plugin_folders(const std::vector<std::string>& first = {});

// The plugin NAME.so of the first folder that has it. Throws std::runtime_error: not there (what is there and
// where was looked are named), or as Plugin::load.
std::shared_ptr<const Plugin> find_plugin(const std::string& name, const std::vector<std::string>& folders);

struct FoundPlugin {
  std::string path;
  std::shared_ptr<const Plugin> plugin;  // null when refused
  std::string refusal;                   // the line Plugin::load threw
  bool hidden = false;                   // a folder before this one has a plugin of the same name
};

// Every *.so of the folders, loaded, by folder and name.
std::vector<FoundPlugin> list_plugins(const std::vector<std::string>& folders);

}  // namespace ifog
