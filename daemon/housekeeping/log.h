// SPDX-License-Identifier: Apache-2.0
// Where the log goes: to the journal with fields of its own when systemd runs us, else to the standard error.
// Only housekeeping logs; the pipelines' threads report events.
#pragma once

#include <spdlog/logger.h>

#include <memory>
#include <string>

namespace ifog {

// One sink for all; level: debug | info | warning | error.
void set_up_log(const std::string& level);
// `sensor` goes before each line, and into the journal's field IFOG_SENSOR; "" for the daemon itself.
std::shared_ptr<spdlog::logger> make_log(const std::string& sensor);

}  // namespace ifog
