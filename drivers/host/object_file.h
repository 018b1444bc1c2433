// SPDX-License-Identifier: Apache-2.0
// Checks a shared object before dlopen(), which maps what the headers promise and gets SIGBUS beyond the
// file's end.
#pragma once

#include <string>

namespace ifog {

// "" or the reason, in one line without the path. Files that are not ELF of this word length pass, as the
// linker reports them.
std::string object_flaw(const std::string& path);

}  // namespace ifog
