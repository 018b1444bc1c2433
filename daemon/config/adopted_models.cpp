// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <sstream>
#include <system_error>

#include "daemon/config/config.h"
#include "daemon/state/state_folder.h"
#include "filters/model_file/toml_file.h"

namespace ifog {

void use_adopted_models(Config& config, const std::string& folder) {
  if (folder.empty()) return;
  for (SensorConfig& sensor : config.sensors) {
    if (!sensor.model.empty()) continue;
    const std::string path = std::filesystem::absolute(adopted_model_path(folder, sensor.name)).string();
    std::error_code none;
    if (!std::filesystem::exists(path, none)) continue;
    sensor.model = path;
    // So that a flight recording, too, names the model that was in use.
    toml::table table = parse_toml(sensor.text, "");
    table["sensor"][0].as_table()->insert_or_assign("model", path);
    std::ostringstream text;
    text << table;
    sensor.text = text.str();
  }
}

}  // namespace ifog
