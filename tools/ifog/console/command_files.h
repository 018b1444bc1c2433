// SPDX-License-Identifier: Apache-2.0
// The files of one run, all that it reads and all that it writes, in one table: a file that is written is
// none of the others, by whatever name, so that no output destroys another or what it was made of.
#pragma once

#include <string>

namespace ifog::tools {

// For each option or argument that names a file, before anything is written; "" is none. Throw
// CLI::ValidationError (usage) that names both options where two of the run's files are one regular file, by
// device and inode, and one of them is written. Devices and pipes may stand any number of times. Of a folder
// that is read its flight recordings count.
void will_read(const std::string& option, const std::string& path);

// "-" is standard output: from then on people read standard error. Throws likewise when a second output wants
// it, too. Before the first say().
void will_write(const std::string& option, const std::string& path);

// The ending of a file's name says what is written into it: with one that is not `known` nothing is. Throws
// CLI::ValidationError with the endings that were `expected`. A name without an ending, a device, a pipe and
// standard output say nothing.
void expect_ending(const std::string& option, const std::string& path, bool known,
                   const std::string& expected);

}  // namespace ifog::tools
