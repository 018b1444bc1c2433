// SPDX-License-Identifier: Apache-2.0
// One chart as SVG: crisp at any size, coloured by the style of the page or picture it stands in, readable by
// a screen reader (title and description). Nothing is fetched.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/report/scale.h"

namespace ifog::report {

// What a curve is; the style gives each a colour, and a stroke by which it is known without colour.
enum class Role { kBefore, kAfter, kFit, kSecond, kRaw, kThird, kFourth };

// The role of one of several curves of a kind, by its place.
Role role_of(std::size_t index);

class Chart {
 public:
  // title names the picture, description says in words what it shows.
  Chart(std::string title, std::string description, ChartAxis x, ChartAxis y);

  // x ascending. Where there are more points than pixels the stroke covers the extremes of each pixel column.
  void line(Role role, const std::string& label, std::vector<double> x, std::vector<double> y);
  // For samples in time: open where there is a hole, and nothing was measured.
  void line_in_time(Role role, const std::string& label, std::vector<double> time, std::vector<double> y);
  void points(Role role, const std::string& label, std::vector<double> x, std::vector<double> y);
  void band(Role role, std::vector<double> x, std::vector<double> low, std::vector<double> high);
  // A thin pale curve, never dashed as some of the data is, that is no data and does not widen the axes.
  void guide(Role role, std::vector<double> x, std::vector<double> y);
  void mark_x(double x, const std::string& label);  // a vertical rule

  [[nodiscard]] bool empty() const;  // nothing finite to draw
  // For a page, with its numbers for that page's script: as wide as that, and once more for a telephone,
  // whose style shows one of them. Both have letters of one size.
  [[nodiscard]] std::string svg(double width = 720, double height = 320) const;

  // For a picture of several: the width that the numbers and the label of the y axis want, and the drawing
  // without the element around it, under a heading, the frame `left` from its edge.
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
