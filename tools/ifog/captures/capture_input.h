// A capture of any kind as the commands take it: CSV as it is; raw bytes and candump logs through a driver;
// LCM logs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/capture/recording.h"
#include "drivers/host/driver_instance.h"

namespace CLI {
class App;
}

namespace ifog::tools {

struct CaptureInput {
  std::string driver;                // --driver NAME; "dbc" when only --dbc is given
  std::vector<std::string> options;  // --option KEY=VALUE
  std::string dbc;                   // --dbc F: the driver option `dbc`
  std::string channel;  // --channel C: of a candump log the CAN interface, of an LCM log the channel

  // Adds the four options to a command.
  void add_to(CLI::App& command);

  [[nodiscard]] bool has_driver() const { return !driver.empty() || !dbc.empty(); }

  // The driver's name and settings of the options above. Throws CLI::ValidationError (usage) on an option
  // that is no KEY=VALUE.
  [[nodiscard]] std::string driver_name() const;
  [[nodiscard]] DriverSettings settings() const;

  // Throws std::runtime_error with one line.
  [[nodiscard]] DriverInstance make_driver() const;

  // As it will be read: where neither name nor first bytes tell, CSV without a driver and bytes with one.
  [[nodiscard]] FileKind kind(const InputFile& file) const;

  // The recorded samples as the driver delivers them, bit for bit those that the daemon gets.
  // Throws std::runtime_error with one line, also when the driver finds nothing in the file.
  RecordingCounts for_each_sample(InputFile& file, DriverInstance& instance,
                                  const std::function<void(const ifog_sample&)>& sink) const;

  // Any kind as columns. What the driver could not use is told on standard error, one line a counter that
  // moved. Throws std::runtime_error with one line.
  // `sha256`, where it is wanted: of the file as it was unpacked.
  [[nodiscard]] Capture read(InputFile& file) const;
  [[nodiscard]] Capture read(const std::string& path, std::string* sha256 = nullptr) const;
};

// "3 frames with a wrong checksum", … : one line for each counter that says something was lost.
std::vector<std::string> losses(const RecordingCounts& counts);

}  // namespace ifog::tools
