// SPDX-License-Identifier: Apache-2.0
// Unnamed files mapped into memory. The kernel may evict their pages. A thread also releases pages when more
// than kMostResident bytes are resident; they remain in the page cache or are read again from the file.
#pragma once

#include <cstddef>
#include <optional>

#include "drivers/system/unnamed_file.h"

namespace ifog {

inline constexpr std::size_t kMostResident = std::size_t{128} << 20U;  // bytes

// Largest number of released files kept for reuse.
inline constexpr std::size_t kMostSpare = 4;

// New file of this size, with arbitrary content, mapped for reading and writing. Disk space is allocated at
// once, so later writes cannot fail. Throws std::runtime_error with one line.
[[nodiscard]] void* map_new_file(std::size_t bytes);
// Releases a mapping from map_new_file().
void unmap_new_file(void* at, std::size_t bytes) noexcept;
// A released file of half to twice this size, for a user that writes sequentially and reads only what it
// wrote. Its pages are already allocated. nullopt if there is none.
[[nodiscard]] std::optional<UnnamedFile> take_spare_file(std::size_t bytes) noexcept;
// memcpy to memory from map_new_file(), by writing to the file, because a page fault costs ten times as much.
// Throws likewise.
void write_new_file(void* to, const void* from, std::size_t bytes);
// The same for reading from such memory.
void read_new_file(void* to, const void* from, std::size_t bytes);
// Maps the first bytes of an existing file for reading; the file may be closed afterwards. Throws likewise.
[[nodiscard]] const void* map_file(const UnnamedFile& file, std::size_t bytes);
// Releases a mapping from map_file().
void unmap_file(const void* at, std::size_t bytes) noexcept;
// Prefetches the pages of mapped memory; no effect on other memory.
void expect_reading(const void* at, std::size_t bytes) noexcept;

}  // namespace ifog
