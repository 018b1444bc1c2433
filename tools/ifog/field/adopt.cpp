// SPDX-License-Identifier: Apache-2.0
// ifog adopt and ifog revert: use a proposed model and watch it; restore the one before.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/ifog/quoted.h"
#include "drivers/system/utc_now.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/field/exchange.h"
#include "tools/ifog/field/models.h"
#include "tools/ifog/field/recorded.h"
#include "tools/ifog/field/status_text.h"

namespace ifog::tools {
namespace {

struct AdoptArguments {
  FieldOptions field;
  std::string sensor, json;
  double watch_s = 600.0;
};

// Observation of a sensor after the exchange of its model: notices of the daemon, and the gain compared with
// the predicted one.
struct Watched {
  double seconds = 0.0;
  bool whole = true;  // not interrupted
  std::uint64_t statuses = 0;
  std::int64_t divergences = 0, gated = 0;  // increase during the watch
  std::string noticed;                      // the daemon's last notice, "" if none
  std::vector<double> nis, whiteness;       // by axis, means over the watch
  std::vector<AxisGain> gain;               // from the recording
  std::string not_weighed;                  // why gain is empty
};

// Recordings before the exchange, in which effects with memory settle.
constexpr std::size_t kFilesBefore = 3;
constexpr double kMostBytesBefore = 64e6;

// Number of rows in those recordings; unreadable recordings are skipped.
std::size_t rows_to_settle(const SensorConfig& sensor, std::vector<RecordedFile>& files, const Field& field) {
  if (files.empty()) return 0;
  try {
    return read_recorded(sensor, files, field.required_config().plugin_folders).capture.view().size();
  } catch (const std::exception&) {
    files.clear();
    return 0;
  }
}

void weigh(Watched& out, const Field& field, const SensorConfig& sensor, const Model& before,
           const Model& after, std::uint64_t recorded_before) {
  if (sensor.record.folder.empty()) {
    out.not_weighed = "nothing is recorded of the sensor ([sensor.record])";
    return;
  }
  try {
    std::vector<RecordedFile> all = recorded_files(sensor);
    const auto first = std::ranges::upper_bound(all, recorded_before, {}, &RecordedFile::number);
    std::vector<RecordedFile> settling = newest({all.begin(), first}, kFilesBefore, kMostBytesBefore);
    all.erase(all.begin(), first);
    if (all.empty()) {
      out.not_weighed = "nothing was recorded meanwhile";
      return;
    }
    const std::size_t begin = rows_to_settle(sensor, settling, field);
    all.insert(all.begin(), settling.begin(), settling.end());
    const Recorded recorded = read_recorded(sensor, all, field.required_config().plugin_folders);
    out.gain = weigh_models(recorded, before, after, begin);
    if (out.gain.empty()) out.not_weighed = "the two models corrected alike meanwhile";
  } catch (const std::exception& error) {
    // The history must not quote content of a recording.
    warn("{}\n", error.what());
    out.not_weighed = "the recordings could not be used";
  }
}

// Observes for `seconds`, then evaluates the recording. recorded_before: number of the last recording that
// was started before the exchange; a reload starts a new one.
Watched watch(LiveStatus& live, const Field& field, const SensorConfig& sensor, const Model& before,
              const Model& after, std::uint64_t recorded_before, double seconds) {
  using Clock = std::chrono::steady_clock;
  Watched out;
  const Clock::time_point start = Clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  std::optional<status_t> first;
  {
    Progress progress("watching " + sensor.name, static_cast<std::size_t>(std::max(1.0, seconds)));
    std::int64_t last = 0;
    const auto take = [&](const status_t& status) {
      if (std::exchange(last, status.utime) == status.utime) return;
      if (!first) first = status;
      ++out.statuses;
      out.divergences = status.divergences - first->divergences;
      out.gated = status.gated - first->gated;
      if (!status.notice.empty()) out.noticed = status.notice;
      out.nis.resize(status.nis_mean.size());
      out.whiteness.resize(status.nis_mean.size());
      const auto n = static_cast<double>(out.statuses);
      for (std::size_t a = 0; a < out.nis.size(); ++a) {
        out.nis[a] += (status.nis_mean[a] - out.nis[a]) / n;
        out.whiteness[a] += (status.whiteness[a] - out.whiteness[a]) / n;
      }
      progress.at(static_cast<std::size_t>(passed()));
    };
    try {
      live.ask(std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3)), [&](const Statuses& all) {
        if (const auto now = all.find(sensor.name); now != all.end()) take(now->second);
        return passed() >= seconds;
      });
    } catch (const std::exception& error) {
      warn("{}\n", error.what());
    }
  }
  out.seconds = std::min(passed(), seconds);
  out.whole = passed() >= seconds;
  weigh(out, field, sensor, before, after, recorded_before);
  return out;
}

const char* or_none(const std::string& identity) { return identity.empty() ? "none" : identity.c_str(); }

Proposal waiting(const std::string& state, const std::string& sensor, const ModelName& in_use) {
  std::optional<Proposal> found = read_proposal(state, sensor);
  if (!found) throw refusal("no proposal waits for sensor {} in {}", in_quotes(sensor), state);
  if (found->against != in_use)
    throw refusal(
        "the proposal of {} for sensor {} was made against model {}, in use is {}: expected a new one, which "
        "the next night brings",
        printable(found->made), in_quotes(sensor), or_none(found->against.identity),
        or_none(in_use.identity));
  return std::move(*found);
}

// Writes the outcome of the watch into the history.
void keep_outcome(const Field& field, const std::string& sensor, const ModelName& model,
                  const std::string& text) {
  const StateLock hand(field.state());
  History history(field.state(), sensor);
  if (!history.changes().empty() && history.changes().back().model == model) history.set_outcome(text);
}

// Number of the last recording; 0: none; nullopt: not readable, which the watch reports.
std::optional<std::uint64_t> last_recording(const SensorConfig& sensor) {
  try {
    const std::vector<RecordedFile> files = recorded_files(sensor);
    return files.empty() ? 0 : files.back().number;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

nlohmann::json adoption_json(const Proposal& proposal, const Watched& watched, const std::string& text) {
  constexpr std::array kNames{"kept", "in_part", "broken", "open"};
  return {{"schema", "ifog.adoption/1"},
          {"sensor", proposal.sensor},
          {"model", proposal.model.identity},
          {"replaced", proposal.against.identity},
          {"promised", proposal.gain},
          {"watched_s", watched.seconds},
          {"found", watched.gain},
          {"verdict", kNames[static_cast<std::size_t>(verdict_of(watched.gain))]},
          {"nis_mean", watched.nis},
          {"whiteness", watched.whiteness},
          {"divergences", watched.divergences},
          {"noticed", watched.noticed},
          {"outcome", text}};
}

void tell_innovations(const Watched& watched) {
  if (watched.statuses == 0) {
    say("  innovations: no status from the daemon in this time\n");
    return;
  }
  say("  innovations over {:.0f} s: {}; {} gated, {} divergences\n", watched.seconds,
      axis_health(watched.nis, watched.whiteness), watched.gated, watched.divergences);
  if (!watched.noticed.empty()) say("  noticed: {}\n", printable(watched.noticed, kLongestMessage));
}

// Writes the change into the history and exchanges the model, in this order, so that an interruption loses
// nothing.
void exchange(ModelExchange& place, const std::optional<Model>& model, const ModelInUse& before,
              History& history, ModelChange change) {
  history.add(std::move(change), before.model);
  try {
    place.exchange(model, before.model);
  } catch (...) {
    history.take_back();
    throw;
  }
}

struct Adoption {
  Proposal proposal;
  Model model;
  ModelInUse before;
  std::unique_ptr<ModelExchange> exchange;
};

// Replaces the model in use by the proposed one, with the state folder locked.
Adoption take_into_use(const Field& field, const SensorConfig& sensor,
                       std::optional<std::uint64_t> recorded_before) {
  const StateLock hand(field.state());
  Adoption now;
  now.before = model_in_use(field, sensor);
  now.proposal = waiting(field.state(), sensor.name, now.before.name);
  now.model = proposed_model(field.state(), now.proposal);
  require_that_it_fits(field, sensor, now.model);
  now.exchange = std::make_unique<ModelExchange>(field, sensor, now.before.name);
  History history(field.state(), sensor.name);
  history.drop_incomplete_change(now.before.name);
  exchange(*now.exchange, now.model, now.before, history,
           {"adopt", utc_now(), now.proposal.model, now.before.name, now.proposal.why, now.proposal.gain, "",
            recorded_before});
  remove_proposal(field.state(), sensor.name);
  return now;
}

void adopt(const AdoptArguments& arguments) {
  share_with_the_group();
  const Field field(arguments.field);
  const SensorConfig& sensor = field.sensor(arguments.sensor);
  const std::optional<std::uint64_t> recorded_before = last_recording(sensor);
  const Adoption now = take_into_use(field, sensor, recorded_before);
  const Proposal& proposal = now.proposal;
  say("{}: model {} in place of {}: {}\n", sensor.name, proposal.model.identity,
      or_none(now.before.name.identity), printable(proposal.why, kLongestMessage));
  const auto unwatched = [&](const std::string& why) {
    write_json(arguments.json, adoption_json(proposal, {}, why));
  };
  if (!now.exchange->daemon_runs()) {
    const std::string why = "the daemon does not run: it begins with this model, and nothing was watched";
    say("  {}\n", why);
    return unwatched(why);
  }
  say("  the daemon uses it; promised: {}\n", gain_text(proposal.gain));
  if (arguments.watch_s <= 0.0) return unwatched("nothing was watched");
  catch_interrupts();
  const Watched watched = watch(now.exchange->live(), field, sensor, now.before.model.value_or(Model{}),
                                now.model, recorded_before.value_or(0), arguments.watch_s);
  tell_innovations(watched);
  std::string text = outcome(watched.gain, watched.not_weighed);
  if (!watched.whole)
    text += " (watched for " + std::to_string(static_cast<int>(watched.seconds)) + " s only)";
  say("  {}\n", text);
  write_json(arguments.json, adoption_json(proposal, watched, text));
  try {
    keep_outcome(field, sensor.name, proposal.model, text);
  } catch (const std::exception& error) {
    warn("ifog adopt: the outcome is not in the history: {}\n", error.what());
  }
  if (verdict_of(watched.gain) == PromiseVerdict::broken) {
    warn("ifog adopt: back with: {}\n", field.command("revert", sensor.name));
    throw Failed("the promise was broken");
  }
}

void revert(const AdoptArguments& arguments) {
  share_with_the_group();
  const Field field(arguments.field);
  const SensorConfig& sensor = field.sensor(arguments.sensor);
  const StateLock hand(field.state());
  History history(field.state(), sensor.name);
  const ModelInUse now = model_in_use(field, sensor);
  history.drop_incomplete_change(now.name);
  const ModelChange* const in_force = history.in_force();
  if (in_force == nullptr)
    throw refusal("nothing was adopted for sensor {} that could be reverted", in_quotes(sensor.name));
  if (now.name != in_force->model)
    throw refusal(
        "sensor {} uses model {}, last adopted was {}: expected that one, it was changed by other means",
        in_quotes(sensor.name), or_none(now.name.identity), printable(in_force->model.identity));
  const std::optional<Model> back = history.kept(in_force->replaced);
  if (back) require_that_it_fits(field, sensor, *back);
  ModelExchange place(field, sensor, now.name);
  const ModelName name = in_force->replaced;
  const std::string when = utc_now();
  exchange(place, back, now, history, {"revert", when, name, now.name, "", {}, "", last_recording(sensor)});
  say("{}: model {} is in place again, {} is kept\n", sensor.name, or_none(name.identity), now.name.identity);
  if (!place.daemon_runs()) say("  the daemon does not run: it begins with this model\n");
  write_json(arguments.json, nlohmann::ordered_json{{"schema", "ifog.revert/1"},
                                                    {"sensor", sensor.name},
                                                    {"when", when},
                                                    {"model", name.identity},
                                                    {"replaced", now.name.identity},
                                                    {"running", place.daemon_runs()}});
}

}  // namespace

void add_adopt(const Command& program) {
  auto arguments = std::make_shared<AdoptArguments>();
  const Command command = program.add_subcommand(
      "adopt", "Put a proposed model into use, and say whether its promise comes true");
  command.add_option("sensor", arguments->sensor, "name in the daemon's configuration", {.required = true});
  arguments->field.add_to(command);
  command.add_option("--watch", arguments->watch_s, "look on for so long, s; 0: do not",
                     {.shows_default = true, .type = "SECONDS", .range = within(0.0, 86400.0)});
  command.add_option("--json", arguments->json, "write what was promised and found as JSON", kWritesJson);
  command.callback([arguments] { adopt(*arguments); });
}

void add_revert(const Command& program) {
  auto arguments = std::make_shared<AdoptArguments>();
  const Command command = program.add_subcommand("revert", "Take the last adoption back");
  command.add_option("sensor", arguments->sensor, "name in the daemon's configuration", {.required = true});
  arguments->field.add_to(command);
  command.add_option("--json", arguments->json, "write what was changed as JSON, schema ifog.revert/1",
                     kWritesJson);
  command.callback([arguments] { revert(*arguments); });
}

}  // namespace ifog::tools
