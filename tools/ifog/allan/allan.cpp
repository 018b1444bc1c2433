// SPDX-License-Identifier: Apache-2.0
// ifog allan: overlapping Allan deviation and noise coefficients of captures.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tools/ifog/allan/allan_record.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/options/command.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/report/picture.h"

namespace ifog::tools {
namespace {

struct AllanArguments {
  CaptureInput input;
  std::vector<std::string> captures;
  AllanOptions options;
  std::string estimator = "overlapping", gaps = "part", moving = "leave-out", json, picture;
};

void run_allan(AllanArguments& a) {
  for (const std::string& capture : a.captures) a.input.will_read("capture", capture);
  will_write("--json", a.json, kJsonEndings);
  will_write("--plot", a.picture);
  a.options.kind = a.estimator == "modified"   ? Deviation::kModified
                   : a.estimator == "hadamard" ? Deviation::kHadamard
                                               : Deviation::kAllan;
  a.options.refuse_gaps = a.gaps == "refuse";
  a.options.keep_motion = a.moving == "keep";
  std::vector<AllanRecord> records;
  {
    Progress progress("Allan", a.captures.size());
    for (std::size_t i = 0; i < a.captures.size(); ++i) {
      InputFile file(a.captures[i]);
      LongTable table = a.input.read_long(file, allan_wants);
      table.clean(leave_out_repeats);
      for (AllanRecord& record : allan_records(a.captures[i], table, a.options))
        records.push_back(std::move(record));
      progress.at(i + 1);
    }
  }
  for (const AllanRecord& record : records) print_allan(record, a.options);
  if (records.size() > 1) print_comparison(records);
  if (!a.json.empty()) write_json(a.json, allan_json(records, a.options), 1);
  if (!a.picture.empty()) draw_allan(a.picture, records);
}

}  // namespace

void add_allan(const Command& program) {
  auto a = std::make_shared<AllanArguments>();
  a->input.other_rates = a->input.outlined = true;
  const Command command = program.add_subcommand(
      "allan",
      "Overlapping Allan deviation with confidence intervals, and the noise coefficients Q, N, B, K, R");
  command.add_option("capture", a->captures, "Captures, or files written by ifog denoise",
                     {.required = true});
  a->input.add_to(command);
  command.add_option("--axis", a->options.axis, "Only this axis (x, y, …)");
  command.add_option("--tau", a->options.tau_s,
                     "Averaging times in s, separated by commas; log-spaced otherwise",
                     {.delimiter = ',', .range = positive()});
  command.add_option("--per-decade", a->options.per_decade, "Points per decade of averaging time",
                     {.shows_default = true, .range = within(1, 1000)});
  command.add_option("--confidence", a->options.confidence, "Of the intervals",
                     {.shows_default = true, .range = within(0.01, 0.9999)});
  command.add_option("--estimator", a->estimator, "overlapping, modified or hadamard",
                     {.shows_default = true, .choices = {"overlapping", "modified", "hadamard"}});
  command.add_option("--gaps", a->gaps,
                     "part: analyse the stretches between holes, of which those are filled that change no "
                     "variance by more than 2 %; refuse: any hole is an error",
                     {.shows_default = true, .choices = {"part", "refuse"}});
  command.add_option("--moving", a->moving,
                     "leave-out: analyse the parts at rest; keep: all of it, as if it had not moved",
                     {.shows_default = true, .choices = {"leave-out", "keep"}});
  command.add_flag("--long", a->options.long_tau,
                   "Thêo1 beyond a quarter of the longest stretch, up to three quarters of it");
  command.add_flag("--minus-reference", a->options.minus_reference, "Analyse rate less reference rate");
  a->options.part.add_to(command);
  command.add_option("--json", a->json, "Write the analysis here, in SI");
  command.add_option("--plot", a->picture, "Write a picture here (.svg or .png)",
                     {.check = report::wrong_picture_name});
  command.callback([a] { run_allan(*a); });
}

}  // namespace ifog::tools
