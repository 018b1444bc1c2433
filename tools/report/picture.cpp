// SPDX-License-Identifier: Apache-2.0
#include "tools/report/picture.h"

#include <librsvg/rsvg.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/capture/files/file_kind.h"
#include "drivers/capture/files/output_file.h"
#include "drivers/ifog/quoted.h"
#include "report_source.h"
#include "tools/report/text.h"

namespace ifog::report {
namespace {

constexpr double kEdge = 10.0, kTitle = 30.0, kGap = 6.0;

std::string whole(double value) { return std::to_string(std::lround(value)); }

// Margin of a column, so that its frames are aligned.
double column_margin(const std::vector<PictureRow>& rows, std::size_t column) {
  double widest = 0.0;
  for (const PictureRow& row : rows)
    if (column < row.cells.size() && !row.cells[column].chart.empty())
      widest = std::max(widest, row.cells[column].chart.left_margin(row.height));
  return widest;
}

std::string png(const std::string& path, const std::string& svg) {
  constexpr double kDots = 2.0;  // per pixel of the SVG
  const auto fail = [&](const char* why) {
    throw std::runtime_error(path + ": cannot draw the picture: " + why);
  };
  GError* error = nullptr;
  const std::unique_ptr<RsvgHandle, void (*)(void*)> handle(
      rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &error),
      g_object_unref);
  if (!handle) fail(error->message);
  gdouble width = 0.0, height = 0.0;
  rsvg_handle_get_intrinsic_size_in_pixels(handle.get(), &width, &height);
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(kDots * width),
                                 static_cast<int>(kDots * height)),
      cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> canvas(cairo_create(surface.get()), cairo_destroy);
  const RsvgRectangle page{0.0, 0.0, kDots * width, kDots * height};
  if (!rsvg_handle_render_document(handle.get(), canvas.get(), &page, &error)) fail(error->message);
  std::string bytes;
  const auto write = [](void* to, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
  };
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), write, &bytes);
  if (status != CAIRO_STATUS_SUCCESS) fail(cairo_status_to_string(status));
  return bytes;
}

// The page's colours of light mode, for programs without CSS variables.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kDaylight{{{"--paper", "#ffffff"},
                                                                                   {"--ink", "#1c2127"},
                                                                                   {"--muted", "#4a545e"},
                                                                                   {"--rule", "#8b949d"},
                                                                                   {"--grid", "#e1e5e9"},
                                                                                   {"--before", "#c26a1b"},
                                                                                   {"--after", "#1a5fb4"},
                                                                                   {"--fit", "#10151a"},
                                                                                   {"--second", "#3f7d4e"},
                                                                                   {"--raw", "#a3acb5"},
                                                                                   {"--third", "#7b4ba0"},
                                                                                   {"--fourth", "#b3263a"}}};

}  // namespace

std::string picture_svg(const std::string& title, const std::vector<PictureRow>& rows, double width) {
  std::string body;
  double y = kEdge + (title.empty() ? 0.0 : kTitle);
  for (const PictureRow& row : rows) {
    double shares = 0.0;
    for (const PictureCell& cell : row.cells) shares += cell.share;
    double x = kEdge;
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      const double own = (width - 2.0 * kEdge) * row.cells[c].share / shares;
      body += "<g transform=\"translate(" + whole(x) + " " + whole(y) + ")\">\n" +
              row.cells[c].chart.panel(own, row.height, column_margin(rows, c)) + "</g>\n";
      x += own;
    }
    y += row.height + kGap;
  }
  const std::string height = whole(y + kEdge);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
         "class=\"chart\" width=\"" +
         whole(width) + "\" height=\"" + height + "\" viewBox=\"0 0 " + whole(width) + " " + height +
         "\"><title>" + escaped(title) + "</title>\n<style>" + picture_style() +
         "</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n" +
         (title.empty() ? ""
                        : "<text class=\"heading\" x=\"" + whole(kEdge + 4.0) + "\" y=\"" +
                              whole(kEdge + 15.0) + "\">" + escaped(title) + "</text>\n") +
         body + "</svg>\n";
}

std::string wrong_picture_name(const std::string& path) {
  if (boost::iends_with(path, ".svg") || boost::iends_with(path, ".png") || is_standard_output(path))
    return "";
  return "is " + in_quotes(path, kLongestMessage) + ", expected a name ending in .svg or .png";
}

void write_picture(const std::string& path, const std::string& svg) {
  write_file(path, boost::iends_with(path, ".png") ? png(path, svg) : svg);
}

std::string page_style() { return std::string(kReportStyle).append(kChartStyle); }

std::string page_script() { return kReportScript; }

std::string picture_style() {
  std::string rules = kChartStyle;
  for (const auto& [name, colour] : kDaylight)
    boost::replace_all(rules, "var(" + std::string(name) + ")", colour);
  return rules;
}

}  // namespace ifog::report
