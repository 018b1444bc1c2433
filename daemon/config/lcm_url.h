// SPDX-License-Identifier: Apache-2.0
// Whether LCM can use a URL. LCM itself prints its own manual where it cannot, and continues with what it takes
// for a default where it does not understand an option.
#pragma once

#include <string>

namespace ifog {

// "" or what was expected. tcpq://, memq://, file:// and mpudpm:// are LCM's to understand.
std::string lcm_url_complaint(const std::string& url);

}  // namespace ifog
