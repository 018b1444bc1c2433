// SPDX-License-Identifier: Apache-2.0
// The look of the report and of its charts: one style sheet inside the page, one inside each picture.
#pragma once

#include <string>

namespace ifog::report {

std::string page_style();     // light, dark and print
std::string picture_style();  // the charts alone, in colours on white, without CSS variables

}  // namespace ifog::report
