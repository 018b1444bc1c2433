// SPDX-License-Identifier: Apache-2.0
// Checks if LCM can use a URL. LCM itself prints its manual if it cannot, and uses defaults for options it
// does not understand.
#pragma once

#include <string>

namespace ifog {

// "" or what was expected. tcpq://, memq://, file:// and mpudpm:// are left to LCM.
std::string lcm_url_complaint(const std::string& url);

}  // namespace ifog
