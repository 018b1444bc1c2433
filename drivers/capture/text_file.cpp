// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/text_file.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <vector>

#include "drivers/capture/output_file.h"

namespace ifog {
namespace {

std::string compressed(std::string_view text) {
  z_stream stream{};
  // 16 + 15: a gzip wrapper with the largest window.
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 16 + 15, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib: cannot start compression");
  std::string out;
  std::vector<unsigned char> block(1U << 16U);
  std::size_t fed = 0;
  int result = Z_OK;
  while (result != Z_STREAM_END) {
    if (stream.avail_in == 0 && fed < text.size()) {
      const std::size_t n = std::min<std::size_t>(text.size() - fed, std::numeric_limits<uInt>::max() / 2);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data() + fed));
      stream.avail_in = static_cast<uInt>(n);
      fed += n;
    }
    stream.next_out = block.data();
    stream.avail_out = static_cast<uInt>(block.size());
    result = deflate(&stream, fed == text.size() ? Z_FINISH : Z_NO_FLUSH);
    out.append(reinterpret_cast<const char*>(block.data()), block.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  return out;
}

}  // namespace

std::string read_text_file(const std::string& path) { return InputFile(path).text(); }

std::string read_bytes_file(const std::string& path) { return InputFile(path).bytes(); }

void write_text_file(const std::string& path, std::string_view text) {
  path.ends_with(".gz") ? write_file(path, compressed(text)) : write_file(path, text);
}

}  // namespace ifog
