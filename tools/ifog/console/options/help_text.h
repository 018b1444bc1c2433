// SPDX-License-Identifier: Apache-2.0
// Layout of --help.
#pragma once

#include <cstddef>
#include <string>

namespace ifog::tools {

// Breaks the parser's two columns, the second of which begins at `column`, into lines of at most `width`,
// without repeated empty lines. Examples are not broken.
[[nodiscard]] std::string broken_lines(const std::string& help, std::size_t column, std::size_t width);

// Width of the terminal on standard output, limited to readable lines; 100 for other outputs.
[[nodiscard]] std::size_t help_width();

}  // namespace ifog::tools
