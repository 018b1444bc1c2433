#include "drivers/plugins/kvh1750/frame_finder.h"

#include <algorithm>
#include <cstring>

namespace ifog::kvh {

std::size_t FrameFinder::take(std::span<const std::uint8_t> bytes) noexcept {
  // next() leaves less than one frame behind, so there is always room after this.
  if (kBuffer - end_ < bytes.size() && begin_ != 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  const std::size_t n = std::min(kBuffer - end_, bytes.size());
  std::memcpy(buffer_.data() + end_, bytes.data(), n);
  end_ += n;
  return n;
}

bool FrameFinder::next(Frame& frame) noexcept {
  for (; end_ - begin_ >= kHeaderLength; ++begin_, ++counters_.bytes_skipped) {
    const std::span<const std::uint8_t> rest(buffer_.data() + begin_, end_ - begin_);
    const std::optional<Format> format = header_at(rest);
    if (!format) continue;
    const std::size_t length = length_of(*format);
    if (rest.size() < length) return false;
    if (!crc_fits(rest.first(length))) {
      ++counters_.crc_failed;
      continue;
    }
    frame = unpack(*format, rest.first(length));
    begin_ += length;
    counters_.bytes_framed += length;
    ++counters_.intact;
    return true;
  }
  return false;
}

void FrameFinder::reset() noexcept {
  counters_.bytes_skipped += waiting();
  begin_ = end_ = 0;
}

}  // namespace ifog::kvh
