#include "drivers/capture/text_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

std::string reason() { return std::generic_category().message(errno); }

struct GzClose {
  void operator()(gzFile_s* file) const { gzclose(file); }
};

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

// A gzip file's content is held to this many times its size, beyond what any memory has room for.
constexpr std::size_t kMostGrowth = 100;
constexpr std::size_t kGrowthFree = 256U << 20U;

// Follows where the last line begins, block by block: no second look at each byte.
class LineLength {
 public:
  // Of text, whose last n bytes are new. Throws when a line is too long, also one without its end so far.
  void check(const std::string& path, std::string_view text, std::size_t n) {
    const std::size_t from = text.size() - n;
    const std::size_t first = std::min(text.find('\n', from), text.size());
    if (first - line_ > kLongestLine) refuse(path, text);
    const std::size_t last = text.rfind('\n');
    if (last != std::string_view::npos && last >= from) line_ = last + 1;
    if (text.size() - line_ > kLongestLine) refuse(path, text);
  }

 private:
  [[noreturn]] void refuse(const std::string& path, std::string_view text) const {
    const auto number = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(line_), '\n') + 1;
    throw std::runtime_error(path + ":" + std::to_string(number) + ": a line of more than " +
                             std::to_string(kLongestLine) + " bytes, begins " +
                             in_quotes(text.substr(line_, kLongestQuote)));
  }
  std::size_t line_ = 0;
};

std::string content(const std::string& path, bool has_lines) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) throw std::runtime_error(path + ": cannot open: " + reason());
  if (S_ISDIR(info.st_mode)) throw std::runtime_error(path + ": is a folder, expected a file");
  const std::unique_ptr<gzFile_s, GzClose> file(gzopen(path.c_str(), "rbe"));
  if (!file) throw std::runtime_error(path + ": cannot open: " + reason());
  gzbuffer(file.get(), 1U << 18U);
  const bool packed = S_ISREG(info.st_mode) && gzdirect(file.get()) == 0;
  const std::size_t most =
      packed ? std::max(kGrowthFree, static_cast<std::size_t>(info.st_size) * kMostGrowth) : SIZE_MAX;
  std::string text;
  LineLength lines;
  // No larger than a line may be: then only lines that cross the end of a block can be too long.
  std::vector<char> block(kLongestLine);
  for (;;) {
    const int n = gzread(file.get(), block.data(), static_cast<unsigned>(block.size()));
    if (n > 0) {
      text.append(block.data(), static_cast<std::size_t>(n));
      if (has_lines) lines.check(path, text, static_cast<std::size_t>(n));
    }
    if (text.size() > most)
      throw std::runtime_error(path + ": grows to more than " + std::to_string(most >> 20U) + " MiB, " +
                               std::to_string(kMostGrowth) +
                               " times its size, when unpacked, expected a recording");
    if (n == static_cast<int>(block.size())) continue;
    // gzread also returns short at a truncated stream, and says so only through gzerror.
    int error = Z_OK;
    const char* message = gzerror(file.get(), &error);
    if (error != Z_OK && error != Z_STREAM_END)
      throw std::runtime_error(path + ": cannot read: " +
                               (error == Z_BUF_ERROR ? "the gzip stream ends early (truncated file)"
                                : error == Z_ERRNO   ? reason()
                                                     : std::string(message)));
    return text;
  }
}

}  // namespace

std::string read_text_file(const std::string& path) { return content(path, true); }

std::string read_bytes_file(const std::string& path) { return content(path, false); }

void write_text_file(const std::string& path, std::string_view text) {
  std::string packed;
  if (path.ends_with(".gz")) {
    packed = compressed(text);
    text = packed;
  }
  struct stat info {};
  const bool in_place = stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode);
  const std::string target = in_place ? path : path + ".partial." + std::to_string(getpid());
  const int fd =
      open(target.c_str(), in_place ? O_WRONLY | O_CLOEXEC : O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) throw std::runtime_error(path + ": cannot create: " + reason());
  const auto fail = [&](const char* what) {
    const std::string why = reason();
    close(fd);
    if (!in_place) unlink(target.c_str());
    throw std::runtime_error(path + ": cannot " + what + ": " + why);
  };
  while (!text.empty()) {
    const ssize_t n = write(fd, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("write");
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  if (!in_place && fsync(fd) != 0) fail("sync");
  close(fd);
  if (!in_place && rename(target.c_str(), path.c_str()) != 0) {
    const std::string why = reason();
    unlink(target.c_str());
    throw std::runtime_error(path + ": cannot rename into place: " + why);
  }
}

}  // namespace ifog
