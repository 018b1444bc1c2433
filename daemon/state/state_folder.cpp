// SPDX-License-Identifier: Apache-2.0
#include "daemon/state/state_folder.h"

#include <cstdlib>
#include <filesystem>

namespace ifog {

std::string state_folder(const std::string& configured) {
  if (!configured.empty()) return configured;
  const char* const given = std::getenv("STATE_DIRECTORY");
  if (given == nullptr) return "";
  const std::string all = given;
  return all.substr(0, all.find(':'));
}

std::string adopted_model_path(const std::string& folder, const std::string& sensor) {
  return (std::filesystem::path(folder) / (sensor + ".model.toml")).string();
}

}  // namespace ifog
