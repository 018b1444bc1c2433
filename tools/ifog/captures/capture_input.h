// SPDX-License-Identifier: Apache-2.0
// Reads a capture of any kind: CSV and HDF5 directly; raw bytes and candump logs with a driver; flight
// recordings with the driver that they name, or another; LCM logs.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/recording.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/host/driver_instance.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/table/long_table.h"
#include "tools/ifog/console/command.h"

namespace ifog::tools {

// What an analysis wants of the captures of one sensor.
struct Preparation {
  TimePart part;
  const Model* model = nullptr;                 // its effects are subtracted; null: none
  std::string model_path = {};                  // for messages
  std::optional<double> since_power_up_s = {};  // instead of what a recording says
  LongTableSink::Wanted wanted = {};            // columns; empty: all
  bool hashed = false;
};

// Without the rows outside of the part and the axes that are not usable in all captures.
struct PreparedCaptures {
  std::vector<LongCapture> read;
  std::vector<std::vector<Samples>> corrected;  // rates
  std::vector<CaptureView> views;               // of these
  std::vector<std::string> hashes;              // SHA-256 of the unpacked files; "" unless wanted
};

struct CaptureInput {
  std::string driver;                // --driver NAME; "dbc" if only --dbc is given
  std::vector<std::string> options;  // --option KEY=VALUE
  std::string dbc;                   // --dbc F: the driver option `dbc`
  std::string channel;               // --channel C: CAN interface of a candump log, or channel of an LCM log

  // Options for a CSV or HDF5 file whose header is not that of a capture; see csv_layout.h.
  std::vector<std::string> columns;  // --column NAME=HEADER:UNIT
  std::string time;                  // --time HEADER:UNIT
  double sample_rate_hz = 0.0;       // --sample-rate HZ; 0: not given
  std::string only;                  // --only HEADER=VALUE
  std::string repeats = "drop";      // --repeats keep|drop
  std::string separator;             // --separator C, of CSV
  std::string group;                 // --group PATH, of HDF5
  bool other_rates = false;          // set by commands that detect rest; see csv_layout.h
  bool outlined = false;             // set by commands that outline unwanted channels; see long_table.h

  // Adds the options to a command that reads captures.
  void add_to(const Command& command);
  // Adds only the driver's options, to a command that writes its frames. The files that they name are
  // registered as inputs of the run.
  void add_driver_to(const Command& command);
  // The given options in shell syntax: " --driver kvh1750 --option format=b".
  [[nodiscard]] std::string as_typed() const;

  [[nodiscard]] bool has_driver() const { return !driver.empty() || !dbc.empty(); }

  // The driver's name and settings. Throws WrongUsage if an option is not KEY=VALUE.
  [[nodiscard]] std::string driver_name() const;
  [[nodiscard]] DriverSettings settings() const;

  // The layout of a file of columns, from its options.
  [[nodiscard]] CsvLayout layout() const;
  [[nodiscard]] bool has_layout() const {
    return !columns.empty() || !time.empty() || !separator.empty() || !group.empty() || !only.empty() ||
           sample_rate_hz > 0.0;
  }

  // Throws std::runtime_error with one line. folders: search path of plugins; empty: the standard folders.
  [[nodiscard]] DriverInstance make_driver(const std::vector<std::string>& folders = {}) const;

  // Kind as it will be read: CSV if its columns are given; an unknown file is CSV without a driver and bytes
  // with one.
  [[nodiscard]] FileKind kind(const InputFile& file) const;

  // Samples as the driver delivers them, bit for bit as the daemon gets them. Prints what the driver rejected on
  // standard error, one line per counter. Throws std::runtime_error with one line, also if the driver finds nothing in
  // the file.
  void for_each_sample(InputFile& file, DriverInstance& instance,
                       const std::function<void(const ifog_sample&)>& sink) const;

  // Reads any kind in blocks; the only place that distinguishes formats. Throws as above.
  RowNotes read_rows(InputFile& file, RowSink& sink) const;
  // Reads a table of any length with the wanted columns; empty: all.
  [[nodiscard]] LongTable read_long(InputFile& file, const LongTableSink::Wanted& wanted = {}) const;
  // Reads the captures of one sensor. Throws as above, and as unusable_axes() and compensated_rates().
  [[nodiscard]] PreparedCaptures prepared(const std::vector<std::string>& paths,
                                          const Preparation& how) const;
  // Reads a file of columns even if a driver is given, which is then for writing.
  [[nodiscard]] LongTable read_long_columns(InputFile& file, const LongTableSink::Wanted& wanted = {}) const;

 private:
  RowNotes column_rows(InputFile& file, RowSink& sink) const;
  [[nodiscard]] FileKind readable(const InputFile& file) const;
  [[nodiscard]] bool holds_rates(const InputFile& file, FileKind found) const;
};

}  // namespace ifog::tools
