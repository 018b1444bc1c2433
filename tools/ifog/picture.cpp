// ifog picture: what the daemon published, raw against denoised, as one picture: the rate over time and both
// Allan curves.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "drivers/ifog/quoted.h"
#include "tools/ifog/allan/allan_record.h"
#include "tools/ifog/captures/lcm_log.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/plot.h"

namespace ifog::tools {
namespace {

constexpr double kDegreesPerHour = 180.0 / std::numbers::pi * 3600.0;
// More points than a picture is wide only make it larger; beyond this every so-many-th sample is drawn.
constexpr std::size_t kMostPoints = 20000;

struct Arguments {
  std::string log, channel, axis, picture;
  double from_s = 0.0;
};

Curve curve_of(const Table& table, const CaptureColumn& column, const Arguments& a) {
  Curve curve;
  const std::size_t every = table.time_s.size() / kMostPoints + 1;
  for (std::size_t i = 0; i < table.time_s.size(); i += every) {
    if (table.time_s[i] < a.from_s || !std::isfinite(column.values[i])) continue;
    curve.x.push_back(table.time_s[i]);
    curve.y.push_back(column.values[i] * kDegreesPerHour);
  }
  return curve;
}

void run(const Arguments& a) {
  const Table table = read_published(a.log, a.channel);
  const std::string suffix = (a.axis.empty() ? "" : "_" + a.axis) + "_radps";
  Panel rate;
  rate.title = "Rate published by the daemon";
  rate.x_label = "time, s";
  rate.y_label = "°/h";
  std::vector<std::string> axes;
  for (const CaptureColumn& column : table.columns) {
    const bool raw = column.name == "raw" + suffix, denoised = column.name == "denoised" + suffix;
    if (column.name.starts_with("raw")) axes.push_back(column.name);
    if (!raw && !denoised) continue;
    Curve curve = curve_of(table, column, a);
    curve.title = raw ? "raw" : "denoised";
    curve.color = raw ? "#b0c4de" : "#d62728";
    curve.style = raw ? "lines lw 1" : "lines lw 2";
    rate.curves.push_back(std::move(curve));
  }
  if (rate.curves.size() != 2)
    throw std::runtime_error(a.log + ": --axis " + in_quotes(a.axis) + ": expected " +
                             (axes.size() == 1 ? "none, the sensor has one axis" : "x, y or z"));
  AllanOptions options;
  options.axis = a.axis;
  options.from_s = a.from_s;
  std::vector<AllanRecord> records;
  for (AllanRecord& record : allan_records(a.log, table, options))
    if (record.signal == "raw" || record.signal == "denoised") records.push_back(std::move(record));
  // The noise terms are the sensor's; what a filter has been over has none.
  for (AllanRecord& record : records)
    if (record.signal == "denoised") record.fit.reset();
  Panel allan = allan_panel(records);
  allan.title = "Allan deviation, raw and denoised";
  plot(a.picture, {rate, allan}, 1000, 520);
  std::printf("%s\n", a.picture.c_str());
}

}  // namespace

void add_picture(CLI::App& app) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("picture", "What the daemon published: raw against denoised, and both Allan curves");
  command->add_option("log", a->log, "Log of lcm-logger")->required();
  command->add_option("--channel", a->channel, "IFOG_<NAME>, where the log has several");
  command->add_option("--axis", a->axis, "Of a sensor with several: x, y or z");
  command->add_option("--from", a->from_s, "Leave out what is before this time, s")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--output", a->picture, "Picture, .svg or .png")->required();
  command->callback([a] { run(*a); });
}

}  // namespace ifog::tools
