// SPDX-License-Identifier: Apache-2.0
// Building blocks of a page; empty ones are omitted.
#pragma once

#include <string>
#include <vector>

#include "tools/report/picture.h"

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

// A cell of a table, HTML. `number`: right-aligned; `better`: also coloured.
struct Cell {
  enum class Kind { text, number, better };
  Cell(std::string text, Kind its = Kind::text) : html(std::move(text)), kind(its) {}
  Cell(const char* text) : html(text) {}
  [[nodiscard]] std::string style() const {
    return kind == Kind::text ? "" : kind == Kind::number ? " class=\"n\"" : " class=\"n better\"";
  }
  std::string html;
  Kind kind = Kind::text;
};
inline Cell number_cell(std::string html) { return {std::move(html), Cell::Kind::number}; }

inline std::string row(const std::string& head, const std::vector<Cell>& cells) {
  std::string out = "<tr><th scope=\"row\">" + head + "</th>";
  for (const Cell& cell : cells) out += "<td" + cell.style() + ">" + cell.html + "</td>";
  return out + "</tr>\n";
}

// style: of the table; may be "".
inline std::string table(const std::string& caption, const std::vector<Cell>& heads, const std::string& rows,
                         const std::string& style = "") {
  if (rows.empty()) return "";
  std::string out = "<div class=\"scroll\"><table" + (style.empty() ? "" : " class=\"" + style + "\"") +
                    "><caption>" + caption + "</caption><thead><tr>";
  for (const Cell& head : heads) out += "<th scope=\"col\"" + head.style() + ">" + head.html + "</th>";
  return out + "</tr></thead><tbody>\n" + rows + "</tbody></table></div>\n";
}

// The page with its style and script around the sections. All arguments are HTML except the script.
inline std::string whole_page(const std::string& title, const std::string& subtitle, const std::string& body,
                              const std::string& footer) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light "
         "dark\">\n<link rel=\"icon\" href=\"data:,\">\n<title>" +
         title + "</title>\n<style>" + page_style() + "</style>\n</head>\n<body>\n<main>\n<h1>" + title +
         "</h1>\n<p class=\"sub\">" + subtitle + "</p>\n" + body + "<footer>" + footer +
         "</footer>\n</main>\n<script>" + page_script() + "</script>\n</body>\n</html>\n";
}

}  // namespace ifog::report
