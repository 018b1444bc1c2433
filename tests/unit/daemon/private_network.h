// SPDX-License-Identifier: Apache-2.0
// LCM is multicast: a test that uses it moves into a network namespace of its own, so that nothing leaves the
// machine.
#pragma once

#include "tests/unit/test.h"

namespace ifog {

// Moves the process there, loopback up and multicast routed to it, as
// `ip link set lo up multicast on; ip route add 224.0.0.0/4 dev lo`. "" or why it could not.
std::string enter_private_network();

}  // namespace ifog
