// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/capture_input.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include "drivers/capture/capture_builder.h"
#include "drivers/ifog/quoted.h"
#include "filters/model_file/sha256.h"
#include "tools/ifog/captures/flight_input.h"
#include "tools/ifog/captures/lcm_log.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {

namespace {

// A wrong option is a matter of usage.
template <typename Parse>
auto parsed(const char* option, const std::string& text, Parse&& parse) {
  try {
    return parse(text);
  } catch (const std::runtime_error& error) {
    throw CLI::ValidationError(option, std::string("is ") + error.what());
  }
}

}  // namespace

void CaptureInput::add_to(CLI::App& command) {
  add_driver_to(command);
  command
      .add_option(
          "--column", columns,
          "Column of a CSV file with another header: rate_x_radps=GyroX:deg/s; a unit of angle (deg) makes "
          "its differences the rate. May stand several times; columns not named are passed over")
      ->type_name("NAME=HEADER[:UNIT]");
  command.add_option("--time", time, "Its time column: t:ms")->type_name("HEADER[:UNIT]");
  command.add_option("--separator", separator, "What stands between its cells: ';' or tab")->type_name("C");
}

CsvLayout CaptureInput::layout() const {
  CsvLayout out;
  for (const std::string& column : columns) {
    out.columns.push_back(parsed("--column", column, CsvColumn::parse));
    const std::string& name = out.columns.back().name;
    for (std::size_t i = 0; i + 1 < out.columns.size(); ++i)
      if (out.columns[i].name == name)
        throw CLI::ValidationError("--column", "gives " + in_quotes(name) + " twice");
  }
  if (!time.empty()) out.time = parsed("--time", time, CsvTime::parse);
  if (!separator.empty()) out.separator = parsed("--separator", separator, CsvLayout::parse_separator);
  return out;
}

Capture CaptureInput::parse(std::string_view text, const std::string& path) const {
  Capture capture = parse_capture(text, path, layout());
  for (const std::string& notice : capture.notices) warn("%s\n", notice.c_str());
  for (const std::string& fault : capture.faults) warn("%s\n", fault.c_str());
  return capture;
}

Table CaptureInput::parse_columns(std::string_view text, const std::string& path) const {
  Table table = parse_table(text, path, layout());
  for (const std::string& notice : table.notices) warn("%s\n", notice.c_str());
  for (const std::string& fault : table.faults) warn("%s\n", fault.c_str());
  return table;
}

void CaptureInput::add_driver_to(CLI::App& command) {
  command.add_option("--driver", driver, "Driver that understands the recording (see 'ifog drivers')")
      ->type_name("NAME");
  command.add_option("--option", options, "Option of the driver; may stand several times")
      ->type_name("KEY=VALUE");
  command.add_option("--dbc", dbc, "Vector DBC file; without --driver chooses the driver dbc")
      ->type_name("FILE");
  command.add_option("--channel", channel, "CAN interface in a candump log, or channel in an LCM log")
      ->type_name("NAME");
}

std::string CaptureInput::driver_name() const { return driver.empty() && !dbc.empty() ? "dbc" : driver; }

DriverSettings CaptureInput::settings() const {
  DriverSettings out;
  for (const std::string& option : options) {
    const std::size_t equals = option.find('=');
    if (equals == std::string::npos || equals == 0)
      throw CLI::ValidationError("--option", "is " + in_quotes(option) + ", expected KEY=VALUE");
    if (!out.emplace(option.substr(0, equals), option.substr(equals + 1)).second)
      throw CLI::ValidationError("--option", "gives " + in_quotes(option.substr(0, equals)) + " twice");
  }
  if (!dbc.empty() && !out.emplace("dbc", dbc).second)
    throw CLI::ValidationError("--dbc", "stands beside --option dbc=…, expected one of them");
  return out;
}

DriverInstance CaptureInput::make_driver() const {
  DriverInstance made = ifog::make_driver(driver_name(), settings());
  for (const std::string& warning : made.warnings()) warn("%s\n", warning.c_str());
  return made;
}

FileKind CaptureInput::kind(const InputFile& file) const {
  if (has_layout()) return FileKind::capture;
  const FileKind found = file_kind(file);
  if (found != FileKind::unknown) return found;
  return has_driver() ? FileKind::bytes : FileKind::capture;
}

RecordingCounts CaptureInput::for_each_sample(InputFile& file, DriverInstance& instance,
                                              const std::function<void(const ifog_sample&)>& sink) const {
  const RecordingCounts counts = decode_recording(file, instance, instance.takes_can() ? channel : "", sink);
  if (counts.samples != 0) return counts;
  std::string why;
  for (const std::string& loss : losses(counts)) why += (why.empty() ? "" : "; ") + loss;
  throw std::runtime_error(file.path() + ": driver " + driver_name() + " finds no sample in it" +
                           (why.empty() ? "" : " (" + why + ")"));
}

Capture CaptureInput::read(const std::string& path, std::string* sha256) const {
  InputFile file(path);
  if (sha256 == nullptr) return read(file);
  std::string text = file.bytes();
  *sha256 = sha256_hex(text);
  InputFile at_hand(path, std::move(text));
  return read(at_hand);
}

Capture CaptureInput::read_flight(InputFile& file) const {
  if (recorded_messages(file)) return read_lcm_log(file, channel);
  FlightInput flight(file);
  DriverInstance instance = flight.make_driver(driver_name(), settings());
  return flight.capture(instance);
}

Capture CaptureInput::read(InputFile& file) const {
  const std::string& path = file.path();
  const FileKind found = kind(file);
  if (found == FileKind::capture) {
    if (has_driver())
      throw std::runtime_error(path + ": is a CSV capture, expected none of --driver and --dbc with it");
    return parse(file.text(), path);
  }
  if (found == FileKind::lcm_log) return read_lcm_log(file, channel);
  if (found == FileKind::flight) return read_flight(file);
  if (!has_driver())
    throw std::runtime_error(path +
                             ": is no CSV capture, expected --driver NAME (or --dbc FILE) to decode it with");
  DriverInstance instance = make_driver();
  CaptureBuilder builder(instance.description());
  RecordingCounts counts;
  try {
    counts = for_each_sample(file, instance, [&](const ifog_sample& sample) { builder.add(sample); });
  } catch (const std::runtime_error& error) {
    const std::string line = error.what();
    throw std::runtime_error(line.starts_with(path) ? line : path + ": " + line);
  }
  for (const std::string& loss : losses(counts)) warn("%s: %s\n", path.c_str(), loss.c_str());
  if (builder.missing() != 0)
    warn("%s: %zu samples are missing by the device's counter\n", path.c_str(), builder.missing());
  return builder.finish();
}

}  // namespace ifog::tools
