// SPDX-License-Identifier: Apache-2.0
// The parts of a page: nothing of what is empty.
#pragma once

#include <string>

namespace ifog::report {

inline std::string section(const std::string& id, const std::string& heading, const std::string& body) {
  if (body.empty()) return "";
  return "<section aria-labelledby=\"" + id + "\">\n<h2 id=\"" + id + "\">" + heading + "</h2>\n" + body +
         "</section>\n";
}

inline std::string figure_html(const std::string& svg, const std::string& caption) {
  if (svg.empty()) return "";
  return "<figure>\n" + svg + "<figcaption>" + caption + "</figcaption>\n</figure>\n";
}

}  // namespace ifog::report
