// SPDX-License-Identifier: Apache-2.0
// Folder for the daemon's persistent data, and all access to its files. Others can write there (members of
// the daemon's group, root with `ifog adopt`). So links are never followed and files with hard links are
// rejected. tests/layout/check_state_paths.py checks that no other code opens these files.
#pragma once

#include <cstddef>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/system/input_limits.h"

namespace ifog {

// The configured folder, else the first of the service manager's STATE_DIRECTORY, else "".
[[nodiscard]] std::string state_folder(const std::string& configured);

// Creates it with the permissions of an installation if it is missing. Returns "" or an error; folder "": no
// effect.
[[nodiscard]] std::string make_state_folder(const std::string& folder);

// Error that make_state_folder() would return now; creates nothing.
[[nodiscard]] std::string state_folder_complaint(const std::string& folder);

// Model of a sensor whose configuration has none.
[[nodiscard]] std::string adopted_model_path(const std::string& folder, const std::string& sensor);

// Replaces a whole file: a new file with a random name is written and synced in the folder and renamed. A
// link of the old name is replaced, not followed. The folder is opened once. Throws std::runtime_error with
// one line: path and reason.
void write_state_file(const std::string& path, std::string_view bytes);

// Content of a regular file without links, owned by the folder's owner, its group, root or this user. nullopt
// if it does not exist. Throws likewise, also beyond `most` bytes.
[[nodiscard]] std::optional<std::string> state_file(const std::string& path,
                                                    std::size_t most = kInputLimits.json_bytes);
// The same for a file that must exist.
[[nodiscard]] std::string read_state_file(const std::string& path,
                                          std::size_t most = kInputLimits.json_bytes);

// True if the name exists, even as a broken link.
[[nodiscard]] bool is_in_state_folder(const std::string& path);

// Removes the file if it exists.
void remove_state_file(const std::string& path);

// Names in the folder, sorted; empty if it does not exist.
[[nodiscard]] std::vector<std::string> names_in_state_folder(const std::string& folder);

// Error text about such a file for other users: file and line without its content, which others have written.
[[nodiscard]] std::string without_content(const std::string& path, const std::exception& error);

// Parses the file; errors are without content.
template <typename Parse>
auto parsed_state_file(const std::string& path, Parse&& parse) {
  const std::string text = read_state_file(path, kInputLimits.toml_bytes);
  try {
    return parse(text, path);
  } catch (const std::exception& error) {
    throw std::runtime_error(without_content(path, error));
  }
}

}  // namespace ifog
