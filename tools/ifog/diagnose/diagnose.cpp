// SPDX-License-Identifier: Apache-2.0
// ifog diagnose: the components of the error, the correctable ones and the rest.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/capture/files/output_file.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/diagnose/sensor_diagnosis.h"
#include "tools/ifog/tune/noise_at_rest.h"

namespace ifog::tools {
namespace {

struct DiagnoseArguments {
  CaptureInput input;
  TimePart part;
  std::vector<std::string> captures;
  std::string model, write_model, json, report;
  AxesToDiagnose wanted;
  std::optional<double> since_power_up_s;
  bool quiet = false;
};

void run_diagnose(const DiagnoseArguments& arguments) {
  Model model;
  if (!arguments.model.empty()) model = read_model(arguments.model);
  const PreparedCaptures prepared = arguments.input.prepared(
      arguments.captures, {.part = arguments.part,
                           .model = &model,
                           .model_path = arguments.model,
                           .since_power_up_s = arguments.since_power_up_s,
                           // For the model file and the page, which list their captures.
                           .hashed = !arguments.write_model.empty() || !arguments.report.empty()});
  const std::vector<CaptureView>& captures = prepared.views;
  const std::vector<std::string>& hashes = prepared.hashes;
  const std::vector<AxisDiagnosis> found = diagnose_axes(captures, arguments.captures, arguments.wanted);
  if (!arguments.quiet) {
    for (const AxisDiagnosis& each : found)
      say("{}{}", &each == &found.front() ? "" : "\n", diagnosis_text(each));
  }
  write_json(arguments.json, diagnosis_json(found));
  if (!arguments.write_model.empty()) {
    model = model_with(std::move(model), found, arguments.captures, hashes);
    const std::size_t longest = static_cast<std::size_t>(
        std::ranges::max_element(captures, {}, &CaptureView::size) - captures.begin());
    const std::string fitted = fit_noise_left(model, model_with({}, found, arguments.captures, hashes),
                                              captures[longest], arguments.captures[longest]);
    if (!arguments.quiet && !fitted.empty()) say("\n{}\n", fitted);
    write_file(arguments.write_model, model_text(model));
  }
  if (arguments.quiet) forget_written_files();
  if (!arguments.report.empty())
    write_file(arguments.report, diagnosis_report(captures, found, arguments.captures, hashes,
                                                  arguments.write_model, arguments.input.as_typed()));
}

}  // namespace

void add_diagnose(const Command& program) {
  auto arguments = std::make_shared<DiagnoseArguments>();
  const Command command =
      program.add_subcommand("diagnose", "Trace the error to its effects, with the model that corrects them");
  command.add_option("capture", arguments->captures, "captures of one sensor, fitted together",
                     {.required = true, .file = FileUse::read});
  arguments->input.add_to(command);
  arguments->part.add_to(command);
  command.add_option("--axis", arguments->wanted.axes, "only these axes");
  command.add_option("--model", arguments->model, "correct with this model first; find what it leaves",
                     kReadsFile);
  command.add_option(
      "--since-power-up", arguments->since_power_up_s,
      "seconds from power-up to the captures' first sample: a warm_up of --model is corrected, "
      "and one that is found counts from power-up; default: as a recording says it",
      {.range = not_negative()});
  command.add_option("--write-model", arguments->write_model, "write the model with what was found",
                     {.file = FileUse::written, .endings = kModelEndings});
  command.add_option("--json", arguments->json, "write the diagnosis as JSON", kWritesJson);
  command.add_option("--report", arguments->report, "write the diagnosis as one self-contained HTML page",
                     {.file = FileUse::written, .endings = kPageEndings});
  command.add_option("--significance", arguments->wanted.options.significance,
                     "chance of a false effect, after correction for all tried",
                     {.shows_default = true, .range = within(1e-9, 0.5)});
  command.add_option("--fit-from", arguments->wanted.options.fit_from,
                     "fit from this share of each capture's time; the rest judges",
                     {.range = within(0.0, 0.9)});
  command.add_option("--fit-to", arguments->wanted.options.fit_to,
                     "fit up to this share of each capture's time; the rest judges",
                     {.range = within(0.1, 1.0)});
  arguments->wanted.add_earth_to(command);
  command.add_flag("--allow-motion-channels", arguments->wanted.options.allow_motion_channels,
                   "without a reference rate, too, trace error to channels that sense motion: what they "
                   "explain may be rotation");
  command.add_flag("--allow-proxies", arguments->wanted.options.allow_proxies,
                   "correct by coefficients beyond what makers specify, too");
  command.add_flag("--quiet", arguments->quiet, "no report on the console");
  command.callback([arguments] { run_diagnose(*arguments); });
}

}  // namespace ifog::tools
