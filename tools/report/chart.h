// One chart as inline SVG: crisp at any size, coloured by the page's CSS, readable by a screen reader (title
// and description). Nothing is fetched and no script runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace ifog::report {

struct ChartAxis {
  std::string label;
  bool log = false;  // values that are not positive are left out
  std::optional<double> low, high;
};

// What a curve is; the style sheet gives each a colour and a stroke that can be told apart without colour.
enum class Role { kBefore, kAfter, kFit, kSecond };

class Chart {
 public:
  // title names the picture, description says in words what it shows.
  Chart(std::string title, std::string description, ChartAxis x, ChartAxis y);

  // x ascending. Where there are more points than pixels the stroke covers the extremes of each pixel column.
  void line(Role role, const std::string& label, std::vector<double> x, std::vector<double> y);
  void points(Role role, const std::string& label, std::vector<double> x, std::vector<double> y);
  void mark_x(double x, const std::string& label);  // a vertical rule

  [[nodiscard]] bool empty() const;  // nothing finite to draw
  [[nodiscard]] std::string svg(double width = 720, double height = 320) const;

 private:
  struct Series {
    Role role;
    std::string label;
    std::vector<double> x, y;
    bool joined;
  };
  std::string title_, description_;
  ChartAxis x_, y_;
  std::vector<Series> series_;
  std::vector<std::pair<double, std::string>> marks_;
};

}  // namespace ifog::report
