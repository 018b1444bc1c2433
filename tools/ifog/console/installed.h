// SPDX-License-Identifier: Apache-2.0
// Where the service has its files.
#pragma once

namespace ifog::tools {

inline constexpr const char* kServiceConfig = "/etc/ifogd/ifogd.toml";
inline constexpr const char* kServiceState = "/var/lib/ifogd";

}  // namespace ifog::tools
