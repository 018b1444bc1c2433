// SPDX-License-Identifier: Apache-2.0
// Whole files, plain or gzip by their first bytes. Reading gives the content; writing is all or nothing.
#pragma once

#include <string>
#include <string_view>

#include "drivers/capture/files/input_file.h"
#include "drivers/capture/files/output_file.h"

struct gzFile_s;  // zlib's

namespace ifog {

// "-" is standard input.
inline std::string read_whole_file(const std::string& path) { return InputFile(path).bytes(); }

// A text that is written while it is made. Compresses when the name ends in .gz; the bytes are the same
// however the text is cut. "-" is standard output. Throws as OutputFile does.
class TextOutput {
 public:
  explicit TextOutput(const std::string& path);
  ~TextOutput();
  TextOutput(const TextOutput&) = delete;
  TextOutput& operator=(const TextOutput&) = delete;

  void write(std::string_view text);
  // Without it a regular file stays as it was.
  void finish();

 private:
  [[noreturn]] void fail(int error) const;

  std::string path_;
  OutputFile file_;
  gzFile_s* packed_ = nullptr;  // null: as it is
};

// Compresses when the name ends in .gz; "-" is standard output. Throws as OutputFile does.
inline void write_text_file(const std::string& path, std::string_view text) {
  TextOutput file(path);
  file.write(text);
  file.finish();
}

}  // namespace ifog
