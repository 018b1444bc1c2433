// SPDX-License-Identifier: Apache-2.0
// Header of a flight recording: everything that is needed to replay it on another computer with the driver
// and configuration that recorded it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

inline constexpr std::uint16_t kFlightVersion = 1;  // version of the format

struct FlightHeader {
  enum class Carries { bytes, can, messages };

  std::uint64_t file = 0;    // random, of this file; part of its blocks' checksums
  std::uint64_t run = 0;     // random, of the recorder's run
  std::uint64_t number = 0;  // of the file in its folder; consecutive within a run
  std::uint64_t began = 0;   // number of the run's first file; 0: unknown
  // Number, within the run, of the filter settings for the file's samples; 0 from the run's beginning.
  std::uint32_t settings = 0;
  std::int64_t opened_ns = 0;  // wall clock
  std::string program;         // version of the recording program
  std::string sensor;
  Carries carries = Carries::bytes;
  std::string source;                          // of the bytes, as text: "/dev/ttyUSB0", "can0"
  std::string interface;                       // of CAN frames, also for a candump log; "": unknown
  std::string driver;                          // "" for messages
  std::map<std::string, std::string> options;  // of the driver
  std::vector<std::string> channels;           // external channels, by their index
  std::optional<std::int64_t> powered_ns;      // arrival clock at power-up of the sensor
  std::string boot;                            // kernel's boot id of the computer for powered_ns; "": unknown
  std::string configuration;                   // the sensor's part of ifogd.toml
  std::string configuration_file;              // its path
  std::map<std::string, std::string> files;  // files named by options and configuration, by path: DBC, model

  bool operator==(const FlightHeader&) const = default;
};

// Payload of a header block, and the inverse. Unknown keys are ignored, for later versions.
std::vector<std::uint8_t> header_payload(const FlightHeader& header);
// Throws std::runtime_error with the error, without the file's name: another version of the format, an
// invalid line.
FlightHeader parse_header(std::span<const std::uint8_t> payload);

}  // namespace ifog
