// SPDX-License-Identifier: Apache-2.0
// The one way a file of the state folder is written and read. Others may write into that folder, members of the daemon's group
// among them, and root writes there by `ifog adopt`: so a name in it is never followed.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace ifog {

// The whole file, in place of what has that name: a new file of a name that cannot be foreseen is written and synced in the
// folder and renamed. A link of that name is replaced, and what it points at stays as it was. The folder is opened once, and
// all is done relative to it. Throws std::runtime_error with one line: path and reason.
void write_state_file(const std::string& path, std::string_view bytes);

// The content of a regular file with one name, that is no link. Throws likewise, also beyond `most` bytes.
[[nodiscard]] std::string read_state_file(const std::string& path, std::size_t most);

}  // namespace ifog
