// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/files/text_file.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "drivers/capture/files/name_ending.h"

namespace ifog {
TextOutput::TextOutput(const std::string& path) : file_(path) {
  if (!is_packed_name(path)) return;
  auto stream = std::make_unique<z_stream_s>();
  // 16 + 15: a gzip wrapper with the largest window.
  if (deflateInit2(stream.get(), Z_DEFAULT_COMPRESSION, Z_DEFLATED, 16 + 15, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib: cannot start compression");
  stream_ = std::move(stream);
  block_.resize(1U << 16U);
}

TextOutput::~TextOutput() {
  if (stream_) deflateEnd(stream_.get());
}

void TextOutput::write(std::string_view text) {
  if (!stream_) return file_.write(text);
  constexpr std::size_t kMost = std::numeric_limits<uInt>::max() / 2;
  for (; !text.empty(); text.remove_prefix(std::min(kMost, text.size())))
    deflate(text.substr(0, kMost), false);
}

void TextOutput::finish() {
  if (stream_) deflate({}, true);
  file_.finish();
}

void TextOutput::deflate(std::string_view text, bool last) {
  stream_->next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream_->avail_in = static_cast<uInt>(text.size());
  do {
    stream_->next_out = block_.data();
    stream_->avail_out = static_cast<uInt>(block_.size());
    ::deflate(stream_.get(), last ? Z_FINISH : Z_NO_FLUSH);
    file_.write({reinterpret_cast<const char*>(block_.data()), block_.size() - stream_->avail_out});
  } while (stream_->avail_out == 0);
}

}  // namespace ifog
