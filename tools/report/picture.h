// SPDX-License-Identifier: Apache-2.0
// Style of the report and its charts from page.css, chart.css and page.js, and a picture of several charts as
// SVG or PNG file, for `--plot` of every command.
#pragma once

#include <string>
#include <vector>

#include "tools/report/chart.h"

namespace ifog::report {

struct PictureCell {
  Chart chart;
  double share = 1.0;  // of the row's width
};

struct PictureRow {
  double height;  // px
  std::vector<PictureCell> cells;
};

// Rows from top to bottom with aligned columns. An empty chart leaves its place empty.
std::string picture_svg(const std::string& title, const std::vector<PictureRow>& rows, double width = 1000.0);

// "" or the error: a picture's name must end in .svg or .png, or be "-" (SVG).
std::string wrong_picture_name(const std::string& path);

// Format by the name's ending; PNG with two dots per pixel. Throws std::runtime_error with one line.
void write_picture(const std::string& path, const std::string& svg);

std::string page_style();     // light mode, dark mode and print
std::string page_script();    // shows values under the pointer; without the script element
std::string picture_style();  // charts only, in colours on white, without CSS variables

}  // namespace ifog::report
