// SPDX-License-Identifier: Apache-2.0
// Whole files, plain or gzip by their first bytes. Reading gives the content; writing is all or nothing.
#pragma once

#include <string>
#include <string_view>

#include "drivers/capture/input_file.h"

namespace ifog {

// InputFile's text() and bytes(); "-" is standard input.
std::string read_text_file(const std::string& path);
std::string read_bytes_file(const std::string& path);

// Compresses when the name ends in .gz; "-" is standard output. Throws as OutputFile does.
void write_text_file(const std::string& path, std::string_view text);

}  // namespace ifog
