// SPDX-License-Identifier: Apache-2.0
// The samples that a driver makes of bytes, and what it says of settings that it refuses.
#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/host/driver_instance.h"
#include "tests/unit/refusal.h"

namespace ifog {

inline std::vector<ifog_sample> decoded(DriverInstance& driver, std::span<const std::uint8_t> bytes,
                                        std::int64_t arrival_ns = 42, std::size_t portion = 0) {
  std::vector<ifog_sample> samples;
  const std::size_t step = portion == 0 ? std::max<std::size_t>(bytes.size(), 1) : portion;
  for (std::size_t at = 0; at < bytes.size(); at += step)
    driver.decode_bytes(bytes.subspan(at, std::min(step, bytes.size() - at)), arrival_ns,
                        [&](const ifog_sample& sample) { samples.push_back(sample); });
  return samples;
}

inline std::string refusal(const std::string& driver, const DriverSettings& settings,
                           const std::vector<std::string>& folders = plugin_folders()) {
  return test::refusal([&] { make_driver(driver, settings, folders); });
}

}  // namespace ifog
