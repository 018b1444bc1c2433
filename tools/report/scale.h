// SPDX-License-Identifier: Apache-2.0
// Maps data to pixels along one axis of a chart, and selects its ticks and its points.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/report/text.h"

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

// Times on a picture's axis: in a suitable unit, and relative to a whole second if the record's times are too
// long to read (seconds since 1970 or 1980).
class TimeAxis {
 public:
  // Limits of the picture.
  TimeAxis(double first_s, double last_s);

  // Value on the axis for a time in s.
  [[nodiscard]] double operator()(double time_s) const { return (time_s - origin_s_) / unit_.seconds; }
  [[nodiscard]] std::vector<double> operator()(std::vector<double> time_s) const;
  // "time (min)", "time since 1700000000 s (min)".
  [[nodiscard]] std::string label() const;
  // From the first to the last time; without label and numbers if the picture below has them.
  [[nodiscard]] ChartAxis axis(bool numbered = true) const;

 private:
  double first_s_, last_s_;
  TimeUnit unit_;
  double origin_s_ = 0.0;
};

// The same curve in fewer points with its extremes; short curves are unchanged.
struct Thinned {
  std::vector<double> x, y;
};
Thinned thinned(std::span<const double> x, std::span<const double> y);

// A chart's data for the page's script, see page.js: float32, little-endian, base64: its seven digits exceed the screen's resolution.
std::string packed(std::span<const double> values);

// Inserts a NaN in the middle of each gap: a step of more than ten times the usual one. y has the length of
// time.
void open_at_holes(std::vector<double>& time, std::vector<double>& y);

}  // namespace ifog::report
