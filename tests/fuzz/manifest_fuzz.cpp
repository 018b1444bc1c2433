// SPDX-License-Identifier: Apache-2.0
// Any text as the manifest of a fleet: rejected with one line, or gyros whose serials are names of one folder
// each within the results folder, and whose captures are file names.
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>

#include "tools/ifog/fleet/manifest.h"

namespace {

void require(bool good) {
  if (!good) std::abort();
}

void check(const ifog::tools::Manifest& manifest) {
  require(!manifest.type.empty() && !manifest.gyros.empty());
  std::set<std::string> folders, files;
  for (const auto& gyro : manifest.gyros) {
    require(!gyro.serial.empty() && gyro.serial.size() <= 64);
    require(std::filesystem::path(gyro.serial).filename() == gyro.serial && gyro.serial != "." &&
            gyro.serial != ".." && gyro.serial.front() != '-');
    std::string folder;
    for (const char c : gyro.serial) {
      require(c > ' ' && c < 0x7F);
      folder += static_cast<char>(std::tolower(c));
    }
    require(folders.insert(folder).second);
    require(!gyro.captures.empty());
    for (const std::string& capture : gyro.captures)
      require(!capture.empty() && capture != "-" && capture.find('\0') == std::string::npos &&
              files.insert(capture).second);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const char* path : {"lot.toml", "/lots/of/1760/lot.toml"}) {
    try {
      check(ifog::tools::parse_manifest(text, path));
    } catch (const std::runtime_error& error) {
      require(std::string_view(error.what()).find('\n') == std::string_view::npos);
    }
  }
  return 0;
}
