// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/capture_output.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "drivers/capture/candump.h"
#include "drivers/capture/capture_encoder.h"
#include "drivers/capture/output_file.h"
#include "drivers/capture/text_file.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

constexpr std::size_t kProgressStep = 4096;  // rows

void to_bytes(CaptureEncoder& encoder, std::size_t rows, const std::string& to) {
  std::vector<std::uint8_t> bytes;
  Progress progress("encoding", rows);
  while (encoder.next(bytes))
    if (encoder.rows_done() % kProgressStep == 0) progress.at(encoder.rows_done());
  write_text_file(to, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  say("%s: %zu samples, %zu bytes\n", to.c_str(), rows - encoder.rows_left_out(), bytes.size());
}

void to_candump(CaptureEncoder& encoder, std::size_t rows, const std::string& to, const CaptureInput& input) {
  const std::string interface = input.channel.empty() ? "vcan0" : input.channel;
  std::string text;
  std::size_t count = 0;
  std::vector<ifog_can_frame> frames;
  std::array<char, kCandumpLineMax> line{};
  Progress progress("encoding", rows);
  while (encoder.next(frames)) {
    for (const ifog_can_frame& frame : frames)
      text.append(line.data(), format_candump_line(frame, interface, line.data()));
    count += frames.size();
    frames.clear();
    if (encoder.rows_done() % kProgressStep == 0) progress.at(encoder.rows_done());
  }
  write_text_file(to, text);
  say("%s: %zu samples in %zu frames on %s\n", to.c_str(), rows - encoder.rows_left_out(), count,
      interface.c_str());
}

}  // namespace

void write_recording(const Capture& capture, const std::string& from, const std::string& to,
                     const CaptureInput& input, const std::string& axis) {
  if (!input.has_driver())
    throw CLI::ValidationError(to,
                               "is no CSV capture, expected --driver NAME (or --dbc FILE) to encode it with");
  const auto plugin = find_plugin(input.driver_name(), plugin_folders());
  DriverInstance driver(plugin, with_rate_of(capture, *plugin, input.settings()));
  const bool log = is_standard_output(to) ? driver.takes_can() : file_kind(to) == FileKind::candump;
  if (log != driver.takes_can())
    throw CLI::ValidationError(to,
                               "driver " + input.driver_name() + " speaks " +
                                   (driver.takes_can() ? "CAN, expected a name ending in .log"
                                                       : "bytes, expected a name ending in .bin or .kvh"));
  try {
    CaptureEncoder encoder(capture, driver, axis);
    for (const std::string& notice : encoder.notices()) warn("%s: %s\n", from.c_str(), notice.c_str());
    if (log)
      to_candump(encoder, capture.size(), to, input);
    else
      to_bytes(encoder, capture.size(), to);
    if (encoder.rows_left_out() != 0)
      warn("%s: %zu rows without a rate are left out: the format cannot say so\n", from.c_str(),
           encoder.rows_left_out());
  } catch (const std::runtime_error& error) {
    const std::string line = error.what();
    throw std::runtime_error(line.starts_with(from) || line.starts_with(to) ? line : from + ": " + line);
  }
  if (driver.description().nominal_rate_hz > 0.0 && input.settings().count("rate_hz") == 0)
    say("to decode it again, add --option rate_hz=%.7g\n", driver.description().nominal_rate_hz);
}

}  // namespace ifog::tools
