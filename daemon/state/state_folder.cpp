// SPDX-License-Identifier: Apache-2.0
#include "daemon/state/state_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "drivers/ifog/quoted.h"

namespace ifog {

namespace fs = std::filesystem;

namespace {

// As systemd/ifogd.service.in has it: the group puts models there.
constexpr mode_t kMode = 02775;

std::string cannot(const std::string& folder, const char* what, const std::string& why) {
  return "daemon.state_folder = \"" + printable(folder) + "\": " + what + ": " + why +
         ", expected a folder that the daemon may write, or a path that is free for it";
}

}  // namespace

std::string state_folder(const std::string& configured) {
  if (!configured.empty()) return configured;
  const char* const given = std::getenv("STATE_DIRECTORY");
  if (given == nullptr) return "";
  const std::string all = given;
  return all.substr(0, all.find(':'));
}

std::string make_state_folder(const std::string& folder) {
  if (folder.empty()) return "";
  std::error_code error;
  const bool made = fs::create_directories(folder, error);
  if (error) return cannot(folder, "cannot be made", error.message());
  // Whatever the umask.
  if (made) ::chmod(folder.c_str(), kMode);
  return "";
}

std::string state_folder_complaint(const std::string& folder) {
  if (folder.empty()) return "";
  std::error_code error;
  fs::path there = folder;
  while (!fs::exists(there, error) && there.has_parent_path() && there != there.parent_path())
    there = there.parent_path();
  if (error || !fs::is_directory(there, error))
    return cannot(folder, "cannot be made",
                  error ? error.message() : std::generic_category().message(ENOTDIR));
  if (::access(there.c_str(), W_OK | X_OK) == 0) return "";
  return cannot(folder, there == fs::path(folder) ? "cannot be written" : "cannot be made",
                std::generic_category().message(errno));
}

std::string adopted_model_path(const std::string& folder, const std::string& sensor) {
  return (fs::path(folder) / (sensor + ".model.toml")).string();
}

}  // namespace ifog
