// SPDX-License-Identifier: Apache-2.0
// ifog proposals: lists the models that were found at night and not adopted.
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "drivers/ifog/quoted.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/options/command.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/field/field.h"
#include "tools/ifog/field/proposal.h"

namespace ifog::tools {
namespace {

struct ProposalsArguments {
  FieldOptions field;
  std::string json;
};

// Reason why `adopt` would refuse it; "": none.
std::string why_stale(const Field& field, const Proposal& proposal) {
  if (field.config() == nullptr) return "";
  for (const SensorConfig& sensor : field.config()->sensors)
    if (sensor.name == proposal.sensor)
      return model_in_use(field, sensor).name != proposal.against ? ", which is no longer in use" : "";
  return "; " + field.config_path() + " has no such sensor";
}

void list_proposals(const ProposalsArguments& arguments) {
  will_write("--json", arguments.json, kJsonEndings);
  const Field field(arguments.field);
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  bool damaged = false, any = false;
  for (const std::string& name : sensors_with_proposal(field.state())) {
    try {
      const std::optional<Proposal> found = read_proposal(field.state(), name);
      if (!found) continue;  // adopted meanwhile
      any = true;
      const std::string why_not = why_stale(field, *found);
      const std::string report = (std::filesystem::path(field.state()) / found->report_file).string();
      say("{}  of {} against model {}{}{}\n  {}\n  report {}\n", name, printable(found->made),
          found->against.identity.empty() ? "none" : printable(found->against.identity), printable(why_not),
          why_not.empty() ? "" : ": not to be adopted", printable(found->why, kLongestMessage), report);
      if (why_not.empty()) say("  adopt with: {}\n", field.command("adopt", name));
      all.push_back({{"sensor", name},
                     {"made", found->made},
                     {"why", found->why},
                     {"against", found->against.identity},
                     {"model", found->model.identity},
                     {"stale", !why_not.empty()},
                     {"report", report},
                     {"gain", as_json(found->gain)}});
    } catch (const std::exception& error) {
      warn("{}\n", error.what());
      damaged = true;
    }
  }
  if (!any && !damaged) say("no proposal waits in {}\n", field.state());
  if (!arguments.json.empty())
    write_json(arguments.json, nlohmann::ordered_json{{"schema", "ifog.proposals/1"}, {"proposals", all}});
  if (damaged) throw Failed("damaged");
}

}  // namespace

void add_proposals(const Command& program) {
  auto arguments = std::make_shared<ProposalsArguments>();
  const Command command =
      program.add_subcommand("proposals", "List the models that the nights have proposed");
  arguments->field.add_to(command);
  command.add_option("--json", arguments->json, "write them as JSON, schema ifog.proposals/1");
  command.callback([arguments] { list_proposals(*arguments); });
}

}  // namespace ifog::tools
