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

}  // namespace ifog::tools
