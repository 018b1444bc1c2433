// SPDX-License-Identifier: Apache-2.0
// ifog fleet: diagnoses all gyros of a type, on this computer or on a cluster; then estimates the type's
// properties and improves each gyro's model with them.
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "drivers/capture/files/output_file.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/utc_now.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/command_line.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/fleet/engine.h"
#include "tools/ifog/fleet/gather.h"
#include "tools/ifog/fleet/gyro_work.h"
#include "tools/report/pages/fleet_page.h"

namespace ifog::tools {
namespace {

constexpr std::size_t kAttempts = 3;  // for a gyro whose process ended without a result
constexpr std::size_t kFormsFor = 2;  // measurements; later ones only drop effects, so that the loop ends

struct FleetArguments {
  std::string manifest, results, engine = "auto";
  std::size_t jobs = 0;
  std::optional<std::size_t> one;
  bool dry_run = false;
  FleetSettings settings;
};

class FleetRun {
 public:
  FleetRun(const FleetArguments& arguments, const Manifest& manifest, const Results& results)
      : manifest_(manifest),
        results_(results),
        options_(arguments.settings.text()),
        level_(arguments.settings.wanted.options.significance),
        engine_(engine_named(arguments.engine, results, arguments.jobs)) {
    population_.type = type_.type = manifest.type;
    population_.significance = level_;
    for (const FleetGyro& gyro : manifest.gyros) population_.serials.push_back(gyro.serial);
  }

  void dry_run() { say("{}", engine_->in_words(undiagnosed())); }

  void run() {
    diagnose_all();
    if (diagnosed_.gyros.empty()) {
      forget_with_prior();
      results_.forget("fleet.json");
      results_.forget("fleet.html");
      tell_failures();
      throw Failed("no gyro was diagnosed");
    }
    measure_type();
    population_.parameters = noise_parameters(diagnosed_);
    for (PopulationParameter& each : coefficient_parameters(population_.effects))
      population_.parameters.push_back(std::move(each));
    for (PopulationParameter& each : population_.parameters) describe(each);
    population_.standing_out = standing_out(population_.parameters);
    for (const FoundInGyro& each : diagnosed_.found)
      if (std::ranges::none_of(type_.effects,
                               [&](const TypeCandidate& of_type) { return is_of(of_type, each.effect); }))
        population_.own.push_back(each);
    write();
    tell();
    if (!population_.failed.empty()) throw Failed("not every gyro has a result");
  }

 private:
  [[nodiscard]] std::vector<std::size_t> undiagnosed() const {
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < manifest_.gyros.size(); ++i)
      if (absent_.count(i) == 0 && !is_diagnosed(results_, manifest_.gyros[i], options_))
        missing.push_back(i);
    return missing;
  }

  // Runs the missing gyros until each has a result or a recorded failure; returns how the others ended.
  template <typename Missing, typename Failure>
  std::map<std::size_t, std::string> run_missing(const char* what, const Missing& missing,
                                                 const Failure& failure) {
    std::map<std::size_t, std::string> ended;
    std::vector<std::size_t> left = missing();
    if (left.empty()) return ended;
    say("{} {} of {} gyros\n", what, left.size(), manifest_.gyros.size());
    for (const std::size_t gyro : left) forget_failure(gyro);
    for (std::size_t attempt = 0; attempt < kAttempts && !left.empty(); ++attempt) {
      Progress progress(what, left.size());
      ended = engine_->run(left, [&](std::size_t done) { progress.at(done); });
      left = missing();
      std::erase_if(left, failure);  // gyros with a recorded failure are not tried again
    }
    for (const std::size_t gyro : left)
      if (ended.count(gyro) == 0) ended[gyro] = "no result";
    return ended;
  }

  [[nodiscard]] std::map<std::size_t, std::string> without_captures() const {
    std::map<std::size_t, std::string> out;
    for (std::size_t i = 0; i < manifest_.gyros.size(); ++i)
      for (const std::string& capture : manifest_.gyros[i].captures)
        if (std::error_code none; !std::filesystem::exists(capture, none))
          out.emplace(i, capture + ": cannot open: No such file or directory");
    return out;
  }

  // Removes the failure of an earlier run.
  void forget_failure(std::size_t gyro) const {
    const FleetGyro& of = manifest_.gyros[gyro];
    if (const auto done = results_.done(of); done && done->failed) results_.forget(of, "gyro.json");
    if (type_.id.empty()) return;
    if (const auto measured = results_.measured(of, type_.id); measured && measured->failed)
      results_.forget(of, measured_name(type_.id));
  }

  // Removes results of an earlier run.
  void forget_with_prior() const {
    for (const FleetGyro& gyro : manifest_.gyros) results_.forget(gyro, "with_prior.toml");
  }

  void diagnose_all() {
    absent_ = without_captures();
    if (!absent_.empty() || !undiagnosed().empty()) results_.forget("type.json");
    const auto said_why = [&](std::size_t gyro) {
      const std::optional<GyroDone> done = results_.done(manifest_.gyros[gyro]);
      return done && done->failed.has_value();
    };
    const auto ended = run_missing(
        "diagnosing", [&] { return undiagnosed(); }, said_why);
    diagnosed_ = gather_diagnosed(results_, manifest_, options_, population_.failed);
    std::set<std::size_t> known(diagnosed_.gyros.begin(), diagnosed_.gyros.end());
    for (const Population::Failure& each : population_.failed) known.insert(each.gyro);
    for (std::size_t gyro = 0; gyro < manifest_.gyros.size(); ++gyro) {
      if (known.count(gyro) > 0) continue;
      const std::optional<GyroDone> done = results_.done(manifest_.gyros[gyro]);
      const auto how = ended.find(gyro);
      const auto gone = absent_.find(gyro);
      std::string why = gone != absent_.end()  ? gone->second
                        : done && done->failed ? *done->failed
                        : how != ended.end()   ? how->second + results_.see_log(gyro)
                                               : "its captures change while they are read";
      population_.failed.push_back({gyro, std::move(why)});
    }
  }

  // Measures the type's effects on every gyro until the measurements no longer change their selection.
  void measure_type() {
    if (diagnosed_.gyros.size() < kFewestOfType) {
      population_.remarks.push_back("fleet statistics need " + std::to_string(kFewestOfType) +
                                    " gyros; see each gyro's report");
      results_.forget("type.json");
      return;
    }
    type_.effects = type_candidates(diagnosed_.found, diagnosed_.gyros.size(), level_);
    for (std::size_t round = 0; !type_.effects.empty(); ++round) {
      results_.write(type_);
      std::vector<Population::Failure> failed;
      measured_ = measure_all(failed);
      const bool enough = measured_.size() >= kFewestOfType;
      if (enough) population_.effects = judged_effects(type_, measured_, diagnosed_, level_);
      if (!enough || !reconsider(type_, population_.effects, measured_, level_, round < kFormsFor)) {
        population_.failed.insert(population_.failed.end(), failed.begin(), failed.end());
        if (enough) return;
        type_.effects.clear();
        population_.remarks.push_back(
            "the type's effects were measured in too few gyros to say anything of it");
        return;
      }
      population_.effects.clear();
    }
    type_.effects.clear();
    population_.remarks.push_back(
        "no effect is the type's: none shows in more gyros than false alarms explain, or what shows is not "
        "the same in them");
    results_.write(type_);
  }

  std::map<std::size_t, GyroMeasured> measure_all(std::vector<Population::Failure>& failed) {
    const auto missing = [&] {
      std::vector<std::size_t> left;
      for (const std::size_t gyro : diagnosed_.gyros)
        if (!is_measured(results_, manifest_.gyros[gyro], options_, type_)) left.push_back(gyro);
      return left;
    };
    const auto said_why = [&](std::size_t gyro) {
      const auto measured = results_.measured(manifest_.gyros[gyro], type_.id);
      return measured && measured->failed.has_value();
    };
    const auto ended = run_missing("measuring", missing, said_why);
    auto measured = gather_measured(results_, manifest_, options_, diagnosed_, type_, failed);
    for (Population::Failure& each : failed)
      if (const auto how = ended.find(each.gyro); how != ended.end())
        each.why += ": " + how->second + results_.see_log(each.gyro);
    return measured;
  }

  void write() {
    forget_with_prior();
    for (const auto& [gyro, measured] : measured_) {
      if (population_.effects.empty()) break;
      const Model model =
          model_with_prior(diagnosed_.models.at(gyro), type_, measured, gyro, population_.effects);
      write_file(results_.path(manifest_.gyros[gyro], "with_prior.toml"), model_text(model));
    }
    write_json(results_.path("fleet.json"), fleet_json(population_));
    report::FleetPage page;
    page.population = &population_;
    page.made = utc_now() + " by ifog " IFOG_VERSION;
    page.command = typed_command();
    write_file(results_.path("fleet.html"), report::fleet_page(page));
  }

  void tell_failures() {
    for (const Population::Failure& each : population_.failed)
      warn("{}: {}\n", population_.serials[each.gyro], printable(each.why, kLongestMessage));
  }

  void tell() {
    say("{}: {} of {} gyros diagnosed\n", printable(manifest_.type), diagnosed_.gyros.size(),
        manifest_.gyros.size());
    for (const TypeEffect& each : population_.effects) say("  {}\n", report::in_words(each));
    for (const std::string& remark : population_.remarks) say("  {}\n", remark);
    for (const StandingOut& each : population_.standing_out)
      say("  outlier {}: {}, robust z = {:.1f}\n", population_.serials[each.gyro],
          printable(population_.parameters[each.parameter].name), each.z);
    tell_failures();
    say("{}\n{}\n", results_.path("fleet.html"), results_.path("fleet.json"));
  }

  const Manifest& manifest_;
  const Results& results_;
  std::string options_;
  double level_;
  std::unique_ptr<Engine> engine_;
  std::map<std::size_t, std::string> absent_;  // gyros without captures, with the reason
  Diagnosed diagnosed_;
  TypeToMeasure type_;
  std::map<std::size_t, GyroMeasured> measured_;
  Population population_;
};

void run_fleet(const FleetArguments& arguments) {
  const Manifest manifest = read_manifest(arguments.manifest);
  if (arguments.one && *arguments.one >= manifest.gyros.size())
    throw WrongUsage("--one", std::to_string(*arguments.one) + " is no gyro of " + arguments.manifest +
                                  ", expected 0 to " + std::to_string(manifest.gyros.size() - 1));
  const std::string folder =
      arguments.results.empty()
          ? std::filesystem::path(arguments.manifest).replace_extension(".results").string()
          : arguments.results;
  const Results results(folder);
  if (arguments.one) {
    work_on(results, manifest.gyros[*arguments.one], arguments.settings);
    return;
  }
  FleetRun fleet(arguments, manifest, results);
  if (arguments.dry_run) {
    fleet.dry_run();
    return;
  }
  catch_interrupts();
  fleet.run();
}

}  // namespace

void add_fleet(const Command& program) {
  auto arguments = std::make_shared<FleetArguments>();
  const Command command = program.add_subcommand(
      "fleet", "Diagnose every gyro of a type, then the type: effects, spread, outliers");
  command.add_option("manifest", arguments->manifest, "type, and of each gyro serial and captures (.toml)",
                     {.required = true, .file = FileUse::read});
  command.add_option("--results", arguments->results,
                     "folder of results; otherwise next to the manifest, under its name with .results",
                     {.type = "FOLDER"});
  command.add_option("--engine", arguments->engine,
                     "who runs the diagnoses: auto takes slurm where there is an sbatch",
                     {.shows_default = true, .choices = {"auto", "local", "slurm"}});
  command.add_option("--jobs", arguments->jobs,
                     "gyros at once; otherwise a processor each, or as many as Slurm gives",
                     {.range = within(1, 100000)});
  command.add_flag("--dry-run", arguments->dry_run,
                   "print what would be run for the gyros not yet diagnosed");
  command.add_option("--one", arguments->one, "only what is missing of this gyro, counted from 0",
                     {.type = "INDEX"});
  arguments->settings.input.add_to(command);
  arguments->settings.part.add_to(command);
  command.add_option("--axis", arguments->settings.wanted.axes, "only these axes");
  command.add_option("--significance", arguments->settings.wanted.options.significance,
                     "chance of a false effect in a gyro, after correction for all tried",
                     {.shows_default = true, .range = within(1e-9, 0.5)});
  arguments->settings.wanted.add_earth_to(command);
  command.footer("Example:\n  ifog fleet lot7.toml --jobs 8");
  command.callback([arguments] { run_fleet(*arguments); });
}

}  // namespace ifog::tools
