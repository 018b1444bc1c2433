// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/interrupt.h"

#include <csignal>

namespace ifog::tools {
namespace {

volatile std::sig_atomic_t caught = 0;

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { caught = 1; };
  // No SA_RESTART, so that a blocking call returns. SA_RESETHAND, so that a second signal ends the program.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = SIG_IGN;
  action.sa_flags = 0;
  sigaction(SIGPIPE, &action, nullptr);
}

bool interrupted() noexcept { return caught != 0; }

}  // namespace ifog::tools
