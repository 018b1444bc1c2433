// SPDX-License-Identifier: Apache-2.0
// ifog allan: overlapping Allan deviation and noise coefficients of captures, as JSON (SI), as a table (the
// field's units) and as a picture.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "filters/units/field_units.h"
#include "tools/ifog/allan/allan_record.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/report/picture.h"
#include "tools/report/text.h"

namespace ifog::tools {
namespace {

using nlohmann::ordered_json;

const char* term_name(Term term) {
  constexpr std::array<const char*, kTerms> kNames{"white phase", "white rate", "flicker rate",
                                                   "random walk"};
  return kNames[term];
}

const char* estimator_name(Deviation kind) {
  return kind == Deviation::kModified   ? "modified"
         : kind == Deviation::kHadamard ? "hadamard"
                                        : "overlapping";
}

// Adds a point to the arrays of a curve.
void add_point(ordered_json& curve, double variance, const AllanInterval& interval) {
  curve["adev_radps"].push_back(std::sqrt(variance));
  curve["lower_radps"].push_back(interval.lower_radps);
  curve["upper_radps"].push_back(interval.upper_radps);
  curve["degrees_of_freedom"].push_back(interval.degrees);
}

void print_point(double tau_s, double variance, const AllanInterval& interval, const char* remark) {
  say("  {:12.6g}  {:12.5g}  {:12.5g} … {:<10.5g}  {:9.4g}  {}{}\n", tau_s,
      std::sqrt(variance) / kDegreePerHour, interval.lower_radps / kDegreePerHour,
      interval.upper_radps / kDegreePerHour, interval.degrees,
      variance > 0.0 ? term_name(interval.strongest) : "none", remark);
}

std::string record_name(const AllanRecord& record) {
  const std::string file = std::filesystem::path(record.capture).filename().string();
  return record.label().empty() ? file : file + " " + record.label();
}

std::string coefficient_cell(const AllanRecord& record, const NamedCoefficient& named) {
  if (!record.fit) return "unknown";
  const NoiseCoefficient& c = (*record.fit).*named.member;
  if (!c.present) return "< " + report::bound_text(c.upper * named.factor);
  return fmt::format("{:.4g} ± {:.2g}", c.value * named.factor, c.std_error * named.factor);
}

void print_cell(const std::string& text) { say("{:<20}", text); }

ordered_json allan_json(const std::vector<AllanRecord>& records, const AllanOptions& options) {
  ordered_json out;
  out["schema"] = "ifog.allan/1";
  out["sample_rate_hz"] = records.front().sample_rate_hz;
  out["estimator"] = estimator_name(options.kind);
  out["confidence"] = options.confidence;
  out["axes"] = ordered_json::array();
  for (const AllanRecord& record : records) {
    ordered_json axis;
    axis["axis"] = record.axis;
    axis["capture"] = record.capture;
    axis["signal"] = record.signal;
    axis["sample_rate_hz"] = record.sample_rate_hz;
    axis["samples"] = record.samples;
    axis["missing"] = record.missing;
    axis["gaps"] = record.gaps;
    axis["longest_stretch"] = record.longest;
    axis["mean_radps"] = record.mean_radps;
    axis["tau_s"] = record.tau_s;
    for (const char* key :
         {"adev_radps", "lower_radps", "upper_radps", "degrees_of_freedom", "noise_type", "terms"})
      axis[key] = ordered_json::array();
    for (std::size_t i = 0; i < record.points.size(); ++i) {
      const AllanInterval& interval = record.intervals[i];
      add_point(axis, record.points[i].variance, interval);
      axis["noise_type"].push_back(term_name(interval.strongest));
      axis["terms"].push_back(record.points[i].terms);
    }
    for (const LongPoint& point : record.longer) {
      axis["theo1"]["tau_s"].push_back(point.tau);
      add_point(axis["theo1"], point.variance, point.interval);
      axis["theo1"]["bias"].push_back(point.bias);
    }
    axis["trusted_tau_s"] = record.trusted_tau_s;
    // Without a fit, values and errors are unknown.
    axis["coefficients"] = report::coefficients_json(record.fit ? *record.fit : NoiseCoefficients{});
    if (!record.fit)
      for (auto& term : axis["coefficients"]) term["std_error"] = term["upper"] = nullptr;
    axis["misfit"] = record.fit ? ordered_json(record.fit->misfit) : ordered_json(nullptr);
    axis["gauss_markov"] = record.fit ? report::markov_json(record.fit->markov) : ordered_json(nullptr);
    axis["noise_changes"] = report::noise_changes_json(record.noise_changes);
    axis["findings"] = ordered_json::array();
    // Jumps and the resolution are in the notes only: version 1 of the schema has no such findings.
    for (const ValueFault& found : record.findings)
      if (found.name != "leaps" && found.name != "coarse")
        axis["findings"].push_back({{"name", found.name}, {"text", found.text}});
    axis["notes"] = record.notes;
    out["axes"].push_back(axis);
  }
  return out;
}

void print_allan(const AllanRecord& record, const AllanOptions& options) {
  say("{}{}{}: {} samples at {:.9g} Hz, {:.6g} s, mean {:.5g} °/h\n", record.capture,
      record.label().empty() ? "" : " ", record.label(), record.samples, record.sample_rate_hz,
      static_cast<double>(record.samples) / record.sample_rate_hz, record.mean_radps / kDegreePerHour);
  for (const std::string& note : record.notes) say("  note: {}\n", note);
  say("  {:>12}  {:>12}  {:>25}  {:>9}  {}\n", "tau s", "sigma deg/h",
      fmt::format("{:.3g} % interval", 100.0 * options.confidence), "degrees", "noise here");
  // Prints three points per decade, and all points that were requested.
  double next = 0.0;
  for (std::size_t i = 0; i < record.points.size(); ++i) {
    const bool last = i + 1 == record.points.size();
    if (options.tau_s.empty() && record.tau_s[i] < next && !last) continue;
    next = record.tau_s[i] * 2.1;
    print_point(record.tau_s[i], record.points[i].variance, record.intervals[i],
                record.trusted_tau_s > 0.0 && record.tau_s[i] > record.trusted_tau_s * 1.0001
                    ? "  (too few averages to trust)"
                    : "");
  }
  for (const LongPoint& point : record.longer)
    print_point(point.tau, point.variance, point.interval, "  (Theo1, corrected for its bias)");
  if (record.trusted_tau_s > 0.0)
    say("  Accurate to 25 % for τ up to {:.4g} s; a longer record shows more.\n", record.trusted_tau_s);
  if (record.fit) say("{}", report::coefficient_lines(*record.fit));
}

// One line per record, if there are several.
void print_comparison(const std::vector<AllanRecord>& records) {
  std::size_t width = 0;
  for (const AllanRecord& record : records)
    width = std::max(width, report::characters_in(record_name(record)) + 2);
  say("\n{:<{}}", "", width);
  for (const NamedCoefficient& named : named_coefficients())
    print_cell(std::string(named.letter) + " " + named.unit);
  say("lowest deviation °/h\n");
  for (const AllanRecord& record : records) {
    say("{:<{}}", record_name(record), width);
    for (const NamedCoefficient& named : named_coefficients()) print_cell(coefficient_cell(record, named));
    std::size_t lowest = 0;
    for (std::size_t i = 1; i < record.points.size(); ++i)
      if (record.points[i].variance < record.points[lowest].variance) lowest = i;
    say("{:.4g} at {:.4g} s\n", std::sqrt(record.points[lowest].variance) / kDegreePerHour,
        record.tau_s[lowest]);
  }
}

struct AllanArguments {
  CaptureInput input;
  std::vector<std::string> captures;
  AllanOptions options;
  std::string estimator = "overlapping", gaps = "part", moving = "leave-out", json, picture;
};

void run_allan(AllanArguments& a) {
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
  write_json(a.json, allan_json(records, a.options), 1);
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
                     {.required = true, .file = FileUse::read});
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
  command.add_option("--json", a->json, "Write the analysis here, in SI", kWritesJson);
  command.add_option("--plot", a->picture, "Write a picture here (.svg or .png)",
                     {.check = report::wrong_picture_name, .file = FileUse::written});
  command.callback([a] { run_allan(*a); });
}

}  // namespace ifog::tools
