// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/capture_input.h"

#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/predicate.hpp>
#include <stdexcept>
#include <utility>

#include "drivers/capture/candump/candump.h"
#include "drivers/capture/capture_builder.h"
#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/csv_rows.h"
#include "drivers/capture/files/file_kind.h"
#include "drivers/capture/hdf5/hdf5_text.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "filters/model_file/sha256.h"
#include "tools/ifog/captures/flight/flight_input.h"
#include "tools/ifog/captures/lcm/lcm_events.h"
#include "tools/ifog/captures/lcm/lcm_log.h"
#include "tools/ifog/captures/usable_axes.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {

namespace {

// Converts an error in an option to a usage error.
template <typename Parse>
auto parsed(const char* option, const std::string& text, Parse&& parse) {
  try {
    return parse(text);
  } catch (const std::runtime_error& error) {
    throw WrongUsage(option, std::string("is ") + error.what());
  }
}

}  // namespace

void CaptureInput::add_to(const Command& command) {
  add_driver_to(command);
  command.add_option(
      "--column", columns,
      "Column of a CSV file with another header, by its name or number (#3), or dataset of an HDF5 file: "
      "rate_x_radps=GyroX:deg/s; a unit of angle (deg) makes its differences the rate, one of increments "
      "(deg/sample) the turn within each sample, a number before it (0.00763deg/s) the scale of counts; "
      "reference_rate_x_radps is the true rate. May stand several times; columns not named are ignored",
      {.type = "NAME=HEADER[:UNIT]"});
  command.add_option(
      "--time", time,
      "Its time column: t:ms; sec+nsec or date+time: two columns that are one time; Date:d/m/y: dates "
      "with the day first",
      {.type = "HEADER[:UNIT]"});
  command.add_option("--sample-rate", sample_rate_hz,
                     "Its rows are even, at this rate, whatever its times say", {.range = positive()});
  command.add_option("--only", only, "Rows with this text in this column: sensor_id=0; or *: all, as of one",
                     {.type = "HEADER=VALUE"});
  command.add_option("--repeats", repeats, "Rows that repeat the one before: drop or keep",
                     {.choices = {"drop", "keep"}});
  command.add_option("--separator", separator, "Separator of the cells of a CSV file: ';' or tab",
                     {.type = "C"});
  command.add_option("--group", group,
                     "Group of an HDF5 file that holds the columns, or table of records: /imu",
                     {.type = "PATH"});
}

CsvLayout CaptureInput::layout() const {
  CsvLayout out;
  for (const std::string& column : columns) {
    out.columns.push_back(parsed("--column", column, CsvColumn::parse));
    const std::string& name = out.columns.back().name;
    for (std::size_t i = 0; i + 1 < out.columns.size(); ++i)
      if (out.columns[i].name == name) throw WrongUsage("--column", "gives " + in_quotes(name) + " twice");
  }
  if (!time.empty()) out.time = parsed("--time", time, CsvTime::parse);
  if (sample_rate_hz > 0.0) out.sample_rate_hz = sample_rate_hz;
  if (!only.empty())
    parsed("--only", only, [&out](const std::string& text) { return out.parse_only(text), 0; });
  out.keep_repeats = repeats == "keep";
  out.other_rates = other_rates;
  if (!separator.empty()) out.separator = parsed("--separator", separator, CsvLayout::parse_separator);
  return out;
}

void CaptureInput::add_driver_to(const Command& command) {
  command.add_option("--driver", driver, "Driver that understands the recording (see 'ifog drivers')",
                     {.type = "NAME"});
  command.add_option("--option", options, "Option of the driver; may stand several times",
                     {.type = "KEY=VALUE"});
  command.add_option("--dbc", dbc, "Vector DBC file; without --driver chooses the driver dbc",
                     {.type = "FILE"});
  command.before_run([this] {
    const DriverSettings all = settings();
    if (const auto found = all.find("dbc"); found != all.end()) will_read("--dbc", found->second);
  });
  command.add_option("--channel", channel, "CAN interface in a candump log, or channel in an LCM log");
}

std::string CaptureInput::as_typed() const {
  std::string text;
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) text += " " + std::string(option) + " " + shell_word(value);
  };
  add("--driver", driver);
  for (const std::string& each : options) add("--option", each);
  add("--dbc", dbc);
  add("--channel", channel);
  for (const std::string& each : columns) add("--column", each);
  add("--time", time);
  if (sample_rate_hz > 0.0) add("--sample-rate", shortest(sample_rate_hz));
  add("--only", only);
  if (repeats != "drop") add("--repeats", repeats);
  add("--separator", separator);
  add("--group", group);
  return text;
}

std::string CaptureInput::driver_name() const { return driver.empty() && !dbc.empty() ? "dbc" : driver; }

DriverSettings CaptureInput::settings() const {
  DriverSettings out;
  for (const std::string& option : options) {
    const std::size_t equals = option.find('=');
    if (equals == std::string::npos || equals == 0)
      throw WrongUsage("--option", "is " + in_quotes(option) + ", expected KEY=VALUE");
    if (!out.emplace(option.substr(0, equals), option.substr(equals + 1)).second)
      throw WrongUsage("--option", "gives " + in_quotes(option.substr(0, equals)) + " twice");
  }
  if (!dbc.empty() && !out.emplace("dbc", dbc).second)
    throw WrongUsage("--dbc", "cannot go with --option dbc=…, expected one of them");
  return out;
}

DriverInstance CaptureInput::make_driver(const std::vector<std::string>& folders) const {
  return driver_of_run(driver_name(), settings(), folders);
}

FileKind CaptureInput::kind(const InputFile& file) const {
  if (has_layout()) return FileKind::capture;
  const FileKind found = file_kind(file);
  if (found != FileKind::unknown) return found;
  return has_driver() ? FileKind::bytes : FileKind::capture;
}

void CaptureInput::for_each_sample(InputFile& file, DriverInstance& instance,
                                   const std::function<void(const ifog_sample&)>& sink) const {
  const RecordingCounts counts =
      kind(file) == FileKind::lcm_log
          ? decode_logged_bytes(file, instance, channel, sink)
          : decode_recording(file, instance, instance.takes_can() ? channel : "", sink);
  const std::vector<std::string> lost = losses(counts);
  if (counts.samples == 0)
    throw refusal("{}: driver {} finds no sample in it{}", file.path(), driver_name(),
                  lost.empty() ? "" : " (" + boost::join(lost, "; ") + ")");
  for (const std::string& loss : lost) warn("{}: {}\n", file.path(), loss);
}

FileKind CaptureInput::readable(const InputFile& file) const {
  std::string other = foreign_can_log(file.head());
  if (other.empty() && !has_driver()) other = foreign_container(file.head());
  if (!other.empty()) throw refusal("{}: {}", file.path(), other);
  if (boost::iends_with(file.path(), ".toml"))
    throw refusal("{}: is a TOML file, expected a capture; a model is given by --model FILE", file.path());
  const FileKind found = kind(file);
  if (found == FileKind::capture && has_driver())
    throw refusal("{}: is a capture in columns, expected none of --driver and --dbc with it", file.path());
  if ((found == FileKind::bytes || found == FileKind::candump || found == FileKind::unknown) && !has_driver())
    throw refusal("{}: is no capture in columns, expected --driver NAME (or --dbc FILE) to decode it with",
                  file.path());
  return found;
}

RowNotes CaptureInput::column_rows(InputFile& file, RowSink& sink) const {
  const bool hdf5 = is_hdf5(file);
  if (hdf5 && !separator.empty())
    throw WrongUsage("--separator", "cannot go with an HDF5 file, expected a CSV file");
  if (!hdf5 && !group.empty())
    throw WrongUsage("--group", "cannot go with " + in_quotes(file.path()) + ", expected an HDF5 file");
  const ReadingProgress progress(file);
  RowNotes notes = hdf5 ? read_hdf5_rows(file, group, layout(), sink) : read_csv_rows(file, layout(), sink);
  for (const auto& lines : {notes.notices, notes.faults})
    for (const std::string& line : lines) warn("{}\n", line);
  return notes;
}

LongTable CaptureInput::read_long_columns(InputFile& file, const LongTableSink::Wanted& wanted) const {
  LongTable table;
  LongTableSink sink(table, wanted);
  static_cast<RowNotes&>(table) = column_rows(file, sink);
  table.keep_rate_rows(file.path());
  return table;
}

// A log has rates as messages; with a driver it has a device's bytes instead.
bool CaptureInput::holds_rates(const InputFile& file, FileKind found) const {
  return found == FileKind::lcm_log ? !has_driver() : found == FileKind::flight && recorded_messages(file);
}

RowNotes CaptureInput::read_rows(InputFile& file, RowSink& sink) const {
  const FileKind found = readable(file);
  if (found == FileKind::capture) return column_rows(file, sink);
  const ReadingProgress progress(file);
  if (holds_rates(file, found)) {
    read_lcm_log(file, channel, sink);
    return {};
  }
  if (found == FileKind::flight) {
    FlightInput flight(file);
    DriverInstance instance = flight.make_driver(driver_name(), settings());
    return flight.rows(instance, sink);
  }
  DriverInstance instance = make_driver();
  CaptureBuilder builder(instance.description(), sink);
  if (instance.takes_can()) builder.keep_stamps(zero_of_stamps(file.head()));
  naming(file.path(),
         [&] { for_each_sample(file, instance, [&](const ifog_sample& sample) { builder.add(sample); }); });
  for (const std::string& line : builder.remarks()) warn("{}: {}\n", file.path(), line);
  builder.finish();
  return {};
}

LongTable CaptureInput::read_long(InputFile& file, const LongTableSink::Wanted& wanted) const {
  const FileKind found = kind(file);
  const bool whole = found == FileKind::capture || holds_rates(file, found);
  LongTable table;
  table.outlined = outlined;
  LongTableSink sink(table, wanted);
  static_cast<RowNotes&>(table) = read_rows(file, sink);
  // A driver declares what its device can send, so columns without values are dropped.
  if (!whole) table.drop_unknown(file.path());
  if (found == FileKind::capture) table.keep_rate_rows(file.path());
  return table;
}

PreparedCaptures CaptureInput::prepared(const std::vector<std::string>& paths, const Preparation& how) const {
  PreparedCaptures out;
  for (const std::string& path : paths) {
    InputFile file(path);
    Sha256 hash;
    if (how.hashed) file.observe([&hash](std::string_view bytes) { hash.add(bytes); });
    LongTable table = read_long(file, how.wanted);
    if (how.hashed) file.read_to_the_end();
    out.hashes.push_back(how.hashed ? hash.hex() : "");
    table.clean_and_tell(leave_out_repeats, path);
    out.read.emplace_back(std::move(table), path);
  }
  std::vector<CaptureView> as_sent;
  std::vector<TimePart::Rows> rows;
  for (std::size_t c = 0; c < paths.size(); ++c) {
    CaptureView& whole = out.views.emplace_back(out.read[c].view());
    if (how.since_power_up_s) whole.since_power_up_s = how.since_power_up_s;
    rows.push_back(how.part.rows(whole.time_s, whole.origin, paths[c]));
    as_sent.push_back(rows_of(whole, rows.back()));
  }
  const std::vector<std::string> unusable = unusable_axes(as_sent, paths);
  if (how.model != nullptr && !how.model->effects.empty()) {
    tell_model_of_one_axis(*how.model, how.model_path, out.views.front().axes);
    for (CaptureView& view : out.views) {
      out.corrected.push_back(naming(how.model_path, [&] { return compensated_rates(view, *how.model); }));
      view.rate_radps.assign(out.corrected.back().begin(), out.corrected.back().end());
    }
  }
  for (std::size_t c = 0; c < paths.size(); ++c) {
    out.views[c] = rows_of(std::move(out.views[c]), rows[c]);
    leave_out(unusable, out.views[c]);
  }
  return out;
}

}  // namespace ifog::tools
