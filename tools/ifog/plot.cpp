#include "tools/ifog/plot.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

namespace ifog::tools {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

void send_data(std::FILE* pipe, const std::string& name, const Curve& curve) {
  std::fprintf(pipe, "%s << EOD\n", name.c_str());
  const bool band = !curve.low.empty();
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!std::isfinite(curve.x[i]) || !std::isfinite(curve.y[i])) {
      std::fputs("\n", pipe);
      continue;
    }
    if (band)
      std::fprintf(pipe, "%.9g %.9g %.9g %.9g\n", curve.x[i], curve.y[i], curve.low[i], curve.high[i]);
    else
      std::fprintf(pipe, "%.9g %.9g\n", curve.x[i], curve.y[i]);
  }
  std::fputs("EOD\n", pipe);
}

}  // namespace

void plot(const std::string& path, const std::vector<Panel>& panels, int width, int height_each) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending != ".svg" && ending != ".png")
    throw std::runtime_error(path + ": expected a name ending in .svg or .png for a picture");
  const std::string partial = path + ".partial" + std::to_string(getpid()) + ending;
  std::FILE* pipe = popen("gnuplot 1>&2", "w");
  if (pipe == nullptr) throw std::runtime_error(path + ": cannot start gnuplot");
  std::fprintf(
      pipe, "set terminal %s size %d,%d %s\nset output %s\n", ending == ".svg" ? "svg" : "pngcairo", width,
      height_each * static_cast<int>(panels.size()),
      ending == ".svg" ? "background rgb 'white' font 'sans,13'" : "background rgb 'white' font 'sans,11'",
      quoted(partial).c_str());
  std::fprintf(pipe, "set encoding utf8\nset grid lc rgb '#dddddd'\nset multiplot layout %zu,1\n",
               panels.size());
  int block = 0;
  for (const Panel& panel : panels) {
    std::fprintf(pipe,
                 "unset logscale\nset autoscale\nunset label\nset key top right\nset title %s "
                 "noenhanced\nset xlabel %s noenhanced\nset ylabel %s noenhanced\n",
                 quoted(panel.title).c_str(), quoted(panel.x_label).c_str(), quoted(panel.y_label).c_str());
    if (panel.log_x)
      std::fputs("set logscale x\nset format x '10^{%L}'\n", pipe);
    else
      std::fputs("set format x '%g'\n", pipe);
    if (panel.log_y)
      std::fputs("set logscale y\nset format y '10^{%L}'\n", pipe);
    else
      std::fputs("set format y '%g'\n", pipe);
    for (const std::string& line : panel.extra) std::fprintf(pipe, "%s\n", line.c_str());
    std::string command;
    for (const Curve& curve : panel.curves) {
      const std::string name = "$d" + std::to_string(block++);
      send_data(pipe, name, curve);
      const std::string color = curve.color.empty() ? "" : " lc rgb '" + curve.color + "'";
      if (!command.empty()) command += ", ";
      if (!curve.low.empty())
        command +=
            name + " using 1:3:4 with filledcurves fs transparent solid 0.2 noborder" + color + " notitle, ";
      command += name + " using 1:2 with " + curve.style + color +
                 (curve.title.empty() ? " notitle" : " title " + quoted(curve.title) + " noenhanced");
    }
    if (!command.empty()) std::fprintf(pipe, "plot %s\n", command.c_str());
  }
  std::fputs("unset multiplot\nunset output\n", pipe);
  const int status = pclose(pipe);
  std::error_code ignored;
  if (status != 0 || !std::filesystem::exists(partial)) {
    std::filesystem::remove(partial, ignored);
    throw std::runtime_error(path + ": gnuplot did not make the picture (exit " +
                             std::to_string(WIFEXITED(status) ? WEXITSTATUS(status) : -1) +
                             "); is gnuplot-nox installed?");
  }
  std::filesystem::rename(partial, path);
}

}  // namespace ifog::tools
