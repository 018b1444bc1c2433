// SPDX-License-Identifier: Apache-2.0
// ifog picture: raw and denoised rate of a log as one picture: over time, and as Allan curves.
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/recording.h"
#include "drivers/ifog/quoted.h"
#include "filters/units/field_units.h"
#include "tools/ifog/allan/allan_record.h"
#include "tools/ifog/captures/lcm/lcm_log.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/table/long_table.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"
#include "tools/report/picture.h"
#include "tools/report/scale.h"
#include "tools/report/text.h"

namespace ifog::tools {
namespace {

struct PictureArguments {
  std::string log, channel, axis, picture;
  TimePart part;
};

void run_picture(const PictureArguments& a) {
  InputFile log(a.log);
  if (const FileKind kind = file_kind(log); kind != FileKind::lcm_log && kind != FileKind::flight)
    throw refusal("{}: is no log of lcm-logger", a.log);
  LongTable table;
  LongTableSink sink(table);
  read_published(log, a.channel, sink);
  const TimePart::Rows rows = a.part.rows(table.time_s, table.origin, a.log);
  const auto shown = [&rows](const Samples& values, double scale) {
    const std::span<const double> part = rows.of(values);
    return report::scaled({part.begin(), part.end()}, scale);
  };
  const report::TimeAxis time(table.time_s[rows.begin], table.time_s[rows.end - 1]);
  report::Chart rate("Rate published by the daemon", "Raw and denoised rate over time.", time.axis(),
                     {"rate (°/h)", false, {}, {}});
  const LongColumn* const raw = table.column(of_axis("raw", a.axis) + "_radps");
  const LongColumn* const denoised = table.column(of_axis("denoised", a.axis) + "_radps");
  if (raw == nullptr || denoised == nullptr)
    throw refusal("{}: --axis {}: expected {}", a.log, in_quotes(a.axis),
                  table.column("raw_radps") != nullptr ? "none, the sensor has one axis" : "x, y or z");
  const std::vector<double> shown_s = time(shown(table.time_s, 1.0));
  rate.line_in_time(report::Role::kRaw, "raw", shown_s, shown(raw->values, 1.0 / kDegreePerHour));
  rate.line_in_time(report::Role::kAfter, "denoised", shown_s, shown(denoised->values, 1.0 / kDegreePerHour));
  AllanOptions options;
  options.axis = a.axis;
  options.part = a.part;
  options.keep_motion = true;  // the denoised rate is shown, at rest or not
  std::vector<AllanRecord> records;
  for (AllanRecord& record : allan_records(a.log, table, options))
    if (record.signal == "raw" || record.signal == "denoised") records.push_back(std::move(record));
  // The noise terms describe the sensor, not a filter's output.
  for (AllanRecord& record : records)
    if (record.signal == "denoised") record.fit.reset();
  report::write_picture(
      a.picture,
      report::picture_svg(
          "", {{400.0, {{rate}}}, {520.0, {{allan_chart("Allan deviation, raw and denoised", records)}}}}));
  say("{}\n", a.picture);
}

}  // namespace

void add_picture(const Command& program) {
  auto a = std::make_shared<PictureArguments>();
  const Command command = program.add_subcommand(
      "picture", "What the daemon published: raw against denoised, and both Allan curves");
  command.add_option("log", a->log, "Log of lcm-logger", {.required = true, .file = FileUse::read});
  command.add_option("--channel", a->channel, "IFOG_<NAME>, where the log has several");
  command.add_option("--axis", a->axis, "Of a sensor with several: x, y or z");
  a->part.add_to(command);
  command.add_option("-o,--output", a->picture, "Picture, .svg or .png",
                     {.required = true, .check = report::wrong_picture_name, .file = FileUse::written});
  command.callback([a] { run_picture(*a); });
}

}  // namespace ifog::tools
