// SPDX-License-Identifier: Apache-2.0
// All files that a run reads and writes. A file that is written must differ from all others, so that no
// output destroys an input or another output.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace ifog::tools {

// Called for each option or argument that names a file, before writing (see options/command.h); "" is no
// file. They throw WrongUsage with both options if two files are the same regular file, by device and inode,
// and one is written. Devices and pipes may repeat. A folder stands for its flight recordings.
void will_read(const std::string& option, const std::string& path);

// "-" is standard output; text for people then goes to standard error. Throws WrongUsage if a second output
// uses it, std::runtime_error if it is a folder or cannot be written. Call it before the first say().
// endings: of an output of one format, see expect_no_other_kind(); empty: any.
void will_write(const std::string& option, const std::string& path,
                std::span<const std::string_view> endings = {});

// "wrote a.json, b.svg" for the regular files above, at the end of a run; "" if there are none.
std::string written_in_words();
// For a run that prints nothing.
void forget_written_files();

// Throws WrongUsage if the name's ending belongs to another format, e.g. a page in report.pdf, and names the
// first correct ending.
void expect_no_other_kind(const std::string& option, const std::string& path,
                          std::span<const std::string_view> endings);

// Throws WrongUsage with the `expected` endings unless the ending is `known`. Names without an ending,
// devices, pipes and standard output pass.
void expect_ending(const std::string& option, const std::string& path, bool known,
                   const std::string& expected);

}  // namespace ifog::tools
