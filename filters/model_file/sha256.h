// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4), for naming files by their content. Not for secrets.
#pragma once

#include <string>
#include <string_view>

namespace ifog {

[[nodiscard]] std::string sha256_hex(std::string_view bytes);  // 64 lower-case hex digits

}  // namespace ifog
