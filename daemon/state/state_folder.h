// SPDX-License-Identifier: Apache-2.0
// The folder in which the daemon keeps what outlives a run, and the one home for files in it. Others may write there: members
// of the daemon's group, and root by `ifog adopt`. So a link in it is never followed, and a file with hard links is refused.
// tests/layout/check_state_paths.py says that nobody else opens them.
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

// The folder as configured, else the first of the service manager's STATE_DIRECTORY, else "".
[[nodiscard]] std::string state_folder(const std::string& configured);

// Makes it, with the rights that it is installed with, where it is not there. Gives a complaint, "" for none;
// folder "": none.
[[nodiscard]] std::string make_state_folder(const std::string& folder);

// What make_state_folder() would complain of, by what is there now; makes nothing.
[[nodiscard]] std::string state_folder_complaint(const std::string& folder);

// The model of a sensor whose configuration names none.
[[nodiscard]] std::string adopted_model_path(const std::string& folder, const std::string& sensor);

// A descriptor that is closed.
class Fd {
 public:
  explicit Fd(int fd) : fd_(fd) {}
  ~Fd();
  Fd(const Fd&) = delete;
  Fd& operator=(const Fd&) = delete;
  operator int() const { return fd_; }

 private:
  int fd_;
};

// The whole file, in place of what has that name: a new file of a name that cannot be foreseen is written and synced in the
// folder and renamed. A link of that name is replaced, and what it points at stays as it was. The folder is opened once, and
// all is done relative to it. Throws std::runtime_error with one line: path and reason.
void write_state_file(const std::string& path, std::string_view bytes);

// The content of a regular file with one name, that is no link and belongs to who owns the folder, its group, root or this user.
// Nothing: there is none. Throws likewise, also beyond `most` bytes.
[[nodiscard]] std::optional<std::string> state_file(const std::string& path,
                                                    std::size_t most = kInputLimits.json_bytes);
// The same for a file that must exist.
[[nodiscard]] std::string read_state_file(const std::string& path,
                                          std::size_t most = kInputLimits.json_bytes);

// Something has that name, be it a link that leads nowhere.
[[nodiscard]] bool is_in_state_folder(const std::string& path);

// Gone; also where there was none.
void remove_state_file(const std::string& path);

// What is in the folder, in order; a folder that is not there has nothing.
[[nodiscard]] std::vector<std::string> names_in_state_folder(const std::string& folder);

// A complaint about what such a file says, as it may be passed on: file and line, and nothing of its content, which others
// than the user wrote.
[[nodiscard]] std::string without_content(const std::string& path, const std::exception& error);

// What `parse` makes of the file; its complaints without content.
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
