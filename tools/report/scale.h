// SPDX-License-Identifier: Apache-2.0
// Data to pixels along one axis of a chart, and the round numbers that stand at it.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace ifog::report {

struct ChartAxis {
  std::string label;
  bool log = false;  // values that are not positive are not drawn
  std::optional<double> low, high;
  bool numbered = true;              // false: a neighbour that shares the axis has the numbers
  std::vector<std::string> names{};  // of 1, 2, 3, ... in place of numbers
};

// The least and the greatest value that can be drawn.
struct Bounds {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void take(double value, bool log);
  [[nodiscard]] bool empty() const { return !(low <= high); }
};

struct Tick {
  double at;  // in data
  std::string text;
  bool major = true;  // has the first claim to its place, before the 2 and 5 of a logarithmic axis
};

class Scale {
 public:
  // Where the axis does not say its ends, those of the data with a little room. Never so close together that
  // doubles have no steps between them.
  Scale(const ChartAxis& axis, const Bounds& data, double from_px, double to_px);

  [[nodiscard]] double operator()(double value) const;
  [[nodiscard]] bool drawable(double value) const;
  // The ends of the axis, in data.
  [[nodiscard]] double low() const;
  [[nodiscard]] double high() const;
  // About so many: decades (with 2 and 5 when those are few), or steps of 1, 2, 5.
  // Those of a linear axis have the same power of ten and as many decimals as their step has.
  [[nodiscard]] std::vector<Tick> ticks(int wanted) const;
  // Between the decades of a logarithmic axis: 2, 3, … 9; none on a linear one.
  [[nodiscard]] std::vector<double> minor_ticks() const;
  [[nodiscard]] bool log() const { return log_; }

 private:
  [[nodiscard]] bool inside(double exponent) const;
  bool log_;
  std::vector<std::string> names_;
  double low_ = 0.0, high_ = 1.0, from_, to_;
};

}  // namespace ifog::report
