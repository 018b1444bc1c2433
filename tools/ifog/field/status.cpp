// SPDX-License-Identifier: Apache-2.0
// ifog status: the sensors of this computer's daemon. ifog proposals: models found at night, not adopted.
#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/replace.hpp>
#include <chrono>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/state/running_mark.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/utc_now.h"
#include "msgs/counters.h"
#include "msgs/state_name.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/field/exchange.h"
#include "tools/ifog/field/field.h"
#include "tools/ifog/field/models.h"
#include "tools/ifog/field/status_text.h"

namespace ifog::tools {
namespace {

using nlohmann::ordered_json;

struct StatusArguments {
  FieldOptions field;
  std::string json;
  bool csv = false;
  double wait_s = 2.5;  // status messages arrive every second
};

std::string utc(std::int64_t utime) { return utc_text(utime / 1'000'000); }

// Data on a sensor in the state folder.
struct Kept {
  ModelName model;
  std::optional<Proposal> proposal;
  std::optional<ModelChange> last;  // of its model
  // Folder of its recordings; "": not recorded; nullopt: no configuration.
  std::optional<std::string> recordings;
  std::string damaged;  // "" or one line
  bool gone = false;    // the configuration has no such sensor
};

Kept kept_of(const Field& field, const std::string& name) {
  Kept out;
  const auto look = [&](auto&& what) {
    try {
      what();
    } catch (const std::exception& error) {
      out.damaged += (out.damaged.empty() ? "" : "; ") + std::string(error.what());
    }
  };
  look([&] {
    if (field.config() == nullptr) return;
    out.gone = true;
    for (const SensorConfig& sensor : field.config()->sensors) {
      if (sensor.name != name) continue;
      out.gone = false;
      out.recordings = sensor.record.folder.empty() ? "" : sensor.record.folder + "/" + name;
      out.model = model_in_use(field, sensor).name;
    }
  });
  look([&] { out.proposal = read_proposal(field.state(), name); });
  look([&] {
    const History history(field.state(), name);
    if (!history.changes().empty()) out.last = history.changes().back();
  });
  return out;
}

std::string losses_text(const status_t& status) {
  std::string out;
  for (const StatusCounter& loss : kStatusCounters)
    if (const std::int64_t count = status.*loss.count; (loss.use & kCounterListed) != 0 && count != 0)
      out += (out.empty() ? "" : ", ") + std::string(loss.name) + " " + std::to_string(count);
  return out.empty() ? "none" : out;
}

void say_live(const status_t& status) {
  say("  losses: {}\n  {}{}\n", losses_text(status), boost::join(books_parts(status), " "),
      books_balance(status) ? ": balanced" : ": DO NOT BALANCE");
  say("  health: {}; {} manoeuvres, {} divergences, {} samples out of the model's range\n",
      axis_health(status.nis_mean, status.whiteness), status.manoeuvres, status.divergences,
      status.out_of_range);
  if (!status.notice.empty()) say("  noticed: {}\n", printable(status.notice, kLongestMessage));
}

void say_recorded(const status_t* live, const std::optional<std::string>& recordings) {
  const bool counted = live != nullptr && live->record_deliveries > 0;
  if (!counted && !recordings) return;
  if (!counted && recordings->empty()) {
    say("  recorded: no, a night has nothing to diagnose ([sensor.record] in the configuration)\n");
    return;
  }
  const std::string where =
      recordings && !recordings->empty() ? " in " + printable(*recordings, kLongestMessage) : "";
  if (live == nullptr)
    say("  recorded:{}\n", where);
  else
    say("  recorded: {} deliveries, {} lost; {:.1f} MB written{}\n", live->record_deliveries,
        live->record_lost, static_cast<double>(live->record_file_bytes) * 1e-6, where);
}

// adopt: the command that adopts the proposal.
void say_sensor(const std::string& name, const status_t* live, const Kept& kept, const std::string& adopt) {
  if (live != nullptr) {
    say("{}  {}{}{}  {} in, {} published\n", printable(name), state_name(live->state),
        live->fault.empty() ? "" : ": ", printable(live->fault, kLongestMessage),
        in_hertz(live->input_rate_hz), in_hertz(live->output_rate_hz));
    say_live(*live);
  } else {
    say("{}  nothing known of now\n", printable(name));
  }
  say_recorded(live, kept.recordings);
  const std::string model = live != nullptr ? live->model : kept.model.identity;
  say("  model: {}{}{}{}\n", model.empty() ? "none" : printable(model),
      live == nullptr ? " when the daemon starts" : "",
      live != nullptr && live->model_since != 0 ? " since " : "",
      live != nullptr && live->model_since != 0 ? utc(live->model_since) : "");
  if (live != nullptr && live->model != kept.model.identity)
    say("  its file holds {}: let the daemon reload\n",
        kept.model.identity.empty() ? "none" : kept.model.identity);
  if (kept.last)
    say("  {} {}{}{}\n", kept.last->what == "adopt" ? "adopted" : "reverted", printable(kept.last->when),
        kept.last->outcome.empty() ? "" : ": ", printable(kept.last->outcome, kLongestMessage));
  if (kept.proposal)
    say("  proposal of {}: {}\n  {}\n", printable(kept.proposal->made),
        printable(kept.proposal->why, kLongestMessage),
        kept.gone                              ? "the configuration has no such sensor: not to be adopted"
        : kept.proposal->against == kept.model ? "adopt with: " + adopt
                                               : "it was made against another model: not to be adopted");
  if (!kept.damaged.empty()) say("  {}\n", kept.damaged);
}

ordered_json sensor_json(const std::string& name, const status_t* live, const Kept& kept) {
  ordered_json out{{"sensor", name}, {"heard", live != nullptr}};
  if (live != nullptr) {
    ordered_json losses;
    for (const StatusCounter& loss : kStatusCounters)
      if ((loss.use & kCounterListed) != 0) losses[loss.name] = live->*loss.count;
    out["state"] = state_name(live->state);
    out["fault"] = live->fault;
    out["input_rate_hz"] = live->input_rate_hz;
    out["output_rate_hz"] = live->output_rate_hz;
    out["losses"] = losses;
    out["books"] = {{"bytes_read", live->bytes_read},
                    {"bytes_framed", live->bytes_framed},
                    {"bytes_skipped", live->bytes_skipped},
                    {"bytes_pending", live->bytes_pending},
                    {"frames_read", live->frames_read},
                    {"samples_decoded", live->samples_decoded},
                    {"samples_in", live->samples_in},
                    {"samples_repeated", live->samples_repeated},
                    {"samples_published", live->samples_published},
                    {"samples_merged", live->samples_merged},
                    {"samples_waiting", live->samples_waiting},
                    {"balanced", books_balance(*live)}};
    out["model"] = live->model;
    out["model_since"] =
        live->model_since != 0 ? ordered_json(utc(live->model_since)) : ordered_json(nullptr);
    out["health"] = {{"nis_mean", live->nis_mean},         {"whiteness", live->whiteness},
                     {"manoeuvres", live->manoeuvres},     {"divergences", live->divergences},
                     {"out_of_range", live->out_of_range}, {"noticed", live->notice}};
    out["recorded"] = {{"deliveries", live->record_deliveries},
                       {"lost", live->record_lost},
                       {"lost_bytes", live->record_lost_bytes},
                       {"written_bytes", live->record_file_bytes},
                       {"files_removed", live->record_removed}};
  }
  out["recordings"] = kept.recordings;
  out["model_file"] = kept.model.identity;
  out["proposal"] = nullptr;
  if (kept.proposal)
    out["proposal"] = {{"made", kept.proposal->made},
                       {"why", kept.proposal->why},
                       {"model", kept.proposal->model.identity},
                       {"stale", kept.gone || kept.proposal->against != kept.model}};
  out["last_change"] = nullptr;
  if (kept.last)
    out["last_change"] = {
        {"what", kept.last->what}, {"when", kept.last->when}, {"outcome", kept.last->outcome}};
  out["damaged"] = kept.damaged;
  return out;
}

// For scripts: JSON values that fit into one line; empty if unknown. New columns are appended only.
std::string csv_line(const ordered_json* sensor) {
  std::string out;
  const auto add = [&](const std::string& name, const std::string& pointer) {
    const ordered_json::json_pointer place(pointer);
    std::string cell = sensor == nullptr ? name : "";
    if (sensor != nullptr && sensor->contains(place)) {
      const ordered_json& value = sensor->at(place);
      if (value.is_string()) cell = printable(value.get<std::string>(), kLongestMessage);
      if (value.is_number() || value.is_boolean()) cell = value.dump();
    }
    if (cell.find_first_of(",\"") != std::string::npos) {
      boost::replace_all(cell, "\"", "\"\"");
      cell = '"' + cell + '"';
    }
    out += (out.empty() ? "" : ",") + cell;
  };
  for (const char* const name : {"sensor", "heard", "state", "input_rate_hz", "output_rate_hz"})
    add(name, std::string("/") + name);
  add("samples_published", "/books/samples_published");
  add("balanced", "/books/balanced");
  for (const StatusCounter& loss : kStatusCounters)
    if ((loss.use & kCounterListed) != 0) add(loss.name, std::string("/losses/") + loss.name);
  for (const char* const name : {"model", "model_since", "model_file", "fault", "damaged"})
    add(name, std::string("/") + name);
  add("proposal", "/proposal/model");
  return out;
}

// Names in the order of the configuration, then further ones.
std::vector<std::string> names_of(const Field& field, const Statuses& statuses) {
  std::vector<std::string> out;
  std::set<std::string> known;
  const auto add = [&](const std::string& name) {
    if (known.insert(name).second) out.push_back(name);
  };
  if (field.config() != nullptr)
    for (const SensorConfig& sensor : field.config()->sensors) add(sensor.name);
  for (const auto& [name, status] : statuses) add(name);
  for (const std::string& name : sensors_with_proposal(field.state())) add(name);
  return out;
}

struct Running {
  std::optional<pid_t> process{};
  Statuses statuses{};
};

// Prints a warning if the daemon cannot be found or does not answer.
Running running(const Field& field, double wait_s) {
  Running out;
  try {
    out.process = running_daemon(field.state());
    if (!out.process) return out;
    LiveStatus live(field.state(), *out.process);
    live.ask(std::chrono::milliseconds(static_cast<std::int64_t>(wait_s * 1e3)),
             [](const auto&) { return true; });
    out.statuses = live.all();
  } catch (const std::exception& error) {
    warn("{}\n", error.what());
  }
  return out;
}

void show_status(const StatusArguments& arguments) {
  const Field field(arguments.field);
  const Running now = running(field, arguments.wait_s);
  const std::string where = "state folder " + field.state();
  if (arguments.csv)
    say("{}\n", csv_line(nullptr));
  else if (now.process)
    say("ifogd runs, process {}, {}\n", *now.process, where);
  else
    say("ifogd does not run with {}; this is what the folder knows\n", where);
  ordered_json sensors = ordered_json::array();
  for (const std::string& name : names_of(field, now.statuses)) {
    const Kept kept = kept_of(field, name);
    const auto found = now.statuses.find(name);
    const status_t* const live = found == now.statuses.end() ? nullptr : &found->second;
    sensors.push_back(sensor_json(name, live, kept));
    if (arguments.csv)
      say("{}\n", csv_line(&sensors.back()));
    else
      say_sensor(name, live, kept, field.command("adopt", name));
  }
  write_json(arguments.json, ordered_json{{"schema", "ifog.status/1"},
                                          {"running", now.process.has_value()},
                                          {"process", now.process},
                                          {"state_folder", field.state()},
                                          {"sensors", sensors}});
}

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
  const Field field(arguments.field);
  ordered_json all = ordered_json::array();
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
                     {"gain", nlohmann::json(found->gain)}});
    } catch (const std::exception& error) {
      warn("{}\n", error.what());
      damaged = true;
    }
  }
  if (!any && !damaged) say("no proposal waits in {}\n", field.state());
  write_json(arguments.json, ordered_json{{"schema", "ifog.proposals/1"}, {"proposals", all}});
  if (damaged) throw Failed("damaged");
}

}  // namespace

void add_status(const Command& program) {
  auto arguments = std::make_shared<StatusArguments>();
  const Command command = program.add_subcommand(
      "status", "All sensors of this computer's daemon: state, losses, model, proposal");
  arguments->field.add_to(command);
  command.add_option("--wait", arguments->wait_s, "wait for the daemon's answer at most so long, s",
                     {.shows_default = true, .type = "SECONDS", .range = within(0.1, 3600.0)});
  command.add_flag("-c,--csv", arguments->csv,
                   "a line a sensor as CSV, for scripts, with the names of its columns first");
  command.add_option("--json", arguments->json, "write it as JSON, schema ifog.status/1", kWritesJson);
  command.callback([arguments] { show_status(*arguments); });
}

void add_proposals(const Command& program) {
  auto arguments = std::make_shared<ProposalsArguments>();
  const Command command =
      program.add_subcommand("proposals", "List the models that the nights have proposed");
  arguments->field.add_to(command);
  command.add_option("--json", arguments->json, "write them as JSON, schema ifog.proposals/1", kWritesJson);
  command.callback([arguments] { list_proposals(*arguments); });
}

}  // namespace ifog::tools
