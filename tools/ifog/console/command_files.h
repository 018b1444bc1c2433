// SPDX-License-Identifier: Apache-2.0
// The files of one run, all that it reads and all that it writes, in one table: a file that is written is
// none of the others, by whatever name, so that no output destroys another or what it was made of.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace ifog::tools {

// For each option or argument that names a file, before anything is written; "" is none. Throw
// WrongUsage (usage) that names both options where two of the run's files are one regular file, by
// device and inode, and one of them is written. Devices and pipes may stand any number of times. Of a folder
// that is read its flight recordings count.
void will_read(const std::string& option, const std::string& path);

// "-" is standard output: from then on people read standard error. Throws likewise when a second output wants
// it, too, and std::runtime_error where it cannot be written at all: a folder, no such folder, no permission.
// Before the first say().
void will_write(const std::string& option, const std::string& path);
// The same of an output that has one format, with expect_no_other_kind().
void will_write(const std::string& option, const std::string& path,
                std::span<const std::string_view> endings);

// "wrote a.json, b.svg" of the regular files above, for the end of a run; "": there are none.
std::string written_in_words();
// For a run that is to say nothing.
void forget_what_is_written();

inline constexpr auto kJsonEndings = std::to_array<std::string_view>({".json", ".jsonl", ".ndjson"});
inline constexpr auto kModelEndings = std::to_array<std::string_view>({".toml"});
inline constexpr auto kPageEndings = std::to_array<std::string_view>({".html", ".htm"});
inline constexpr auto kFrameEndings = std::to_array<std::string_view>({".log", ".candump", ".txt"});
inline constexpr auto kByteEndings =
    std::to_array<std::string_view>({".bin", ".kvh", ".raw", ".dat", ".txt"});

// What is written is of one kind, whatever its file is called: a name that is known to say another (a page in
// report.pdf) is refused with the first of the kind's own endings. Throws WrongUsage.
void expect_no_other_kind(const std::string& option, const std::string& path,
                          std::span<const std::string_view> endings);

// The ending of a file's name chooses its format; a file with an ending that is not `known` is not written.
// Throws WrongUsage with the endings that were `expected`. A name without an ending, a device, a
// pipe and standard output say nothing.
void expect_ending(const std::string& option, const std::string& path, bool known,
                   const std::string& expected);

}  // namespace ifog::tools
