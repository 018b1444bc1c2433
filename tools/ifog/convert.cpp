// SPDX-License-Identifier: Apache-2.0
// ifog convert: a capture to a recording of a device, and back.
#include <memory>
#include <string>

#include "drivers/capture/files/output_file.h"
#include "drivers/system/shell_word.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/capture_output.h"
#include "tools/ifog/captures/lcm/lcm_events.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

struct Convert {
  CaptureInput input;
  std::string from, to, axis;

  void run() const;
};

void Convert::run() const {
  expect_capture_name("TO", to, &input);
  InputFile file(from);
  const bool from_columns = input.has_layout() || file_kind(file) == FileKind::capture;
  // Standard output has no file ending: the format is the one that the input does not have.
  const bool to_columns =
      file_kind(to) == FileKind::capture || (is_standard_output(to) && !(from_columns && input.has_driver()));
  if (from_columns && !to_columns) {
    LongTable table = input.read_long_columns(file);
    table.clean_and_tell(leave_out_placeholders, from);
    return write_recording(table, from, to, input, axis);
  }
  if (!to_columns && file_kind(file) == FileKind::flight && !recorded_messages(file))
    throw WrongUsage(to,
                     "expected a .csv, .csv.gz or .h5 file of a flight recording; its bytes or frames as "
                     "they came are written by: ifog replay " +
                         shell_file(from) + " --speed 0 --to " + shell_word("file:" + to));
  if (!to_columns)
    throw WrongUsage(to, "expected a .csv, .csv.gz or .h5 file, or a capture in one to convert from");
  LongTable table = input.read_long(file);
  if (from_columns) table.clean_and_tell(leave_out_placeholders, from);
  write_columns(table, from, to);
  say("{}: {} samples\n", to, table.size());
}

}  // namespace

void add_convert(const Command& program) {
  auto state = std::make_shared<Convert>();
  const Command command =
      program.add_subcommand("convert", "Turn a capture into a device's bytes or CAN frames, or back");
  command.add_option(
      "FROM", state->from,
      "Capture (.csv, .csv.gz, .h5), flight recording (.ifr or its folder), bytes (.bin, .kvh), candump "
      "log (.log), LCM log",
      {.required = true, .file = FileUse::read});
  command.add_option("TO", state->to,
                     "What to make of it, by its ending: .csv, .csv.gz, .h5, .bin, .kvh, .log",
                     {.required = true, .file = FileUse::written});
  state->input.add_to(command);
  command.add_option("--axis", state->axis, "Axis of the driver that a single-axis capture goes to");
  command.footer(
      "Examples:\n"
      "  ifog convert gyro.csv gyro.kvh --driver kvh1750 --option format=b\n"
      "  ifog convert gyro.kvh back.csv --driver kvh1750 --option format=b --option rate_hz=200\n"
      "  ifog convert gyro.csv gyro.log --dbc gyro.dbc --option signal=Rate_x --option counter=Counter");
  command.callback([state] { state->run(); });
}

}  // namespace ifog::tools
