// SPDX-License-Identifier: Apache-2.0
// Asks the daemon, replaces a sensor's model and checks that the daemon uses it.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <ifog/status_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "tools/ifog/field/field.h"
#include "tools/ifog/field/models.h"

namespace ifog::tools {

// By the sensor's name as the daemon spells it.
using Statuses = std::map<std::string, status_t>;

// Asks the daemon for the status of its sensors through the socket in its state folder.
class LiveStatus {
 public:
  LiveStatus(std::string folder, pid_t daemon) : folder_(std::move(folder)), daemon_(daemon) {}

  // Asks twice per second until enough(), a timeout or an interrupt; false in the last two cases. Throws
  // std::runtime_error with one line if the daemon does not answer.
  bool ask(std::chrono::milliseconds most, const std::function<bool(const Statuses&)>& enough);
  // Throws likewise, also with the reasons for which the daemon rejects the configuration.
  void reload(std::chrono::milliseconds most) const;

  [[nodiscard]] pid_t daemon() const { return daemon_; }
  [[nodiscard]] const Statuses& all() const { return all_; }
  // Null: the daemon has no such sensor.
  [[nodiscard]] const status_t* of(const std::string& sensor) const;

 private:
  std::string folder_;
  pid_t daemon_;
  Statuses all_;
};

// Throws std::runtime_error with one line if the daemon cannot run the sensor with this model. Uses the
// daemon's own code.
void require_that_it_fits(const Field& field, const SensorConfig& sensor, const Model& model);

// Replaces a sensor's model; if the daemon does not use it, restores the previous one.
class ModelExchange {
 public:
  // Checks only. `in_use`: the model in the file. Throws std::runtime_error with one line if the daemon runs
  // but does not answer or uses another model. Also if the sensor is not running, because the exchange could
  // not be verified.
  ModelExchange(const Field& field, const SensorConfig& sensor, const ModelName& in_use);

  [[nodiscard]] bool daemon_runs() const { return live_.has_value(); }
  [[nodiscard]] LiveStatus& live() { return *live_; }

  // model: nullopt removes the file. Throws std::runtime_error with one line after restoring `before`.
  void exchange(const std::optional<Model>& model, const std::optional<Model>& before);

 private:
  void put(const std::optional<Model>& model) const;
  void ask_for_reload();
  [[nodiscard]] bool takes_effect(const std::string& identity);
  [[nodiscard]] std::string why_not_in_effect() const;

  const Field& field_;
  std::string sensor_, path_;
  std::optional<LiveStatus> live_;  // of the running daemon
};

}  // namespace ifog::tools
