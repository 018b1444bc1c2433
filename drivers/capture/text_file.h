// Whole files, plain or gzip by their first bytes. Reading gives the content; writing is all or nothing.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace ifog {

// No line of a text that people or instruments write comes near it.
inline constexpr std::size_t kLongestLine = 1U << 20U;

// Throw std::runtime_error: missing, unreadable, a gzip stream that ends early or is damaged, or one that
// grows beyond 256 MiB and 100 times its size, which no recording does: it would fill the memory. A text's
// line longer than kLongestLine is refused with its number.
std::string read_text_file(const std::string& path);
std::string read_bytes_file(const std::string& path);

// Compresses when the name ends in .gz. Writes beside the target, fsyncs, renames; "/dev/stdout" and FIFOs
// are written in place.
void write_text_file(const std::string& path, std::string_view text);

}  // namespace ifog
