// SPDX-License-Identifier: Apache-2.0
// The look of the report and of its charts, from page.css, chart.css and page.js: inside the page, and inside each picture.
#pragma once

#include <string>

namespace ifog::report {

std::string page_style();     // light, dark and print
std::string page_script();    // values under the pointer, without its element
std::string picture_style();  // the charts alone, in colours on white, without CSS variables

}  // namespace ifog::report
