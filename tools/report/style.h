// SPDX-License-Identifier: Apache-2.0
// Style of the report and its charts from page.css, chart.css and page.js.
#pragma once

#include <string>

namespace ifog::report {

std::string page_style();     // light mode, dark mode and print
std::string page_script();    // shows values under the pointer; without the script element
std::string picture_style();  // charts only, in colours on white, without CSS variables

}  // namespace ifog::report
