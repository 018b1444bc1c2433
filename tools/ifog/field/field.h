// SPDX-License-Identifier: Apache-2.0
// Configuration and state folder of this computer's daemon, for the commands that work on them.
#pragma once

#include <optional>
#include <string>

#include "daemon/config/config.h"
#include "drivers/system/fd.h"
#include "tools/ifog/console/command.h"

namespace ifog::tools {

// Of the installed service.
inline constexpr const char* kServiceConfig = "/etc/ifogd/ifogd.toml";
inline constexpr const char* kServiceState = "/var/lib/ifogd";

struct FieldOptions {
  std::string config;  // --config; "": the service's, if it exists
  std::string state;   // --state; "": as configured, else STATE_DIRECTORY, else the service's
  void add_to(const Command& command);
  // The given options in shell syntax: " --config F".
  [[nodiscard]] std::string as_typed() const;
};

class Field {
 public:
  // Registers the files that the configuration names as inputs of the run (command_files.h). Throws
  // ConfigError or std::runtime_error with one line if a given or existing configuration cannot be read. The
  // default one need not exist.
  explicit Field(const FieldOptions& options);

  // Null: no configuration.
  [[nodiscard]] const Config* config() const { return config_ ? &*config_ : nullptr; }
  [[nodiscard]] const std::string& state() const { return state_; }
  // The file that was read or searched for.
  [[nodiscard]] const std::string& config_path() const { return config_path_; }
  // Command line of another command for this sensor with the same options, to be copied by the user.
  [[nodiscard]] std::string command(const std::string& name, const std::string& sensor) const;

  // Throws std::runtime_error with one line: no configuration, or no such sensor (lists those there are).
  [[nodiscard]] const SensorConfig& sensor(const std::string& name) const;
  [[nodiscard]] const Config& required_config() const;
  // Path of the sensor's model; the file may not exist.
  [[nodiscard]] std::string model_path(const SensorConfig& sensor) const;

 private:
  std::optional<Config> config_;
  std::string config_path_, state_, typed_;
};

// Makes new files writable for the group, which the state folder passes on (tmpfiles.d), so that the daemon's
// user and a person can change each other's files.
void share_with_the_group();

// Locks the state folder against other commands. Throws std::runtime_error with one line: locked, no such
// folder, no permission.
class StateLock {
 public:
  explicit StateLock(const std::string& folder);

 private:
  Fd fd_;
};

}  // namespace ifog::tools
