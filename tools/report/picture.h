// SPDX-License-Identifier: Apache-2.0
// A picture of several charts as a file of its own, SVG or PNG: what `--plot` of every command writes.
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

// Rows below each other, the frames of a column in line. Charts that are empty leave their place empty.
std::string picture_svg(const std::string& title, const std::vector<PictureRow>& rows, double width = 1000.0);

// "" or what is wrong with it: the name of a picture ends in .svg or .png, or is "-" (SVG).
std::string wrong_picture_name(const std::string& path);

// By the ending; PNG at two dots a pixel. Throws std::runtime_error with one line.
void write_picture(const std::string& path, const std::string& svg);

}  // namespace ifog::report
