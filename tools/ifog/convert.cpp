// ifog convert: a capture to what a device would have sent, and back.
#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "drivers/capture/candump.h"
#include "drivers/capture/capture_encoder.h"
#include "drivers/capture/text_file.h"
#include "tools/ifog/capture_input.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/progress.h"

namespace ifog::tools {
namespace {

struct Convert {
  CaptureInput input;
  std::string from, to, axis;

  void run() const;

 private:
  void encode() const;
  void to_bytes(CaptureEncoder& encoder, std::size_t rows) const;
  void to_candump(CaptureEncoder& encoder, std::size_t rows) const;
};

constexpr std::size_t kProgressStep = 4096;  // rows

void Convert::to_bytes(CaptureEncoder& encoder, std::size_t rows) const {
  std::vector<std::uint8_t> bytes;
  Progress progress("encoding", rows);
  while (encoder.next(bytes))
    if (encoder.rows_done() % kProgressStep == 0) progress.at(encoder.rows_done());
  write_text_file(to, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  std::printf("%s: %zu samples, %zu bytes\n", to.c_str(), rows - encoder.rows_left_out(), bytes.size());
}

void Convert::to_candump(CaptureEncoder& encoder, std::size_t rows) const {
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
  std::printf("%s: %zu samples in %zu frames on %s\n", to.c_str(), rows - encoder.rows_left_out(), count,
              interface.c_str());
}

void Convert::encode() const {
  if (!input.has_driver())
    throw CLI::ValidationError(to,
                               "is no CSV capture, expected --driver NAME (or --dbc FILE) to encode it with");
  const Capture capture = read_capture(from);
  const auto plugin = find_plugin(input.driver_name(), plugin_folders());
  DriverInstance driver(plugin, with_rate_of(capture, *plugin, input.settings()));
  const bool log = file_kind(to) == FileKind::candump;
  if (log != driver.takes_can())
    throw CLI::ValidationError(to,
                               "driver " + input.driver_name() + " speaks " +
                                   (driver.takes_can() ? "CAN, expected a name ending in .log"
                                                       : "bytes, expected a name ending in .bin or .kvh"));
  try {
    CaptureEncoder encoder(capture, driver, axis);
    for (const std::string& notice : encoder.notices())
      std::fprintf(stderr, "%s: %s\n", from.c_str(), notice.c_str());
    if (log)
      to_candump(encoder, capture.size());
    else
      to_bytes(encoder, capture.size());
    if (encoder.rows_left_out() != 0)
      std::fprintf(stderr, "%s: %zu rows without a rate are left out: the format cannot say so\n",
                   from.c_str(), encoder.rows_left_out());
  } catch (const std::runtime_error& error) {
    const std::string line = error.what();
    throw std::runtime_error(line.starts_with(from) || line.starts_with(to) ? line : from + ": " + line);
  }
  if (driver.description().nominal_rate_hz > 0.0 && input.settings().count("rate_hz") == 0)
    std::printf("to decode it again, add --option rate_hz=%.7g\n", driver.description().nominal_rate_hz);
}

void Convert::run() const {
  const bool from_csv = file_kind(from) == FileKind::capture;
  const bool to_csv = file_kind(to) == FileKind::capture;
  if (from_csv && !to_csv) return encode();
  if (!to_csv)
    throw CLI::ValidationError(to, "expected a .csv or .csv.gz file, or a capture in .csv to convert from");
  const Capture capture = input.read(from);
  write_capture(capture, to);
  std::printf("%s: %zu samples\n", to.c_str(), capture.size());
}

}  // namespace

void add_convert(CLI::App& app) {
  auto state = std::make_shared<Convert>();
  CLI::App* command =
      app.add_subcommand("convert", "Turn a capture into a device's bytes or CAN frames, or back");
  command
      ->add_option("FROM", state->from,
                   "Capture (.csv, .csv.gz), bytes (.bin, .kvh), candump log (.log), LCM log")
      ->required();
  command->add_option("TO", state->to, "What to make of it, by its ending: .csv, .csv.gz, .bin, .kvh, .log")
      ->required();
  state->input.add_to(*command);
  command->add_option("--axis", state->axis, "Axis of the driver that a single-axis capture goes to")
      ->type_name("NAME");
  command->footer(
      "Examples:\n"
      "  ifog convert gyro.csv gyro.kvh --driver kvh1750 --option format=b\n"
      "  ifog convert gyro.kvh back.csv --driver kvh1750 --option format=b --option rate_hz=200\n"
      "  ifog convert gyro.csv gyro.log --dbc gyro.dbc --option signal=Rate_x --option counter=Counter");
  command->callback([state] { state->run(); });
}

}  // namespace ifog::tools
