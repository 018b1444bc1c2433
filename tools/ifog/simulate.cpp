// SPDX-License-Identifier: Apache-2.0
// ifog simulate: a capture from a scenario file; with --truth also the true values.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "drivers/capture/files/file_kind.h"
#include "drivers/capture/files/output_file.h"
#include "drivers/capture/recording.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/capture_output.h"
#include "tools/ifog/captures/table/long_table.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/simulate/simulator.h"

namespace ifog::tools {
namespace {

struct Simulate {
  CaptureInput encoding;
  std::string scenario, output, truth, axis;
  std::optional<std::uint64_t> seed;

  void run() const {
    expect_capture_name("--output", output, &encoding);
    expect_ending("--truth", truth,
                  boost::iends_with(unpacked_name(truth), ".json") || file_kind(truth) == FileKind::capture,
                  std::string(".json, ").append(kColumnEndings));
    simulate::Scenario s = simulate::read_scenario(scenario, seed ? &*seed : nullptr);
    const simulate::Simulation made = naming(scenario, [&s] {
      Progress progress("simulating", 0);
      return simulate::simulate(s, progress.teller());
    });
    if (file_kind(output) == FileKind::capture || (is_standard_output(output) && !encoding.has_driver())) {
      if (encoding.has_driver())
        throw WrongUsage(output,
                         "is a capture in columns, which no driver encodes; expected .kvh, .bin or .log");
      write_columns(long_table(made.capture), scenario, output);
      say("{}: {} samples\n", output, made.capture.size());
    } else {
      write_recording(long_table(made.capture), scenario, output, encoding, axis);
    }
    if (truth.empty()) return;
    if (file_kind(truth) == FileKind::capture)
      write_columns(long_table(simulate::truth_capture(made.truth, made.capture)), scenario, truth);
    else
      write_file(truth, simulate::truth_json(made.truth));
    say("{}: the truth\n", truth);
  }
};

}  // namespace

void add_simulate(const Command& program) {
  auto state = std::make_shared<Simulate>();
  const Command command =
      program.add_subcommand("simulate", "Make a capture of a simulated gyro from a scenario file");
  command.add_option("SCENARIO", state->scenario, "Scenario (.toml)",
                     {.required = true, .file = FileUse::read});
  command.add_option("-o,--output", state->output,
                     "Capture: .csv, .csv.gz, .h5; through a driver .kvh, .bin or .log",
                     {.required = true, .file = FileUse::written});
  command.add_option("--truth", state->truth,
                     "Write what the capture does not tell: .json the parameters, .csv or .h5 the true rate "
                     "and each effect",
                     {.file = FileUse::written});
  command.add_option("--seed", state->seed, "Instead of the scenario's");
  state->encoding.add_driver_to(command);
  command.add_option("--axis", state->axis, "Axis of the driver that a single-axis capture goes to");
  command.footer(
      "Examples:\n  ifog simulate /usr/share/ifogd/scenarios/rest.toml --output rest.csv.gz --truth "
      "rest.truth.json");
  command.callback([state] { state->run(); });
}

}  // namespace ifog::tools
