// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/version_text.h"

#include "drivers/flight/header.h"
#include "drivers/ifog/driver.h"
#include "filters/model_file/model.h"

namespace ifog {
namespace {

constexpr const char* kCompiler =
#if defined(__clang__)
    __VERSION__;  // contains the compiler's name
#else
    "GCC " __VERSION__;
#endif

constexpr const char* kMachine =
#if defined(__x86_64__)
    "x86-64";
#elif defined(__aarch64__)
    "aarch64";
#else
        "another machine";
#endif

}  // namespace

std::string version_text(const std::string& program) {
  return program + " " IFOG_VERSION " (driver interface " + std::to_string(IFOG_DRIVER_ABI) +
         ")\nmodel files of version " + std::to_string(Model::kVersion) + ", flight recordings of version " +
         std::to_string(kFlightVersion) + "\nbuilt by " + kCompiler + " for " + kMachine;
}

}  // namespace ifog
