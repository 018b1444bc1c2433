// Whole text files, plain or gzip by their first bytes. Reading gives the text; writing is all or nothing.
#pragma once

#include <string>
#include <string_view>

namespace ifog {

// Throws std::runtime_error: missing, unreadable, or a gzip stream that ends early or is damaged.
std::string read_text_file(const std::string& path);

// Compresses when the name ends in .gz. Writes beside the target, fsyncs, renames; "/dev/stdout" and FIFOs
// are written in place.
void write_text_file(const std::string& path, std::string_view text);

}  // namespace ifog
