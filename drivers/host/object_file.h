// SPDX-License-Identifier: Apache-2.0
// Whether a shared object may be loaded, asked before the dynamic linker is: that one maps what the file's
// headers promise, and the first look at a page behind the file's end is SIGBUS.
#pragma once

#include <string>

namespace ifog {

// "" or why not, one line without the path. What is no ELF file of this machine's word length passes: the
// linker says so itself.
std::string object_flaw(const std::string& path);

}  // namespace ifog
