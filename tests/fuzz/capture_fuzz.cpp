// Any bytes as a capture file, plain or gzip: refused with one line, or read with columns of one length and
// time that goes on.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "drivers/capture/capture.h"

namespace {

// A file in memory under a path, because that is how captures are read.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : fd_(memfd_create("capture", MFD_CLOEXEC)) {
    if (fd_ < 0 || write(fd_, data, size) != static_cast<ssize_t>(size)) std::abort();
  }
  ~MemoryFile() { close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
  ifog::Capture capture;
  try {
    capture = ifog::read_capture(file.path());
  } catch (const std::runtime_error&) {
    return 0;
  }
  if (capture.size() == 0 || capture.axes.empty() || capture.rate_radps.size() != capture.axes.size() ||
      capture.reference_rate_radps.size() != capture.axes.size())
    std::abort();
  for (const auto& rate : capture.rate_radps)
    if (rate.size() != capture.size()) std::abort();
  for (const auto& channel : capture.channels)
    if (channel.values.size() != capture.size()) std::abort();
  for (std::size_t i = 0; i < capture.size(); ++i)
    if (std::isnan(capture.time_s[i]) || (i != 0 && capture.time_s[i] <= capture.time_s[i - 1])) std::abort();
  return 0;
}
