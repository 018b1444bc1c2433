// SPDX-License-Identifier: Apache-2.0
#include "tools/report/chart.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "tools/report/scale.h"
#include "tools/report/text.h"

namespace ifog::report {
namespace {

constexpr double kLeft = 68.0, kRight = 16.0, kLegendRow = 17.0;
constexpr double kCharacter = 6.9;  // mean width in the 12 px font

std::string fixed(double value) { return fmt::format("{:.1f}", value); }

// Fewer ticks on low panels.
int y_ticks(double pixels) { return std::clamp(static_cast<int>(pixels / 48.0), 2, 6); }

double text_width(const std::string& text) { return kCharacter * static_cast<double>(characters_in(text)); }

std::string words(const char* style, double x, double y, const char* anchor, const std::string& text) {
  return std::string("<text class=\"") + style + "\" x=\"" + fixed(x) + "\" y=\"" + fixed(y) +
         "\" text-anchor=\"" + anchor + "\">" + escaped(text) + "</text>\n";
}

// Places labels along x without overlap or crossing the edge; fewer if they are long.
std::vector<Tick> side_by_side(const Scale& scale, double edge) {
  constexpr double kApart = 10.0;
  for (int wanted = 7;; --wanted) {
    std::vector<Tick> ticks = scale.ticks(wanted);
    std::vector<std::pair<double, double>> occupied;
    bool all = true;
    for (const bool major : {true, false})
      for (Tick& tick : ticks) {
        if (tick.major != major) continue;
        const double half = 0.5 * text_width(tick.text), at = scale(tick.at);
        const bool beyond = at + half > edge;
        const bool room = std::ranges::none_of(occupied, [&](const auto& other) {
          return at - half < other.second + kApart && at + half > other.first - kApart;
        });
        if (room && !beyond)
          occupied.emplace_back(at - half, at + half);
        else
          tick.text.clear();
        all = all && (room || beyond);
      }
    if (all || scale.log() || wanted == 2) return ticks;
  }
}

// A path through the points. Pixel columns with several points are drawn from minimum to maximum.
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

// Along the upper edge and back along the lower one.
std::string outline(const std::vector<double>& x, const std::vector<double>& low,
                    const std::vector<double>& high, const Scale& sx, const Scale& sy) {
  std::string there, back;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!sx.drawable(x[i]) || !sy.drawable(low[i]) || !sy.drawable(high[i])) continue;
    there += (there.empty() ? "M" : "L") + fixed(sx(x[i])) + " " + fixed(sy(high[i]));
    back = "L" + fixed(sx(x[i])) + " " + fixed(sy(low[i])) + back;
  }
  return there.empty() ? "" : there + back + "Z";
}

// One path of zero-length strokes: with round caps they are dots, at a tenth of the size of circles.
std::string dots(const std::vector<double>& x, const std::vector<double>& y, const Scale& sx,
                 const Scale& sy) {
  std::string d;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i)
    if (sx.drawable(x[i]) && sy.drawable(y[i])) d += "M" + fixed(sx(x[i])) + " " + fixed(sy(y[i])) + "h0";
  return d;
}

}  // namespace

std::string Chart::Series::style(const char* more) const {
  constexpr const char* kKinds[] = {"line ", "dots ", "band ", "guide "};
  constexpr const char* kRoles[] = {"before", "after", "fit", "second", "raw", "third", "fourth"};
  return std::string(kKinds[static_cast<std::size_t>(kind)]) + more + kRoles[static_cast<std::size_t>(role)];
}

Role role_of(std::size_t index) {
  constexpr std::array kOrder{Role::kAfter, Role::kBefore, Role::kSecond,
                              Role::kThird, Role::kFourth, Role::kFit};
  return kOrder[index % kOrder.size()];
}

Chart::Chart(std::string title, std::string description, ChartAxis x, ChartAxis y)
    : title_(std::move(title)), description_(std::move(description)), x_(std::move(x)), y_(std::move(y)) {}

void Chart::line(Role role, const std::string& label, std::vector<double> x, std::vector<double> y) {
  series_.push_back({Kind::line, role, label, std::move(x), std::move(y), {}});
}

void Chart::line_in_time(Role role, const std::string& label, std::vector<double> time,
                         std::vector<double> y) {
  open_at_holes(time, y);
  line(role, label, std::move(time), std::move(y));
}

void Chart::points(Role role, const std::string& label, std::vector<double> x, std::vector<double> y) {
  series_.push_back({Kind::points, role, label, std::move(x), std::move(y), {}});
}

void Chart::band(Role role, std::vector<double> x, std::vector<double> low, std::vector<double> high) {
  series_.push_back({Kind::band, role, "", std::move(x), std::move(low), std::move(high)});
}

void Chart::guide(Role role, std::vector<double> x, std::vector<double> y) {
  series_.push_back({Kind::guide, role, "", std::move(x), std::move(y), {}});
}

void Chart::mark_x(double x, const std::string& label) { marks_.emplace_back(x, label); }

Bounds Chart::bounds(bool of_x) const {
  Bounds out;
  for (const Series& s : series_) {
    if (s.kind == Kind::guide) continue;
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      out.take(of_x ? s.x[i] : s.y[i], of_x ? x_.log : y_.log);
      if (!of_x && s.kind == Kind::band) out.take(s.high[i], y_.log);
    }
  }
  return out;
}

bool Chart::empty() const { return bounds(true).empty() || bounds(false).empty(); }

Chart::Legend Chart::legend(double left, double right, double top) const {
  Legend out;
  double at = left;
  for (const Series& s : series_) {
    if (s.label.empty()) continue;
    const double width = 28.0 + text_width(s.label);
    if (out.rows == 0.0) out.rows = 1.0;
    if (at > left && at + width > right) {
      at = left;
      out.rows += 1.0;
    }
    const double y = top + kLegendRow * out.rows;
    out.svg +=
        "<path class=\"" + s.style("key ") + "\" d=\"M" + fixed(s.kind == Kind::points ? at + 11.0 : at);
    out.svg += " " + fixed(y - 4.0) + (s.kind == Kind::points ? "h0\"/>" : "h22\"/>");
    out.svg += words("tick", at + 28.0, y, "start", s.label);
    at += width + 22.0;
  }
  return out;
}

std::string Chart::axes(const Frame& f, const Scale& sx, const Scale& sy, double height) const {
  std::string out;
  const auto rule = [&](const char* style, const std::string& d) {
    out += std::string("<path class=\"") + style + "\" d=\"" + d + "\"/>\n";
  };
  const auto upright = [&](double px) {
    return "M" + fixed(px) + " " + fixed(f.top) + "V" + fixed(f.bottom);
  };
  const auto level = [&](double py) { return "M" + fixed(f.left) + " " + fixed(py) + "H" + fixed(f.right); };
  out += "<g class=\"scale\">\n";
  std::string minor;
  for (const double v : sx.minor_ticks()) minor += upright(sx(v));
  for (const double v : sy.minor_ticks()) minor += level(sy(v));
  if (!minor.empty()) rule("minor", minor);
  for (const Tick& tick : side_by_side(sx, f.right + kRight)) {
    const double px = sx(tick.at);
    if (px < f.left - 0.5 || px > f.right + 0.5) continue;
    rule("grid", upright(px));
    if (x_.numbered && !tick.text.empty()) out += words("tick", px, f.bottom + 16.0, "middle", tick.text);
  }
  for (const Tick& tick : sy.ticks(y_ticks(f.bottom - f.top))) {
    const double py = sy(tick.at);
    if (py < f.top - 0.5 || py > f.bottom + 0.5) continue;
    rule("grid", level(py));
    if (y_.numbered) out += words("tick", f.left - 7.0, py + 4.0, "end", tick.text);
  }
  for (const auto& [value, label] : marks_) {
    if (!sx.drawable(value) || sx(value) < f.left || sx(value) > f.right) continue;
    const bool flip = sx(value) > 0.8 * f.right;
    rule("mark", upright(sx(value)));
    out += words("tick", sx(value) + (flip ? -4.0 : 4.0), f.top + 12.0, flip ? "end" : "start", label);
  }
  out += "</g>\n";
  rule("frame", upright(f.left) + "H" + fixed(f.right));
  if (!x_.label.empty()) out += words("label", 0.5 * (f.left + f.right), height - 8.0, "middle", x_.label);
  const std::string middle = fixed(0.5 * (f.top + f.bottom));
  if (!y_.label.empty())
    out += "<text class=\"label\" x=\"14\" y=\"" + middle +
           "\" text-anchor=\"middle\" transform=\"rotate(-90 14 " + middle + ")\">" + escaped(y_.label) +
           "</text>\n";
  return out;
}

std::string Chart::curves(const Frame& f, const Scale& sx, const Scale& sy) const {
  const std::string box =
      fixed(f.left) + " " + fixed(f.top) + " " + fixed(f.right - f.left) + " " + fixed(f.bottom - f.top);
  // Given axis limits may clip a curve.
  std::string out = "<svg class=\"curves\" x=\"" + fixed(f.left) + "\" y=\"" + fixed(f.top) + "\" width=\"" +
                    fixed(f.right - f.left) + "\" height=\"" + fixed(f.bottom - f.top) + "\" viewBox=\"" +
                    box + "\">";
  for (const Series& s : series_) {
    const std::string d = s.kind == Kind::band     ? outline(s.x, s.y, s.high, sx, sy)
                          : s.kind == Kind::points ? dots(s.x, s.y, sx, sy)
                                                   : path(s.x, s.y, sx, sy);
    out += "<path class=\"" + s.style() + "\" d=\"" + d + "\"/>\n";
  }
  return out + "</svg>\n";
}

double Chart::left_margin(double height) const {
  double widest = 0.0;
  const Scale sy(y_, bounds(false), height, 0.0);
  for (const Tick& tick : sy.ticks(y_ticks(height))) widest = std::max(widest, text_width(tick.text));
  return (y_.label.empty() ? 8.0 : 26.0) + (y_.numbered ? widest + 7.0 : 0.0);
}

Chart::Frame Chart::frame(double width, double height, double left, bool headed, const Legend& key) const {
  const double heading = headed && !title_.empty() ? 20.0 : 4.0;
  const double top = heading + (headed ? 6.0 : 13.0) + std::max(key.rows, headed ? 0.0 : 1.0) * kLegendRow;
  const double below = !x_.numbered ? 8.0 : x_.label.empty() ? 24.0 : 46.0;
  return {left, width - kRight, top, height - below};
}

std::string Chart::drawing(double width, double height, double left, bool headed) const {
  const Legend key = legend(left, width - kRight, headed && !title_.empty() ? 20.0 : 4.0);
  const Frame f = frame(width, height, left, headed, key);
  const Scale sx(x_, bounds(true), f.left, f.right), sy(y_, bounds(false), f.bottom, f.top);
  std::string out = axes(f, sx, sy, height) + curves(f, sx, sy) + key.svg;
  if (headed && !title_.empty()) out += words("heading", left, 15.0, "start", title_);
  return out;
}

std::string Chart::plot_data(const Frame& f) const {
  const Scale sx(x_, bounds(true), f.left, f.right), sy(y_, bounds(false), f.bottom, f.top);
  nlohmann::json series = nlohmann::json::array();
  for (std::size_t i = 0; i < series_.size(); ++i) {
    const Series& s = series_[i];
    constexpr const char* kKinds[] = {"line", "points", "band", "guide"};
    nlohmann::json each{
        {"kind", kKinds[static_cast<std::size_t>(s.kind)]}, {"style", s.style()}, {"name", s.label}};
    if (const Thinned fewer = thinned(s.x, s.y); s.kind != Kind::band && fewer.x.size() < s.x.size()) {
      each["x"] = packed(fewer.x);
      each["y"] = packed(fewer.y);
      series.push_back(std::move(each));
      continue;
    }
    each["y"] = packed(s.y);
    const auto same = std::find_if(
        series_.begin(), series_.begin() + static_cast<std::ptrdiff_t>(i), [&](const Series& other) {
          return other.x == s.x && thinned(other.x, other.y).x.size() == s.x.size();
        });
    if (same < series_.begin() + static_cast<std::ptrdiff_t>(i))
      each["x"] = same - series_.begin();
    else
      each["x"] = packed(s.x);
    if (s.kind == Kind::band) each["high"] = packed(s.high);
    series.push_back(std::move(each));
  }
  const auto axis = [](const ChartAxis& a, const Scale& scale) {
    return nlohmann::json{
        {"log", a.log}, {"low", scale.low()}, {"high", scale.high()}, {"label", a.label}, {"names", a.names}};
  };
  return nlohmann::json{{"frame", {f.left, f.right, f.top, f.bottom}},
                        {"x", axis(x_, sx)},
                        {"y", axis(y_, sy)},
                        {"series", series}}
      .dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);  // a name may contain any bytes
}

std::string Chart::panel(double width, double height, double left) const {
  return empty() ? "" : drawing(width, height, left, true);
}

// A drawing without numbers uses those of the previous one; it has its own frame.
std::string Chart::element(const std::string& style, double width, double height, bool with_numbers) const {
  const double left = std::max(with_numbers ? kLeft : 0.0, left_margin(height));
  const Frame f = frame(width, height, left, false, legend(left, width - kRight, 4.0));
  return "<svg class=\"chart " + style + "\" role=\"img\" viewBox=\"0 0 " + fixed(width) + " " +
         fixed(height) + "\" preserveAspectRatio=\"xMidYMid meet\" " +
         (with_numbers ? "data-plot=\"" + escaped(plot_data(f))
                       : "data-frame=\"[" + fixed(f.left) + "," + fixed(f.right) + "," + fixed(f.top) + "," +
                             fixed(f.bottom) + "]") +
         "\"><title>" + escaped(title_) + "</title><desc>" + escaped(description_) + "</desc>\n" +
         drawing(width, height, left, false) + "</svg>";
}

std::string Chart::svg(double width, double height) const {
  if (empty()) return "";
  constexpr double kTelephone = 350.0, kHighest = 270.0;  // px
  return "<div class=\"scroll\">" + element(width < 600.0 ? "wide small" : "wide", width, height, true) +
         element("narrow", kTelephone, std::min(height, kHighest), false) + "</div>\n";
}

}  // namespace ifog::report
