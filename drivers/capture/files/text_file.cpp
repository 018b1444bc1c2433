// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/files/text_file.h"

#include <fcntl.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "drivers/capture/files/file_kind.h"

namespace ifog {

TextOutput::TextOutput(const std::string& path) : path_(path), file_(path) {
  if (!is_packed_name(path)) return;
  packed_ = gzdopen(fcntl(file_.descriptor(), F_DUPFD_CLOEXEC, 3), "wb");
  if (packed_ == nullptr) throw std::runtime_error("zlib: cannot start compression");
}

TextOutput::~TextOutput() {
  if (packed_ != nullptr) gzclose(packed_);
}

void TextOutput::write(std::string_view text) {
  if (packed_ == nullptr) return file_.write(text);
  constexpr std::size_t kMost = 1U << 30U;
  for (; !text.empty(); text.remove_prefix(std::min(kMost, text.size()))) {
    errno = 0;
    if (gzwrite(packed_, text.data(), static_cast<unsigned>(std::min(kMost, text.size()))) <= 0) fail(errno);
  }
}

void TextOutput::finish() {
  errno = 0;
  if (packed_ != nullptr && gzclose(std::exchange(packed_, nullptr)) != Z_OK) fail(errno);
  file_.finish();
}

void TextOutput::fail(int error) const {
  throw std::runtime_error(path_ + ": cannot write: " + std::generic_category().message(error));
}

}  // namespace ifog
