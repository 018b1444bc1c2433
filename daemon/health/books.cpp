// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/books.h"

#include <spdlog/fmt/fmt.h>

namespace ifog {
namespace {

constexpr std::array kEntries{
    &ReaderBooks::bytes_read,     &ReaderBooks::bytes_framed, &ReaderBooks::bytes_skipped,
    &ReaderBooks::bytes_pending,  &ReaderBooks::frames_read,  &ReaderBooks::frames_good,
    &ReaderBooks::frames_refused, &ReaderBooks::frames_other, &ReaderBooks::decoded,
    &ReaderBooks::samples,        &ReaderBooks::repeated};

}  // namespace

void SharedBooks::write(const ReaderBooks& books) noexcept {
  static_assert(sizeof(ReaderBooks) == kEntries.size() * sizeof(std::uint64_t), "every entry is shared");
  const std::uint32_t version = version_.load(std::memory_order_relaxed);
  version_.store(version + 1, std::memory_order_relaxed);
  // Release and acquire on each entry instead of fences, which ThreadSanitizer does not support: a reader of
  // a new entry also sees the odd version.
  for (std::size_t i = 0; i < kEntries.size(); ++i)
    entries_[i].store(books.*kEntries[i], std::memory_order_release);
  version_.store(version + 2, std::memory_order_release);
}

bool SharedBooks::try_read(ReaderBooks& out) const noexcept {
  const std::uint32_t before = version_.load(std::memory_order_acquire);
  for (std::size_t i = 0; i < kEntries.size(); ++i)
    out.*kEntries[i] = entries_[i].load(std::memory_order_acquire);
  return before % 2 == 0 && version_.load(std::memory_order_relaxed) == before;
}

ReaderBooks SharedBooks::read() const noexcept {
  ReaderBooks books;
  while (!try_read(books)) {
  }
  return books;
}

std::string imbalance(const ReaderBooks& reader, const FilterBooks& filter) {
  if (reader.bytes_read != reader.bytes_framed + reader.bytes_skipped + reader.bytes_pending)
    return fmt::format("the books do not balance: {} bytes read, {} in frames + {} skipped + {} pending",
                       reader.bytes_read, reader.bytes_framed, reader.bytes_skipped, reader.bytes_pending);
  const bool of_can = reader.frames_read > 0 || reader.frames_other > 0;
  if (of_can && reader.frames_read != reader.frames_good + reader.frames_refused + reader.frames_other)
    return fmt::format(
        "the books do not balance: {} CAN frames read, {} decoded + {} refused + {} none of the sensor's",
        reader.frames_read, reader.frames_good, reader.frames_refused, reader.frames_other);
  if (reader.decoded != reader.samples + reader.repeated)
    return fmt::format("the books do not balance: {} samples decoded, {} accepted + {} repeated",
                       reader.decoded, reader.samples, reader.repeated);
  if (filter.samples != filter.sent + filter.failed + filter.merged || filter.samples > reader.samples)
    return fmt::format(
        "the books do not balance: {} samples, {} of them filtered: {} sent + {} failed + {} merged",
        reader.samples, filter.samples, filter.sent, filter.failed, filter.merged);
  return "";
}

}  // namespace ifog
