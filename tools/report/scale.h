// SPDX-License-Identifier: Apache-2.0
// Maps data to pixels along one axis of a chart, and selects its ticks.
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
  bool numbered = true;              // false: a neighbour with the same axis has the numbers
  std::vector<std::string> names{};  // labels of 1, 2, 3, ... instead of numbers
};

// Least and greatest value that can be drawn.
struct Bounds {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void take(double value, bool log);
  [[nodiscard]] bool empty() const { return !(low <= high); }
};

struct Tick {
  double at;  // in data units
  std::string text;
  bool major = true;  // placed first, before 2 and 5 of a logarithmic axis
};

class Scale {
 public:
  // Missing limits are taken from the data with a margin. They are never so close together that doubles have
  // no values between them.
  Scale(const ChartAxis& axis, const Bounds& data, double from_px, double to_px);

  [[nodiscard]] double operator()(double value) const;
  [[nodiscard]] bool drawable(double value) const;
  // Limits of the axis, in data units.
  [[nodiscard]] double low() const;
  [[nodiscard]] double high() const;
  // About `wanted` ticks: decades (with 2 and 5 if they are few), or steps of 1, 2, 5. On a linear axis they
  // have a common power of ten and the decimals of their step.
  [[nodiscard]] std::vector<Tick> ticks(int wanted) const;
  // Between decades of a logarithmic axis: 2, 3, … 9; none on a linear one.
  [[nodiscard]] std::vector<double> minor_ticks() const;
  [[nodiscard]] bool log() const { return log_; }

 private:
  [[nodiscard]] bool inside(double exponent) const;
  bool log_;
  std::vector<std::string> names_;
  double low_ = 0.0, high_ = 1.0, from_, to_;
};

}  // namespace ifog::report
