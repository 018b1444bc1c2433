// SPDX-License-Identifier: Apache-2.0
// --help as a person reads it.
#pragma once

#include <cstddef>
#include <string>

namespace ifog::tools {

// What the parser has laid out in two columns, the second of which begins at `column`: its lines broken
// between words to be no wider than `width`, and never two empty ones together. Examples to be copied stay
// whole.
[[nodiscard]] std::string broken_lines(const std::string& help, std::size_t column, std::size_t width);

// Columns of the terminal that standard output is, within what reads well; 100 for any other output.
[[nodiscard]] std::size_t help_width();

}  // namespace ifog::tools
