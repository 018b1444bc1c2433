// SPDX-License-Identifier: Apache-2.0
// Log: the journal with additional fields under systemd, else standard error. Only housekeeping logs; other
// threads report events.
#pragma once

#include <spdlog/logger.h>

#include <memory>
#include <string>

namespace ifog {

// One sink for all; level: debug | info | warning | error.
void set_up_log(const std::string& level);
// sensor: prefix of each line, and the journal's field IFOG_SENSOR; "" for the daemon.
std::shared_ptr<spdlog::logger> make_log(const std::string& sensor);

}  // namespace ifog
