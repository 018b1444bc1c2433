// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/books.h"

#include <spdlog/fmt/fmt.h>

#include <bit>
#include <cstddef>

namespace ifog {
void SharedBooks::write(const ReaderBooks& books) noexcept {
  const auto words = std::bit_cast<Words>(books);
  const std::uint32_t version = version_.load(std::memory_order_relaxed);
  version_.store(version + 1, std::memory_order_relaxed);
  // Release and acquire on each word instead of fences, which ThreadSanitizer does not support: a reader of
  // a new word also sees the odd version.
  for (std::size_t i = 0; i < words.size(); ++i) words_[i].store(words[i], std::memory_order_release);
  version_.store(version + 2, std::memory_order_release);
}

bool SharedBooks::try_read(ReaderBooks& out) const noexcept {
  const std::uint32_t before = version_.load(std::memory_order_acquire);
  Words words;
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = words_[i].load(std::memory_order_acquire);
  out = std::bit_cast<ReaderBooks>(words);
  return before % 2 == 0 && version_.load(std::memory_order_relaxed) == before;
}

ReaderBooks SharedBooks::read() const noexcept {
  ReaderBooks books;
  while (!try_read(books)) {
  }
  return books;
}

std::string imbalance(const ReaderBooks& reader, const FilterBooks& filter) {
  const TransportCounters& line = reader.line;
  const ifog_driver_counters& driver = reader.driver;
  const IncrementerCounts& counts = reader.counts;
  if (line.bytes != driver.bytes_framed + driver.bytes_skipped + driver.bytes_pending)
    return fmt::format("the books do not balance: {} bytes read, {} in frames + {} skipped + {} pending",
                       line.bytes, driver.bytes_framed, driver.bytes_skipped, driver.bytes_pending);
  const bool of_can = line.frames > 0 || driver.frames_other > 0;
  if (of_can && line.frames != driver.frames_good + driver.frames_format + driver.frames_other)
    return fmt::format(
        "the books do not balance: {} CAN frames read, {} decoded + {} refused + {} none of the sensor's",
        line.frames, driver.frames_good, driver.frames_format, driver.frames_other);
  if (reader.decoded != counts.samples + counts.repeated)
    return fmt::format("the books do not balance: {} samples decoded, {} accepted + {} repeated",
                       reader.decoded, counts.samples, counts.repeated);
  if (filter.samples != filter.sent + filter.failed + filter.merged || filter.samples > counts.samples)
    return fmt::format(
        "the books do not balance: {} samples, {} of them filtered: {} sent + {} failed + {} merged",
        counts.samples, filter.samples, filter.sent, filter.failed, filter.merged);
  return "";
}

}  // namespace ifog
