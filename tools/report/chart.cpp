#include "tools/report/chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tools/report/text.h"

namespace ifog::report {
namespace {

constexpr double kLeft = 68.0, kRight = 16.0, kTop = 34.0, kBottom = 46.0;

const char* css_class(Role role) {
  switch (role) {
    case Role::kBefore:
      return "before";
    case Role::kAfter:
      return "after";
    case Role::kFit:
      return "fit";
    case Role::kSecond:
      return "second";
  }
  return "";
}

std::string fixed(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

// Data to pixels along one axis.
class Scale {
 public:
  Scale(const ChartAxis& axis, double low, double high, double from, double to)
      : log_(axis.log), from_(from), to_(to) {
    low_ = axis.low.value_or(low);
    high_ = axis.high.value_or(high);
    if (log_) {
      low_ = std::log10(low_);
      high_ = std::log10(high_);
    }
    const double span = high_ - low_;
    const double margin = span > 0.0 ? 0.04 * span : (log_ ? 0.5 : std::max(std::abs(low_), 1e-30));
    if (!axis.low) low_ -= margin;
    if (!axis.high) high_ += margin;
  }
  [[nodiscard]] double operator()(double value) const {
    return from_ + ((log_ ? std::log10(value) : value) - low_) / (high_ - low_) * (to_ - from_);
  }
  [[nodiscard]] bool drawable(double value) const { return std::isfinite(value) && (!log_ || value > 0.0); }

  // Values at round numbers: decades (with 2 and 5 when there are few), or steps of 1, 2, 5.
  [[nodiscard]] std::vector<double> ticks(int wanted) const {
    std::vector<double> out;
    if (log_) {
      const bool dense = high_ - low_ < 2.5;
      for (int d = static_cast<int>(std::floor(low_)); d <= static_cast<int>(std::ceil(high_)); ++d)
        for (const double m : {1.0, 2.0, 5.0})
          if ((dense || m == 1.0) && inside(d + std::log10(m))) out.push_back(m * std::pow(10.0, d));
      return out;
    }
    const double raw = (high_ - low_) / wanted;
    const double ten = std::pow(10.0, std::floor(std::log10(raw)));
    const double step = ten * (raw / ten < 1.5 ? 1.0 : raw / ten < 3.5 ? 2.0 : raw / ten < 7.5 ? 5.0 : 10.0);
    for (double v = std::ceil(low_ / step); v * step <= high_; v += 1.0) out.push_back(v * step);
    return out;
  }
  [[nodiscard]] std::string tick_text(double value) const {
    if (log_) return number(value, 1);
    const double reach = std::max(std::abs(low_), std::abs(high_));
    if (std::abs(value) < 1e-9 * reach) return "0";
    const double span = high_ - low_;
    // As many digits as neighbours need to differ.
    const int digits = 1 + std::max(0, static_cast<int>(std::ceil(std::log10(std::abs(value) / span))) + 1);
    return trimmed(number(value, std::min(digits + 1, 9)));
  }

 private:
  [[nodiscard]] bool inside(double exponent) const {
    return exponent >= low_ - 1e-9 && exponent <= high_ + 1e-9;
  }
  static std::string trimmed(std::string text) {
    if (text.find('.') == std::string::npos || text.find("×") != std::string::npos) return text;
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text;
  }
  bool log_;
  double low_ = 0.0, high_ = 1.0, from_, to_;
};

struct Bounds {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void take(double value, bool log) {
    if (!std::isfinite(value) || (log && value <= 0.0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// A path through the points; pixel columns that hold several are covered from their least to their most.
std::string path(const std::vector<double>& x, const std::vector<double>& y, const Scale& sx,
                 const Scale& sy) {
  std::string d;
  bool pen_down = false;
  std::size_t i = 0;
  while (i < x.size()) {
    if (!sx.drawable(x[i]) || !sy.drawable(y[i])) {
      pen_down = false;
      ++i;
      continue;
    }
    const double px = sx(x[i]);
    std::size_t end = i;
    double least = sy(y[i]), most = least, last = least;
    while (end < x.size() && sx.drawable(x[end]) && sy.drawable(y[end]) && sx(x[end]) - px < 0.7) {
      last = sy(y[end]);
      least = std::min(least, last);
      most = std::max(most, last);
      ++end;
    }
    d += (pen_down ? "L" : "M") + fixed(px) + " " + fixed(sy(y[i]));
    if (end - i > 2) d += "V" + fixed(least) + "V" + fixed(most) + "V" + fixed(last);
    pen_down = true;
    i = std::max(end, i + 1);
  }
  return d;
}

}  // namespace

Chart::Chart(std::string title, std::string description, ChartAxis x, ChartAxis y)
    : title_(std::move(title)), description_(std::move(description)), x_(std::move(x)), y_(std::move(y)) {}

void Chart::line(Role role, const std::string& label, std::vector<double> x, std::vector<double> y) {
  series_.push_back({role, label, std::move(x), std::move(y), true});
}

void Chart::points(Role role, const std::string& label, std::vector<double> x, std::vector<double> y) {
  series_.push_back({role, label, std::move(x), std::move(y), false});
}

void Chart::mark_x(double x, const std::string& label) { marks_.emplace_back(x, label); }

bool Chart::empty() const {
  Bounds x, y;
  for (const Series& s : series_)
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      x.take(s.x[i], x_.log);
      y.take(s.y[i], y_.log);
    }
  return !(x.low <= x.high && y.low <= y.high);
}

std::string Chart::svg(double width, double height) const {
  if (empty()) return "";
  Bounds bx, by;
  for (const Series& s : series_)
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      bx.take(s.x[i], x_.log);
      by.take(s.y[i], y_.log);
    }
  const Scale sx(x_, bx.low, bx.high, kLeft, width - kRight);
  const Scale sy(y_, by.low, by.high, height - kBottom, kTop);
  const double right = width - kRight, bottom = height - kBottom;

  std::string out = "<svg class=\"chart\" role=\"img\" viewBox=\"0 0 " + fixed(width) + " " + fixed(height) +
                    "\" preserveAspectRatio=\"xMidYMid meet\"><title>" + escaped(title_) + "</title><desc>" +
                    escaped(description_) + "</desc>\n";
  for (const double v : sx.ticks(7)) {
    const std::string px = fixed(sx(v));
    if (sx(v) < kLeft - 0.5 || sx(v) > right + 0.5) continue;
    out += "<path class=\"grid\" d=\"M" + px + " " + fixed(kTop) + "V" + fixed(bottom) +
           "\"/><text class=\"tick\" x=\"" + px + "\" y=\"" + fixed(bottom + 16.0) +
           "\" text-anchor=\"middle\">" + sx.tick_text(v) + "</text>\n";
  }
  for (const double v : sy.ticks(5)) {
    const double py = sy(v);
    if (py < kTop - 0.5 || py > bottom + 0.5) continue;
    out += "<path class=\"grid\" d=\"M" + fixed(kLeft) + " " + fixed(py) + "H" + fixed(right) +
           "\"/><text class=\"tick\" x=\"" + fixed(kLeft - 7.0) + "\" y=\"" + fixed(py + 4.0) +
           "\" text-anchor=\"end\">" + sy.tick_text(v) + "</text>\n";
  }
  out += "<text class=\"label\" x=\"" + fixed(0.5 * (kLeft + right)) + "\" y=\"" + fixed(height - 8.0) +
         "\" text-anchor=\"middle\">" + escaped(x_.label) + "</text>\n";
  out += "<text class=\"label\" x=\"14\" y=\"" + fixed(0.5 * (kTop + bottom)) +
         "\" text-anchor=\"middle\" transform=\"rotate(-90 14 " + fixed(0.5 * (kTop + bottom)) + ")\">" +
         escaped(y_.label) + "</text>\n";
  for (const auto& [value, label] : marks_) {
    if (!sx.drawable(value) || sx(value) < kLeft || sx(value) > right) continue;
    const bool flip = sx(value) > 0.8 * right;
    out += "<path class=\"mark\" d=\"M" + fixed(sx(value)) + " " + fixed(kTop) + "V" + fixed(bottom) +
           "\"/><text class=\"tick\" x=\"" + fixed(sx(value) + (flip ? -4.0 : 4.0)) + "\" y=\"" +
           fixed(kTop + 12.0) + "\" text-anchor=\"" + (flip ? "end" : "start") + "\">" + escaped(label) +
           "</text>\n";
  }
  // Axis limits that were asked for may cut a curve.
  const std::string clip = "<svg x=\"" + fixed(kLeft) + "\" y=\"" + fixed(kTop) + "\" width=\"" +
                           fixed(right - kLeft) + "\" height=\"" + fixed(bottom - kTop) + "\" viewBox=\"" +
                           fixed(kLeft) + " " + fixed(kTop) + " " + fixed(right - kLeft) + " " +
                           fixed(bottom - kTop) + "\">";
  out += clip;
  double legend = kLeft;
  std::string legend_text;
  for (const Series& s : series_) {
    const std::string name = css_class(s.role);
    if (s.joined) {
      out += "<path class=\"line " + name + "\" d=\"" + path(s.x, s.y, sx, sy) + "\"/>\n";
    } else {
      // One path of zero-length strokes: round caps make them dots at a tenth of the size of circles.
      out += "<path class=\"dots " + name + "\" d=\"";
      for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i)
        if (sx.drawable(s.x[i]) && sy.drawable(s.y[i]))
          out += "M" + fixed(sx(s.x[i])) + " " + fixed(sy(s.y[i])) + "h0";
      out += "\"/>\n";
    }
    if (s.label.empty()) continue;
    legend_text += s.joined
                       ? "<path class=\"line key " + name + "\" d=\"M" + fixed(legend) + " 17h22\"/>"
                       : "<path class=\"dots key " + name + "\" d=\"M" + fixed(legend + 11.0) + " 17h0\"/>";
    legend_text +=
        "<text class=\"tick\" x=\"" + fixed(legend + 28.0) + "\" y=\"21\">" + escaped(s.label) + "</text>\n";
    legend += 50.0 + 6.6 * static_cast<double>(s.label.size());
  }
  return out + "</svg>\n" + legend_text + "</svg>\n";
}

}  // namespace ifog::report
