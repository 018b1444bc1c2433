// SPDX-License-Identifier: Apache-2.0
#include "filters/model_file/sha256.h"

#include <glib.h>

#include <memory>

namespace ifog {

std::string sha256_hex(std::string_view bytes) {
  const auto* data = reinterpret_cast<const guchar*>(bytes.data());
  const std::unique_ptr<gchar, decltype(&g_free)> hex(
      g_compute_checksum_for_data(G_CHECKSUM_SHA256,
                                  bytes.empty() ? reinterpret_cast<const guchar*>("") : data, bytes.size()),
      &g_free);
  return hex.get();
}

}  // namespace ifog
