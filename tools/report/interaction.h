// SPDX-License-Identifier: Apache-2.0
// What a page does under the pointer: values at a place, a closer look at a stretch. A few lines of script in
// the page itself; nothing is fetched, and without it the page shows the same pictures.
#pragma once

#include <string>

namespace ifog::report {

// The script, without its element. Works on every chart that carries data-plot, see Chart::svg.
std::string page_script();

}  // namespace ifog::report
