// SPDX-License-Identifier: Apache-2.0
// Files without a name that are mapped into memory. What of them is in memory is the kernel's to take away
// again; so that it also counts little where nobody else wants it, a thread gives pages back when more than
// kMostResident of the files are in the program's memory at once. They stay in the kernel's cache while
// there is room in it, and are read again from the file where not.
#pragma once

#include <cstddef>
#include <optional>

#include "drivers/system/unnamed_file.h"

namespace ifog {

inline constexpr std::size_t kMostResident = std::size_t{128} << 20U;  // bytes

// Files that were given back and wait for the next that asks for as much.
inline constexpr std::size_t kMostSpare = 4;

// A file of so many bytes, whatever is in them, to read and write. Its room is taken at once, so that no
// later write finds the disk full. Throws std::runtime_error with one line.
[[nodiscard]] void* map_new_file(std::size_t bytes);
// What that gave.
void unmap_new_file(void* at, std::size_t bytes) noexcept;
// A waiting file, half to twice as long, for a user that writes from its beginning and reads only what it
// wrote: its pages are there already. None: none such waits.
[[nodiscard]] std::optional<UnnamedFile> take_spare_file(std::size_t bytes) noexcept;
// As memcpy, `to` being in memory that map_new_file() gave: by way of the file, for writing a page that is
// not in memory costs ten times as much when it is found missing. Throws likewise.
void write_new_file(void* to, const void* from, std::size_t bytes);
// Likewise, `from` being in such memory.
void read_new_file(void* to, const void* from, std::size_t bytes);
// The first bytes of an existing file, to read. The file may be closed afterwards. Throws likewise.
[[nodiscard]] const void* map_file(const UnnamedFile& file, std::size_t bytes);
// What that gave.
void unmap_file(const void* at, std::size_t bytes) noexcept;
// Memory of a file that is about to be read: its pages are looked up together. Of other memory nothing.
void expect_reading(const void* at, std::size_t bytes) noexcept;

}  // namespace ifog
