// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4) for naming files by their content. Not for secrets.
#pragma once

#include <memory>
#include <string>
#include <string_view>

struct _GChecksum;  // GLib's NOLINT(bugprone-reserved-identifier)

namespace ifog {

[[nodiscard]] std::string sha256_hex(std::string_view bytes);  // 64 lower-case hex digits

// Incremental SHA-256.
class Sha256 {
 public:
  Sha256();
  void add(std::string_view bytes);
  [[nodiscard]] std::string hex() const;  // of all bytes so far; ends the computation

 private:
  struct Free {
    void operator()(_GChecksum* checksum) const;
  };
  std::unique_ptr<_GChecksum, Free> checksum_;
};

}  // namespace ifog
