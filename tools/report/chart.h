// SPDX-License-Identifier: Apache-2.0
// One chart as SVG. The page's or picture's style sets the colours; title and description are for screen
// readers. It loads no other resource.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/report/scale.h"

namespace ifog::report {

// Kind of a curve; the style gives each a colour, and a stroke for readers without colour.
enum class Role { kBefore, kAfter, kFit, kSecond, kRaw, kThird, kFourth };

// Role of the index-th of several similar curves.
Role role_of(std::size_t index);

class Chart {
 public:
  // title: of the picture; description: its content in words.
  Chart(std::string title, std::string description, ChartAxis x, ChartAxis y);

  // x ascending. With more points than pixels, each pixel column shows minimum and maximum.
  void line(Role role, const std::string& label, std::vector<double> x, std::vector<double> y);
  // For samples over time: interrupted at gaps.
  void line_in_time(Role role, const std::string& label, std::vector<double> time, std::vector<double> y);
  void points(Role role, const std::string& label, std::vector<double> x, std::vector<double> y);
  void band(Role role, std::vector<double> x, std::vector<double> low, std::vector<double> high);
  // A thin pale line that is not data and does not extend the axes; never dashed.
  void guide(Role role, std::vector<double> x, std::vector<double> y);
  void mark_x(double x, const std::string& label);  // a vertical line

  [[nodiscard]] bool empty() const;  // true if there are no finite values
  // For a page, with the data for its script: at full width and again for a phone; the style shows one. Both
  // have the same font size.
  [[nodiscard]] std::string svg(double width = 720, double height = 320) const;

  // For a picture of several charts: the margin that numbers and label of the y axis need, and the drawing
  // under a heading, without the outer element and with its frame at `left`.
  [[nodiscard]] double left_margin(double height) const;
  [[nodiscard]] std::string panel(double width, double height, double left) const;

 private:
  enum class Kind { line, points, band, guide };
  struct Series {
    Kind kind;
    Role role;
    std::string label;
    std::vector<double> x, y;
    std::vector<double> high;  // of a band

    // Its classes in the style sheet.
    [[nodiscard]] std::string style(const char* more = "") const;
  };
  struct Frame {
    double left, right, top, bottom;
  };
  struct Legend {
    std::string svg;
    double rows = 0.0;
  };
  [[nodiscard]] Bounds bounds(bool of_x) const;
  [[nodiscard]] Legend legend(double left, double right, double top) const;
  [[nodiscard]] std::string axes(const Frame& f, const Scale& sx, const Scale& sy, double height) const;
  [[nodiscard]] std::string curves(const Frame& f, const Scale& sx, const Scale& sy) const;
  [[nodiscard]] Frame frame(double width, double height, double left, bool headed, const Legend& key) const;
  [[nodiscard]] std::string drawing(double width, double height, double left, bool headed) const;
  [[nodiscard]] std::string plot_data(const Frame& f) const;
  [[nodiscard]] std::string element(const std::string& style, double width, double height,
                                    bool with_numbers) const;

  std::string title_, description_;
  ChartAxis x_, y_;
  std::vector<Series> series_;
  std::vector<std::pair<double, std::string>> marks_;
};

}  // namespace ifog::report
