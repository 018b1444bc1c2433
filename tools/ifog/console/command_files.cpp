// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/command_files.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "drivers/capture/output_file.h"
#include "drivers/ifog/quoted.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

struct CommandFile {
  std::string option;
  FileIdentity identity;
  bool written;
};

std::vector<CommandFile> files;

void add(const std::string& option, const std::string& path, bool written) {
  std::optional<FileIdentity> identity = file_identity(path == "-" && !written ? "/dev/stdin" : path);
  if (!identity) return;
  const auto same = std::find_if(files.begin(), files.end(), [&](const CommandFile& other) {
    return (other.written || written) && other.identity == *identity;
  });
  if (same != files.end())
    throw CLI::ValidationError(option, "is " + in_quotes(path) + ", the file that " + same->option +
                                           (same->written ? " writes" : " reads") + "; expected another one");
  files.push_back({option, *std::move(identity), written});
}

}  // namespace

void will_read(const std::string& option, const std::string& path) {
  if (path.empty()) return;
  std::error_code none;
  if (!std::filesystem::is_directory(path, none)) return add(option, path, false);
  for (const auto& entry : std::filesystem::directory_iterator(path, none))
    if (entry.path().extension() == ".ifr") add(option, entry.path().string(), false);
}

void will_write(const std::string& option, const std::string& path) {
  if (path.empty()) return;
  if (is_standard_output(path)) data_to_standard_output(option);
  add(option, path, true);
}

void expect_ending(const std::string& option, const std::string& path, bool known,
                   const std::string& expected) {
  if (known || path.empty() || is_standard_output(path) || !file_identity(path)) return;
  if (!std::filesystem::path(path).has_extension()) return;
  throw CLI::ValidationError(option, "is " + in_quotes(path) + ", expected a name ending in " + expected);
}

}  // namespace ifog::tools
