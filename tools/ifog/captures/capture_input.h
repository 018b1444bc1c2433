// SPDX-License-Identifier: Apache-2.0
// A capture of any kind as the commands take it: CSV and HDF5 as they are; raw bytes and candump logs through
// a driver; flight recordings through the driver that they name, or another; LCM logs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/capture/recording.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/host/driver_instance.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/table/long_table.h"
#include "tools/ifog/console/options/command.h"

namespace ifog {
class CaptureBuilder;
}  // namespace ifog

namespace ifog::tools {

struct CaptureInput {
  std::string driver;                // --driver NAME; "dbc" when only --dbc is given
  std::vector<std::string> options;  // --option KEY=VALUE
  std::string dbc;                   // --dbc F: the driver option `dbc`
  std::string channel;  // --channel C: of a candump log the CAN interface, of an LCM log the channel

  // Options for a CSV or HDF5 file that is no capture by its header, see csv_layout.h.
  std::vector<std::string> columns;  // --column NAME=HEADER:UNIT
  std::string time;                  // --time HEADER:UNIT
  double sample_rate_hz = 0.0;       // --sample-rate HZ; 0: not given
  std::string only;                  // --only HEADER=VALUE
  std::string repeats = "drop";      // --repeats keep|drop
  std::string separator;             // --separator C, of CSV
  std::string group;                 // --group PATH, of HDF5
  bool other_rates = false;          // for a command that judges rest; see csv_layout.h
  bool outlined = false;             // for one that looks at channels it does not want; see long_table.h

  // Adds the options to a command that reads.
  void add_to(const Command& command);
  // Only those of a driver, to a command that writes its frames.
  void add_driver_to(const Command& command);
  // What of it was given, as a shell takes it again: " --driver kvh1750 --option format=b".
  [[nodiscard]] std::string as_typed() const;

  [[nodiscard]] bool has_driver() const { return !driver.empty() || !dbc.empty(); }

  // The driver's name and settings of the options above. Throws WrongUsage (usage) on an option
  // that is no KEY=VALUE.
  [[nodiscard]] std::string driver_name() const;
  [[nodiscard]] DriverSettings settings() const;

  // Likewise of the options of a file of columns.
  [[nodiscard]] CsvLayout layout() const;
  [[nodiscard]] bool has_layout() const {
    return !columns.empty() || !time.empty() || !separator.empty() || !group.empty() || !only.empty() ||
           sample_rate_hz > 0.0;
  }
  // A file of columns (FileKind::capture) by them, CSV or HDF5, also beside a driver that is there to write
  // with; what may be meant otherwise is printed on standard error.
  [[nodiscard]] Capture read_columns(InputFile& file) const;

  // This capture and what is read to understand it, into the table of the run's files (command_files.h).
  void will_read(const std::string& argument, const std::string& path) const;

  // Throws std::runtime_error with one line.
  // folders: that plugins are looked for in; empty: the standard places.
  [[nodiscard]] DriverInstance make_driver(const std::vector<std::string>& folders = {}) const;

  // As it will be read: CSV where its columns are given; where neither name nor first bytes tell, CSV without
  // a driver and bytes with one.
  [[nodiscard]] FileKind kind(const InputFile& file) const;

  // The recorded samples as the driver delivers them, bit for bit those that the daemon gets.
  // Throws std::runtime_error with one line, also when the driver finds nothing in the file.
  RecordingCounts for_each_sample(InputFile& file, DriverInstance& instance,
                                  const std::function<void(const ifog_sample&)>& sink) const;

  // Any kind in pieces; the one place that tells formats apart. What the driver could not use is told on
  // standard error, one line a counter that moved. Throws std::runtime_error with one line.
  RowNotes read_rows(InputFile& file, RowSink& sink) const;
  // As a table of the columns wanted (all, where that is empty), whatever its length.
  [[nodiscard]] LongTable read_long(InputFile& file, const LongTableSink::Wanted& wanted = {}) const;
  // As a capture. `sha256`, where it is wanted: of the file as it was unpacked.
  [[nodiscard]] LongCapture read_long_capture(const std::string& path, std::string* sha256 = nullptr,
                                              const LongTableSink::Wanted& wanted = {}) const;
  // Reads a file of columns, also where a driver is given that is there to write with.
  [[nodiscard]] LongTable read_long_columns(InputFile& file, const LongTableSink::Wanted& wanted = {}) const;

 private:
  RowNotes column_rows(InputFile& file, RowSink& sink) const;
  [[nodiscard]] FileKind readable(const InputFile& file) const;
  [[nodiscard]] bool holds_rates(const InputFile& file, FileKind found) const;
  void build(InputFile& file, DriverInstance& instance, CaptureBuilder& builder,
             const std::function<void()>& added) const;
  static void keep_rates(LongTable& table, const std::string& path);
  static void tell(const std::vector<std::string>& notices, const std::vector<std::string>& faults);
};

}  // namespace ifog::tools
