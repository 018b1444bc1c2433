// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/version_text.h"

#include "drivers/flight/header.h"
#include "drivers/ifog/driver.h"
#include "filters/model_file/model.h"

namespace ifog {

std::string version_text(const std::string& program) {
#if defined(__clang__)
  const std::string compiler = __VERSION__;  // it names itself
#else
  const std::string compiler = "GCC " __VERSION__;
#endif
#if defined(__x86_64__)
  const char* const machine = "x86-64";
#elif defined(__aarch64__)
  const char* const machine = "aarch64";
#else
  const char* const machine = "another machine";
#endif
  return program + " " IFOG_VERSION " (driver interface " + std::to_string(IFOG_DRIVER_ABI) +
         ")\nmodel files of version " + std::to_string(Model::kVersion) + ", flight recordings of version " +
         std::to_string(kFlightVersion) + "\nbuilt by " + compiler + " for " + machine;
}

}  // namespace ifog
