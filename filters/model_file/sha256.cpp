// SPDX-License-Identifier: Apache-2.0
#include "filters/model_file/sha256.h"

#include <glib.h>

namespace ifog {

std::string sha256_hex(std::string_view bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.hex();
}

Sha256::Sha256() : checksum_(g_checksum_new(G_CHECKSUM_SHA256)) {}

void Sha256::Free::operator()(_GChecksum* checksum) const { g_checksum_free(checksum); }

void Sha256::add(std::string_view bytes) {
  // A negative gssize would mean a zero-terminated string.
  if (!bytes.empty())
    g_checksum_update(checksum_.get(), reinterpret_cast<const guchar*>(bytes.data()),
                      static_cast<gssize>(bytes.size()));
}

std::string Sha256::hex() const { return g_checksum_get_string(checksum_.get()); }

}  // namespace ifog
