// SPDX-License-Identifier: Apache-2.0
// What the head of a flight recording says: all that reading it later needs, so that it goes through the
// driver and the configuration that recorded it on another computer, in another year.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

inline constexpr std::uint16_t kFlightVersion = 1;  // of the format

struct FlightHeader {
  enum class Carries { bytes, can, messages };

  std::uint64_t file = 0;    // random, of this file: the checksums of its blocks hold in no other
  std::uint64_t run = 0;     // random, of the recorder's run
  std::uint64_t number = 0;  // of the file in its folder; the next of the same run goes on where this ends
  std::uint64_t began = 0;   // number of the file that the run began with; 0: not known
  // Number, within the run, of the settings that everything in the file was filtered with: 0 from its beginning, another from
  // the file's first sample on.
  std::uint32_t settings = 0;
  std::int64_t opened_ns = 0;  // wall clock
  std::string program;         // version of what recorded
  std::string sensor;
  Carries carries = Carries::bytes;
  std::string source;     // of the bytes, in words: "/dev/ttyUSB0", "can0"
  std::string interface;  // that CAN frames came on, by a log of candump too; "": not known
  std::string driver;     // "" for messages
  std::map<std::string, std::string> options;  // of the driver
  std::vector<std::string> channels;           // those that came from elsewhere, by their index
  std::optional<std::int64_t> powered_ns;      // arrival clock when the sensor was switched on
  std::string boot;  // of the computer's run in which powered_ns was, as its kernel names it; "": not known
  std::string configuration;                 // the sensor's part of ifogd.toml, as text
  std::string configuration_file;            // where that stood
  std::map<std::string, std::string> files;  // what options and configuration name, by path: DBC, model

  bool operator==(const FlightHeader&) const = default;
};

// The payload of a header block, and back. Unknown keys are ignored: a later version may say more.
std::vector<std::uint8_t> header_payload(const FlightHeader& header);
// Throws std::runtime_error with what is wrong with it, without the file's name: another version of the
// format, a line that is none.
FlightHeader parse_header(std::span<const std::uint8_t> payload);

}  // namespace ifog
