// SPDX-License-Identifier: Apache-2.0
// ifog tune: fits Q, R and the state model of a sensor at rest and writes a model file.
#include "filters/tune/tune.h"
#include "drivers/system/utc_now.h"

#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/files/output_file.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "filters/allan/noise/curve_miss.h"
#include "filters/allan/noise/noise_coefficients.h"
#include "filters/model_file/model.h"
#include "filters/rest/cleaned_rate.h"
#include "filters/rest/noise_change.h"
#include "filters/rest/rest.h"
#include "filters/rest/value_faults.h"
#include "filters/tune/candidate.h"
#include "filters/units/field_units.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/tune/noise_at_rest.h"
#include "tools/report/coefficients.h"

namespace ifog::tools {
namespace {

using nlohmann::json;

struct TuneArguments {
  CaptureInput input;
  TimePart part;
  std::string capture, model, write_model, json_file;
  std::optional<double> since_power_up_s;
  std::vector<std::string> states;
  std::size_t samples = 200000;
};

// The value in deg/h or deg/h/sqrt(h); "" for other units.
std::string in_field_units(const TunedFigure& figure) {
  double factor = 0.0;
  const char* unit = "";
  if (figure.unit == "rad/s^2/sqrt(Hz)") factor = 1.0 / kDegreePerHourPerRootHour, unit = "deg/h/sqrt(h)";
  if (figure.unit == "rad/s") factor = 1.0 / kDegreePerHour, unit = "deg/h";
  if (factor == 0.0) return "";
  return fmt::format("   {:.4g} {}", figure.value * factor, unit);
}

json rate_json(const RateFigures& figures) {
  json adev = json::object();
  for (std::size_t t = 0; t < kOutcomeTaus.size(); ++t)
    if (figures.adev_radps[t]) adev[fmt::format("{:g}", kOutcomeTaus[t])] = *figures.adev_radps[t];
  return {{"rms_radps", figures.rms_radps}, {"adev_radps", adev}};
}

json outcome_json(const Outcome& outcome, const std::vector<std::string>& axes) {
  json all = json::array();
  for (std::size_t a = 0; a < axes.size(); ++a)
    all.push_back({{"axis", axes[a]},
                   {"before", rate_json(outcome.before[a])},
                   {"after", rate_json(outcome.after[a])}});
  return all;
}

json model_json(const TunedModel& model, const std::vector<std::string>& axes) {
  json figures = json::object();
  for (const TunedFigure& f : model.figures)
    figures[f.name] = {{"value", f.value}, {"std_error", f.std_error}, {"unit", f.unit}};
  if (model.walk_is_bound) figures["process_noise"]["bound"] = true;
  return {{"state", model.settings.state},
          {"state_parameters", model.settings.state_parameters},
          {"parameters", model.parameters},
          {"log_likelihood", model.log_likelihood},
          {"bic", model.bic},
          {"figures", figures},
          {"passed_over", model.passed_over},
          {"held_out", model.held_out ? outcome_json(*model.held_out, axes) : json(nullptr)}};
}

void print_models(const Tuning& tuning) {
  say("{:<28} {:>4} {:>16} {:>10}\n", "state model", "free", "ln likelihood", "BIC - best");
  for (const TunedModel& model : tuning.models)
    say("{:<28} {:4} {:16.1f} {:10.1f}\n", model.settings.state, model.parameters, model.log_likelihood,
        model.bic - tuning.models.front().bic);
  const TunedModel& chosen = tuning.models[tuning.chosen];
  say("\n{}\n", chosen.settings.state);
  for (std::size_t i = 0; i < tuning.chosen; ++i)
    say("  {} is likelier: rejected, {}\n", tuning.models[i].settings.state, tuning.models[i].passed_over);
  for (const TunedFigure& f : chosen.figures) {
    if (f.std_error)
      say("  {:<30} {:12.5g} ± {:<9.2g} {:<18}{}\n", f.name, f.value, *f.std_error, f.unit,
          in_field_units(f));
    else
      say("  {:<30} {:12.5g}   {:<9} {:<18}{}\n", f.name, f.value, "unknown", f.unit, in_field_units(f));
  }
  if (chosen.walk_is_bound) say("  no random walk is detectable: process_noise is its 1 sigma upper limit\n");
}

// One line per figure: measured, published with the selected model, and with the random walk.
void print_figure(const std::string& name, double before, double after, const double* walk) {
  say("  {:<22} {:12.4g} {:12.4g}", name, before / kDegreePerHour, after / kDegreePerHour);
  if (walk != nullptr) say(" {:12.4g}", *walk / kDegreePerHour);
  say("\n");
}

void print_held_out(const Tuning& tuning, const std::vector<std::string>& axes) {
  const TunedModel& chosen = tuning.models[tuning.chosen];
  if (!chosen.held_out) return;
  const auto found = std::ranges::find_if(
      tuning.models, [&](const TunedModel& m) { return m.held_out && m.settings.state == "random-walk"; });
  const Outcome* walk = found == tuning.models.end() || &*found == &chosen ? nullptr : &*found->held_out;
  say("\nfitted to the first half, the second half as denoise makes it, deg/h\n  {:<22} {:>12} {:>12}{}\n",
      "", "measured", "denoised", walk ? "  random-walk" : "");
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const RateFigures& before = chosen.held_out->before[a];
    const RateFigures& after = chosen.held_out->after[a];
    if (!axes[a].empty()) say("  axis {}\n", axes[a]);
    print_figure("RMS", before.rms_radps, after.rms_radps, walk ? &walk->after[a].rms_radps : nullptr);
    for (std::size_t t = 0; t < kOutcomeTaus.size(); ++t) {
      if (!before.adev_radps[t] || !after.adev_radps[t]) continue;
      print_figure(fmt::format("Allan deviation {:g} s", kOutcomeTaus[t]), *before.adev_radps[t],
                   *after.adev_radps[t],
                   walk && walk->after[a].adev_radps[t] ? &*walk->after[a].adev_radps[t] : nullptr);
    }
  }
}

// Noise terms by axis at rest, as in `ifog allan`. A filter's Q and R are not noise terms: with coloured
// noise in the state they only predict best.
struct RestNoise {
  NoiseCoefficients terms;
  std::vector<NoiseChange> changes;
};
using NoiseByAxis = std::map<std::string, RestNoise>;

json rest_noise_json(const NoiseByAxis& noise) {
  json axes = json::array();
  for (const auto& [axis, found] : noise)
    axes.push_back({{"axis", axis},
                    {"coefficients", report::coefficients_json(found.terms)},
                    {"gauss_markov", report::markov_json(found.terms.markov)},
                    {"noise_changes", report::noise_changes_json(found.changes)}});
  return axes;
}

// Noise by axis. Replaces single jumps in the capture by values in `repaired`. Other faults of the logging
// program are noted, because a fit to such data is not a gyro's noise. An axis that is too short has no terms,
// which is noted.
NoiseByAxis noise_of(CaptureView& capture, const SampleClock& clock, const Rest& rest,
                     std::vector<Samples>& repaired, std::vector<std::string>& notes) {
  NoiseByAxis noise;
  bool unexplained = false;
  const auto shown_time_s = [&](std::size_t i) { return capture.shown_time_s(i); };
  for (std::size_t a = 0; a < capture.axes.size(); ++a) {
    std::span<const double>& rate = capture.rate_radps[a];
    const std::string& axis = capture.axes[a];
    const auto note = [&](const std::string& text) {
      notes.push_back((axis.empty() ? "" : axis + ": ") + text);
    };
    const std::vector<Stretch> parts = common(stretches(capture.time_s, rate, clock), rest.at_rest);
    std::vector<ValueFault> faults;
    std::optional<Samples> cleaned = without_leaps(rate, rate, parts, shown_time_s, faults);
    if (cleaned) rate = repaired.emplace_back(*std::move(cleaned));
    find_value_faults(rate, parts, clock.period_s, faults);
    for (const ValueFault& fault : faults) note(fault.text);
    try {
      RestNoise found{noise_coefficients(AngleSum(rate, parts), clock.period_s),
                      noise_changes(rate, parts, clock.period_s, shown_time_s)};
      for (const std::string& miss : misfit_in_words(found.terms)) note(miss);
      unexplained = unexplained || !found.terms.left_out_hz.empty();
      if (const std::string change = in_words(found.changes); !change.empty()) note(change);
      noise[axis] = std::move(found);
    } catch (const std::invalid_argument& error) {
      notes.push_back("no noise terms" + (axis.empty() ? "" : " of " + axis) + ": " + error.what());
    }
  }
  if (unexplained)
    notes.push_back(
        "a model with coloured noise takes those bands for noise, too: if a hand, an engine or a structure "
        "moved there, record at rest");
  return noise;
}

// `before`: the effects that corrected the rates are kept, and all filter settings except the noise.
Model model_of(Model before, const Tuning& tuning, const NoiseByAxis& noise, const std::string& path) {
  Model model = std::move(before);
  const FilterSettings& tuned = tuning.models[tuning.chosen].settings;
  if (!model.filter) model.filter.emplace();
  model.filter->state = tuned.state;
  model.filter->process_noise = tuned.process_noise;
  model.filter->measurement_noise = tuned.measurement_noise;
  model.filter->state_parameters = tuned.state_parameters;
  for (const auto& [axis, found] : noise) {
    NoiseTerms& terms = model.noise[axis] = {};
    for (const report::NamedCoefficient& named : report::named_coefficients())
      if (const NoiseCoefficient& c = found.terms.*named.member; c.present) terms.*named.term = c.value;
  }
  if (!model.effects.empty()) return model;  // whose effects are from the captures that it names
  model.source.capture = printable(std::filesystem::path(path).filename().string(), kLongestMessage);
  model.source.date = utc_now();
  return model;
}

json tuning_json(const TuneArguments& options, const Tuning& tuning, std::size_t left, double period,
                 const NoiseByAxis& noise, const std::vector<std::string>& axes) {
  json models = json::array();
  for (const TunedModel& model : tuning.models) models.push_back(model_json(model, axes));
  return json{{"schema", "ifog.tune/1"},
              {"capture", options.capture},
              {"samples", tuning.samples},
              {"left_out", left},
              {"sample_rate_hz", 1.0 / period},
              {"best", tuning.models[tuning.chosen].settings.state},
              {"best_by_bic", tuning.models.front().settings.state},
              {"noise", rest_noise_json(noise)},
              {"models", models}};
}

void run_tune(const TuneArguments& options) {
  const Model before = options.model.empty() ? Model{} : read_model(options.model);
  const auto wanted = [&](const std::string& column) {
    return !before.effects.empty() || is_rate_column(column) || is_other_rate(column);
  };
  const PreparedCaptures prepared =
      options.input.prepared({options.capture}, {.part = options.part,
                                                 .model = &before,
                                                 .model_path = options.model,
                                                 .since_power_up_s = options.since_power_up_s,
                                                 .wanted = wanted});
  CaptureView capture = prepared.views.front();
  if (capture.size() < 3)
    throw refusal("{}: {} rows, expected at least 200", options.capture, capture.size());
  const SampleClock clock = sample_clock(capture.time_s);
  const double period = clock.period_s;
  Progress progress("fitting state models",
                    options.states.empty() ? default_candidates().size() : options.states.size());
  const Rest rest = mostly_at_rest(capture, period, options.capture);
  std::vector<std::string> notes;
  std::vector<Samples> repaired;
  repaired.reserve(capture.axes.size());
  const NoiseByAxis noise = noise_of(capture, clock, rest, repaired, notes);
  if (const std::string motion = in_words(rest, period, capture.shown_time_s(0)); !motion.empty())
    notes.push_back(motion + "; only the rest is used");
  if (const std::string slow = slow_turns_in_words(rest, period, capture.shown_time_s(0)); !slow.empty())
    notes.push_back(slow);
  const auto [columns, left] = rest_columns(capture, rest, period, options.samples);
  const std::vector<std::span<const double>> axes(columns.begin(), columns.end());
  TuneOptions tune_options;
  tune_options.states = options.states;
  tune_options.progress = progress.teller();
  const Tuning tuning = naming(options.capture, [&] { return tune(axes, period, tune_options); });
  say("{}: {} samples at {:.6g} Hz{}\n", options.capture, tuning.samples, 1.0 / period,
      capture.axes.size() > 1 ? ", all axes under one model" : "");
  if (left > 0) say("the last {} rows are dropped; --samples {} takes all\n", left, capture.size());
  for (const std::string& note : notes) say("note: {}\n", note);
  print_models(tuning);
  print_held_out(tuning, capture.axes);
  for (const auto& [axis, found] : noise)
    say("\nnoise{}{} at rest\n{}", axis.empty() ? "" : " of ", axis, report::coefficient_lines(found.terms));
  write_json(options.json_file, tuning_json(options, tuning, left, period, noise, capture.axes));
  if (!options.write_model.empty()) {
    write_file(options.write_model, model_text(model_of(before, tuning, noise, options.capture)));
    say("\nto use it: ifog denoise {}{} --model {} --output denoised.csv\n", shell_file(options.capture),
        options.input.as_typed(), shell_file(options.write_model));
  }
}

}  // namespace

void add_tune(const Command& program) {
  const Command command =
      program.add_subcommand("tune", "Noise and state model of a sensor at rest, by maximum likelihood");
  auto options = std::make_shared<TuneArguments>();
  options->input.other_rates = true;
  command.add_option("capture", options->capture, "a capture at rest",
                     {.required = true, .file = FileUse::read});
  command.add_option("--model", options->model,
                     "correct with this model first; its effects stay in what is written", kReadsFile);
  command.add_option(
      "--since-power-up", options->since_power_up_s,
      "seconds from power-up to the capture's first sample, for a warm_up of --model; default: as "
      "a recording says it",
      {.range = not_negative()});
  command.add_option("--write-model", options->write_model, "model file that ifogd and denoise read",
                     {.file = FileUse::written, .endings = kModelEndings});
  command.add_option("--json", options->json_file, "write the figures as JSON", kWritesJson);
  // One per option, so that a following capture is not read as a state model.
  command.add_option("--state", options->states, "state models to try; may stand several times",
                     {.one_value_each = true});
  command.add_option("--samples", options->samples, "most rows of the capture to fit",
                     {.shows_default = true, .range = within(200, 100000000)});
  options->input.add_to(command);
  options->part.add_to(command);
  command.callback([options] { run_tune(*options); });
}

}  // namespace ifog::tools
