// SPDX-License-Identifier: Apache-2.0
// ifog night: diagnoses what the flight recorder stored since the last run, and proposes a new model if it
// improves held-out data. Adopts nothing and needs neither device nor daemon.
#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <deque>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/capture/files/input_file.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/utc_now.h"
#include "filters/effects/meaning.h"
#include "filters/model_file/sha256.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/usable_axes.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/diagnose/sensor_diagnosis.h"
#include "tools/ifog/field/exchange.h"
#include "tools/ifog/field/field.h"
#include "tools/ifog/field/models.h"
#include "tools/ifog/field/recorded.h"
#include "tools/ifog/tune/noise_at_rest.h"

namespace ifog::tools {
namespace {

struct NightArguments {
  FieldOptions field;
  std::vector<std::string> sensors;
  std::string json;
  double least_rest_s = 1800.0;
  double most_bytes = 400e6;
};

// Fraction of the time for the fit; the rest is held out.
constexpr double kFitTo = 0.7;
// The error must fall by this at one averaging time or more, and may not grow by more at any.
constexpr double kLeastGain = 0.05;
constexpr double kMostLoss = 0.02;

const std::string kCannotBeJudged = "the recordings could not be evaluated; the reason is in the night's log";

bool pays(const AxisGain& gain) {
  const PromiseVerdict found = verdict(gain.kept);
  if (found != PromiseVerdict::kept && found != PromiseVerdict::in_part) return false;
  bool gains = false;
  for (const ErrorOfMeans& error : gain.kept.errors) {
    if (error.after_radps > (1.0 + kMostLoss) * error.before_radps) return false;
    gains = gains || error.after_radps < (1.0 - kLeastGain) * error.before_radps;
  }
  return gains;
}

std::string in_hours(double seconds) {
  return seconds < 7200.0 ? fmt::format("{:.0f} min", seconds / 60.0)
                          : fmt::format("{:.1f} h", seconds / 3600.0);
}

std::string effects_text(const std::vector<AxisDiagnosis>& found) {
  std::string out;
  for (const AxisDiagnosis& axis : found)
    for (const FoundEffect& each : axis.diagnosis.effects) {
      out += (out.empty() ? "" : ", ") + (axis.axis.empty() ? "" : axis.axis + ": ") + name_of(each.effect);
      if (!each.effect.meaning.empty()) out += " (" + each.effect.meaning + ")";
    }
  return out;
}

// Without the time of power-up the daemon's warm-up correction cannot be repeated. Then the remaining drift
// would be attributed to another cause and corrected twice.
bool needs_power_up(const SensorConfig& sensor, const ModelInUse& in_use) {
  return sensor.powered_with_computer && in_use.model &&
         std::ranges::count(in_use.model->effects, "warm_up", &Effect::form) > 0;
}

std::string recordings_name(const SensorConfig& sensor, const std::vector<RecordedFile>& files) {
  const std::string first = std::filesystem::path(files.front().path).filename().string();
  const std::string last = std::filesystem::path(files.back().path).filename().string();
  return sensor.name + " " + first + (files.size() > 1 ? " to " + last : "");
}

// Time when the newest recording will be closed; "" if none is being written.
std::string closing(const SensorConfig& sensor, const std::vector<RecordedFile>& files) {
  if (files.empty() || !files.back().open || files.back().opened == 0) return "";
  const RecordedFile& last = files.back();
  const std::time_t at = last.opened + static_cast<std::time_t>(sensor.record.file_s);
  return fmt::format("; the one that is being written, {:.1f} MB, closes at {:.1f} MB or at {}{}",
                     static_cast<double>(last.bytes) * 1e-6,
                     static_cast<double>(sensor.record.file_bytes) * 1e-6, utc_text(at),
                     at < std::time(nullptr) ? ", which is over: does ifogd run?" : "");
}

struct NightResult {
  std::string said;  // one line
  bool failed = false;
  std::string proposed;  // identity of the proposed model, "": none
  std::string promise;   // outcome of the last adoption as text; "" if not evaluated
};

// Processes one sensor.
class Night {
 public:
  Night(const NightArguments& arguments, const Field& field, const SensorConfig& sensor)
      : arguments_(arguments), field_(field), sensor_(sensor) {}

  NightResult run();

 private:
  std::string process();
  std::string judge(const std::vector<RecordedFile>& all);
  std::string diagnose(const Recorded& recorded, const std::vector<RecordedFile>& files,
                       const ModelInUse& in_use);
  void judge_last_adoption(const std::vector<RecordedFile>& files, const ModelInUse& in_use);
  void propose(Proposal proposal, const Model& model, const Recorded& recorded,
               const std::vector<AxisDiagnosis>& found, const std::string& name,
               const std::vector<std::string>& hashes);

  const NightArguments& arguments_;
  const Field& field_;
  const SensorConfig& sensor_;
  bool processed_ = false;  // these recordings need not be processed again
  NightResult result_;
};

// An error of one sensor does not stop the others.
NightResult Night::run() {
  try {
    result_.said = process();
  } catch (const std::exception& error) {
    result_.said = error.what();
    result_.failed = true;
  }
  return result_;
}

std::string Night::process() {
  if (sensor_.record.folder.empty()) return "nothing is recorded ([sensor.record])";
  std::vector<RecordedFile> files = recorded_files(sensor_);
  const std::string written = closing(sensor_, files);
  std::erase_if(files, [](const RecordedFile& file) { return file.open; });
  const std::optional<Bookmark> bookmark = read_bookmark(field_.state(), sensor_.name);
  // Lower numbers belong to a new folder.
  const bool same_folder = bookmark && !files.empty() && files.back().number >= bookmark->until;
  if (same_folder)
    std::erase_if(files, [&](const RecordedFile& file) { return file.number <= bookmark->until; });
  if (files.empty()) return "no recording has been closed since last time" + written;
  const std::uint64_t until = files.back().number;
  std::string said;
  try {
    said = judge(newest(files, files.size(), arguments_.most_bytes));
  } catch (const std::exception& error) {
    said = error.what();
    result_.failed = true;
  }
  // The stored text must not quote content of a recording.
  if (processed_) {
    const StateLock hand(field_.state());
    write_bookmark(field_.state(), {sensor_.name, until, utc_now(), result_.failed ? kCannotBeJudged : said});
  }
  return said;
}

std::string Night::judge(const std::vector<RecordedFile>& all) {
  const ModelInUse in_use = model_in_use(field_, sensor_);
  // Across several power-ups a warm-up would be found that is not there.
  const std::vector<RecordedFile> files = sensor_.powered_with_computer ? of_one_power_up(all) : all;
  if (files.size() < all.size())
    warn("{}: of several times that it was switched on the longest is judged: {} of {} recordings\n",
         sensor_.name, files.size(), all.size());
  // Unreadable recordings stay unreadable; an error while writing a proposal may pass.
  processed_ = true;
  const Recorded recorded = read_recorded(sensor_, files, field_.required_config().plugin_folders);
  processed_ = false;
  const double rest_s = static_cast<double>(recorded.rest.resting()) * recorded.period_s;
  if (rest_s < arguments_.least_rest_s) {
    return "at rest for " + in_hours(rest_s) + " of " +
           in_hours(static_cast<double>(recorded.rest.samples) * recorded.period_s) + " recorded, expected " +
           in_hours(arguments_.least_rest_s) + " at least: waits for more";
  }
  if (needs_power_up(sensor_, in_use) && !recorded.capture.view().since_power_up_s)
    return "the model in use corrects a warm-up by the time since power-up, which these recordings do not "
           "say: diagnose them by hand with --since-power-up";
  judge_last_adoption(files, in_use);
  std::string said = diagnose(recorded, files, in_use);
  processed_ = true;
  return said;
}

// Evaluates the last adoption with everything recorded since.
void Night::judge_last_adoption(const std::vector<RecordedFile>& files, const ModelInUse& in_use) {
  const History history(field_.state(), sensor_.name);
  if (history.changes().empty() || history.changes().back().what != "adopt") return;
  const ModelChange last = history.changes().back();
  if (in_use.name != last.model) return;
  std::vector<RecordedFile> since = files;
  // By numbers, because the wall clock may have been set. If the numbering restarted, all files are newer.
  if (!last.recorded)
    std::erase_if(since, [&](const RecordedFile& file) { return utc_text(file.opened) < last.when; });
  else if (!since.empty() && since.back().number >= *last.recorded)
    std::erase_if(since, [&](const RecordedFile& file) { return file.number <= *last.recorded; });
  if (since.empty()) return;
  try {
    const Recorded recorded = read_recorded(sensor_, since, field_.required_config().plugin_folders);
    const std::vector<AxisGain> gain =
        weigh_models(recorded, history.kept(last.replaced).value_or(Model{}), *in_use.model, 0);
    if (gain.empty()) return;
    result_.promise = outcome(gain);
    const std::string text = "night of " + utc_now() + ": " + result_.promise;
    say("{}: {}\n", sensor_.name, text);
    const StateLock hand(field_.state());
    if (History fresh(field_.state(), sensor_.name);
        !fresh.changes().empty() && fresh.changes().back().when == last.when)
      fresh.set_outcome(text);
  } catch (const std::exception& error) {
    warn("{}: the last adoption cannot be judged: {}\n", sensor_.name, error.what());
  }
}

std::string Night::diagnose(const Recorded& recorded, const std::vector<RecordedFile>& files,
                            const ModelInUse& in_use) {
  const Model before = in_use.model.value_or(Model{});
  CaptureView corrected = recorded.capture.view();
  const std::vector<Samples> rates = compensated_rates(corrected, before);
  corrected.rate_radps.assign(rates.begin(), rates.end());
  leave_out(unusable_axes({recorded.capture.view()}, {sensor_.name}), corrected);
  AxesToDiagnose wanted;
  wanted.options.fit_to = kFitTo;
  wanted.threads = 1;  // the daemon runs on the same processors
  const std::string name = recordings_name(sensor_, files);
  std::vector<AxisDiagnosis> found = diagnose_axes({corrected}, {name}, wanted);
  std::erase_if(found, [](const AxisDiagnosis& axis) { return axis.diagnosis.effects.empty(); });
  if (found.empty()) return "nothing found that the model in use leaves";

  std::string all;
  for (const RecordedFile& file : files)
    all += sha256_hex(InputFile(file.path, std::deque<std::string>{file.path}).bytes());
  const std::vector<std::string> hashes{sha256_hex(all)};
  const std::span<const double> time_s = recorded.capture.view().time_s;
  const double fitted_to = time_s.front() + kFitTo * (time_s.back() - time_s.front());
  const auto held_out =
      static_cast<std::size_t>(std::ranges::lower_bound(time_s, fitted_to) - time_s.begin());
  const std::string traced = effects_text(found);
  const auto with = [&] { return model_with(before, found, {name}, hashes); };
  const std::vector<AxisGain> tried = weigh_models(recorded, before, with(), held_out);
  const auto gains = [&](const AxisDiagnosis& axis) {
    return std::ranges::any_of(tried,
                               [&](const AxisGain& gain) { return gain.axis == axis.axis && pays(gain); });
  };
  std::erase_if(found, [&](const AxisDiagnosis& axis) { return !gains(axis); });
  if (found.empty())
    return "found " + traced +
           (tried.empty() || verdict_of(tried) != PromiseVerdict::open
                ? ", without a gain on held-out data"
                : ", but " + in_hours(tried.front().kept.seconds) +
                      " held out are too short to tell if it holds") +
           (tried.empty() ? "" : ": " + gain_text(tried));
  Model model = with();
  // If the model has no filter, the daemon learns the noise, and this stays so.
  const std::string fitted =
      model.filter ? fit_noise_left(model, model_with({}, found, {name}, hashes), corrected, name) : "";
  if (!fitted.empty()) say("{}: {}\n", sensor_.name, fitted);
  require_that_it_fits(field_, sensor_, model);
  Proposal proposal;
  proposal.against = in_use.name;
  proposal.gain = weigh_models(recorded, before, model, held_out);
  proposal.why = effects_text(found) + ": " + gain_text(proposal.gain) + " on " +
                 in_hours(proposal.gain.front().kept.seconds) + " held out";
  const std::string why = proposal.why;
  propose(std::move(proposal), model, recorded, found, name, hashes);
  result_.proposed = model.identity();
  return "proposes model " + model.identity() + " against " +
         (in_use.name.identity.empty() ? "none" : in_use.name.identity) + ": " + why;
}

void Night::propose(Proposal proposal, const Model& model, const Recorded& recorded,
                    const std::vector<AxisDiagnosis>& found, const std::string& name,
                    const std::vector<std::string>& hashes) {
  proposal.sensor = sensor_.name;
  proposal.made = utc_now();
  proposal.model = name_of(model);
  const std::string file = sensor_.name + ".proposal-" + proposal.model.identity;
  proposal.model_file = file + ".toml";
  proposal.report_file = file + ".html";
  const std::string report =
      diagnosis_report({recorded.capture.view()}, found, {name}, hashes, proposal.model_file, "");
  const StateLock hand(field_.state());
  write_proposal(field_.state(), proposal, model, report);
}

void run_nights(const NightArguments& arguments) {
  share_with_the_group();
  const Field field(arguments.field);
  for (const std::string& name : arguments.sensors) (void)field.sensor(name);
  if (std::error_code none; !std::filesystem::is_directory(field.state(), none))
    throw refusal("{}: is no folder, expected the daemon's state folder (--state)", field.state());
  bool failed = false;
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const SensorConfig& sensor : field.required_config().sensors) {
    if (!arguments.sensors.empty() &&
        std::ranges::find(arguments.sensors, sensor.name) == arguments.sensors.end())
      continue;
    const NightResult night = Night(arguments, field, sensor).run();
    const std::string line = sensor.name + ": " + printable(night.said, kLongestMessage);
    night.failed ? warn("{}\n", line) : say("{}\n", line);
    failed = failed || night.failed;
    all.push_back({{"sensor", sensor.name},
                   {"failed", night.failed},
                   {"said", night.said},
                   {"proposed", night.proposed},
                   {"promise", night.promise}});
  }
  write_json(arguments.json, nlohmann::ordered_json{{"schema", "ifog.night_report/1"}, {"sensors", all}});
  if (failed) throw Failed("not every sensor could be judged");
}

}  // namespace

void add_night(const Command& program) {
  auto arguments = std::make_shared<NightArguments>();
  const Command command = program.add_subcommand(
      "night", "Diagnose what was recorded since the last time, and propose a model where that pays");
  arguments->field.add_to(command);
  command.add_option("--sensor", arguments->sensors, "only these sensors");
  command.add_option("--least-rest", arguments->least_rest_s, "with less time at rest wait for more, s",
                     {.shows_default = true, .type = "SECONDS", .range = within(60.0, 1e7)});
  command.add_option("--most-bytes", arguments->most_bytes,
                     "of recordings, the newest; a byte takes some four of memory",
                     {.shows_default = true, .range = within(1e5, 1e12)});
  command.add_option("--json", arguments->json, "write the results, schema ifog.night_report/1", kWritesJson);
  command.callback([arguments] { run_nights(*arguments); });
}

}  // namespace ifog::tools
