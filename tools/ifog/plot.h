// Pictures by gnuplot, through a pipe. The ending of the path (.svg or .png) picks the terminal.
#pragma once

#include <string>
#include <vector>

namespace ifog::tools {

struct Curve {
  std::string title;
  std::vector<double> x, y;
  std::vector<double> low, high;  // a band around y; both empty or both as long as x
  std::string style = "lines";    // gnuplot's: lines, points, dots, …
  std::string color;              // "#rrggbb", or gnuplot's choice when empty
};

struct Panel {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Curve> curves;
  std::vector<std::string> extra;  // gnuplot commands before this panel's plot: labels, ranges
};

// One panel below the other. Throws std::runtime_error: unknown ending, gnuplot missing or failed (with its
// message).
void plot(const std::string& path, const std::vector<Panel>& panels, int width = 1000, int height_each = 420);

}  // namespace ifog::tools
