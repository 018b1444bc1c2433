// SPDX-License-Identifier: Apache-2.0
// Where the daemon of this computer has its configuration and its state, for the commands that look after it.
#pragma once

#include <optional>
#include <string>

#include "daemon/config/config.h"
#include "tools/ifog/console/options/command.h"

namespace ifog::tools {

// Of the installed service.
inline constexpr const char* kServiceConfig = "/etc/ifogd/ifogd.toml";
inline constexpr const char* kServiceState = "/var/lib/ifogd";

struct FieldOptions {
  std::string config;  // --config; "": where the service has it, if it is there
  std::string state;   // --state; "": as configured, else STATE_DIRECTORY, else where the service has it
  void add_to(const Command& command);
  // Those that were given, as a shell takes them again: " --config F".
  [[nodiscard]] std::string as_typed() const;
};

class Field {
 public:
  // Throws ConfigError or std::runtime_error with one line: a configuration that was named or is there and
  // cannot be read. One that was not named need not be there.
  explicit Field(const FieldOptions& options);

  // Null: there is no configuration.
  [[nodiscard]] const Config* config() const { return config_ ? &*config_ : nullptr; }
  [[nodiscard]] const std::string& state() const { return state_; }
  // The file that was read, or looked for.
  [[nodiscard]] const std::string& config_path() const { return config_path_; }
  // A command about a sensor that looks after the same field, to be copied.
  [[nodiscard]] std::string command(const std::string& name, const std::string& sensor) const;

  // Throws std::runtime_error with one line: no configuration, or no such sensor in it, with those there are.
  [[nodiscard]] const SensorConfig& sensor(const std::string& name) const;
  [[nodiscard]] const Config& required_config() const;
  // The file that the sensor's model is in, or would be.
  [[nodiscard]] std::string model_path(const SensorConfig& sensor) const;

 private:
  std::optional<Config> config_;
  std::string config_path_, state_, typed_;
};

// What a person writes into the state folder, the daemon's own user reads and writes on, and the other way
// round: by its group, which the folder hands on (tmpfiles.d).
void share_with_the_group();

// While it lives no other command changes anything in the state folder. Throws std::runtime_error with one
// line: another one does, no such folder, no right to it.
class StateInHand {
 public:
  explicit StateInHand(const std::string& folder);
  ~StateInHand();
  StateInHand(const StateInHand&) = delete;
  StateInHand& operator=(const StateInHand&) = delete;

 private:
  int fd_;
};

}  // namespace ifog::tools
