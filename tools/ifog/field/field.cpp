// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/field.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "daemon/state/state_folder.h"
#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "filters/model_file/toml_file.h"
#include "tools/ifog/captures/flight/flight_input.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"

namespace ifog::tools {

void FieldOptions::add_to(const Command& command) {
  command.add_option("--config", config,
                     std::string("the daemon's configuration; default: ") + kServiceConfig, kReadsFile);
  command.add_option(
      "--state", state,
      std::string("the daemon's state folder; default: as configured, else $STATE_DIRECTORY, else ") +
          kServiceState,
      {.type = "FOLDER"});
}

std::string FieldOptions::as_typed() const {
  std::string text;
  if (!config.empty()) text += " --config " + shell_file(config);
  if (!state.empty()) text += " --state " + shell_file(state);
  return text;
}

std::string Field::command(const std::string& name, const std::string& sensor) const {
  return "ifog " + name + " " + shell_word(sensor) + typed_;
}

Field::Field(const FieldOptions& options) : typed_(options.as_typed()) {
  config_path_ = options.config.empty() ? kServiceConfig : options.config;
  std::error_code none;
  if (!options.config.empty() || std::filesystem::exists(config_path_, none))
    // Adopted models come from this state folder, which may differ from the configured one.
    config_ = parse_config(read_toml_text(config_path_), config_path_);
  state_ = options.state.empty() ? state_folder(config_ ? config_->state_folder : "") : options.state;
  if (state_.empty()) state_ = kServiceState;
  if (config_) {
    use_adopted_models(*config_, state_);
    will_read_files_of(*config_);
  }
}

const Config& Field::required_config() const {
  if (!config_)
    throw refusal("{}: is not there, expected the daemon's configuration (--config)", config_path_);
  return *config_;
}

const SensorConfig& Field::sensor(const std::string& name) const {
  std::vector<std::string_view> known;
  for (const SensorConfig& sensor : required_config().sensors) {
    if (sensor.name == name) return sensor;
    known.emplace_back(sensor.name);
  }
  throw refusal("{}: no sensor {}{}", config_path_, in_quotes(name), meant_or_known(name, known));
}

std::string Field::model_path(const SensorConfig& sensor) const {
  return sensor.model.empty() ? adopted_model_path(state_, sensor.name) : sensor.model;
}

void share_with_the_group() { ::umask(S_IWOTH); }

StateLock::StateLock(const std::string& folder)
    : fd_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (fd_ < 0)
    throw refusal("{}: cannot open: {}, expected the daemon's state folder (--state)", folder,
                  std::generic_category().message(errno));
  if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
  if (errno == EWOULDBLOCK)
    throw refusal("{}: another command works in it just now, try again when it is done", folder);
  throw refusal("{}: cannot lock: {}", folder, std::generic_category().message(errno));
}

}  // namespace ifog::tools
