// ifog diagnose: what the error is made of, what to correct, and what stays.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <list>
#include <memory>
#include <optional>
#include <stdexcept>

#include "drivers/capture/output_file.h"
#include "drivers/capture/text_file.h"
#include "drivers/ifog/quoted.h"
#include "drivers/transport/utc_now.h"
#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/record/derived_channels.h"
#include "filters/effects/compensate_series.h"
#include "filters/model_file/sha256.h"
#include "filters/units/field_units.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/time_part.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command_line.h"
#include "tools/ifog/console/json_file.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/diagnose/diagnosis_json.h"
#include "tools/ifog/diagnose/diagnosis_text.h"
#include "tools/report/diagnosis_page.h"

namespace ifog::tools {
namespace {

struct Arguments {
  CaptureInput input;
  TimePart part;
  std::vector<std::string> captures;
  std::string model, write_model, json, report;
  std::vector<std::string> axes;
  double significance = 0.01;
  double fit_from = 0.0, fit_to = 1.0;
  std::optional<double> since_power_up_s;
  bool quiet = false;
  bool earth = false;
  std::optional<double> latitude_deg;
};

// The model's own effects are subtracted first, by the code that subtracts them online.
void compensate(Capture& capture, const Model& model, std::optional<double> since_power_up_s) {
  Compensator compensator(model, capture.axes, std::numeric_limits<double>::infinity(), since_power_up_s);
  SeriesToCompensate series{capture.time_s, {capture.rate_radps.begin(), capture.rate_radps.end()}, {}};
  for (const std::string& name : compensator.channels()) {
    const CaptureColumn* found = nullptr;
    for (const CaptureColumn& column : capture.channels) {
      if (column.name == name) found = &column;
    }
    if (!found)
      throw std::runtime_error("the model wants channel " + in_quotes(name) +
                               ", which the capture does not have");
    series.channels.emplace_back(found->values);
  }
  compensate_series(compensator, series, [&](std::size_t i, const CompensatorOutput& out) {
    for (std::size_t a = 0; a < capture.axes.size(); ++a) capture.rate_radps[a][i] = out.compensated_radps[a];
  });
}

Record record_of(const Capture& capture, const std::string& name, std::size_t axis) {
  Record record;
  record.name = name;
  record.time_s = capture.time_s;
  record.rate_radps = capture.rate_radps[axis];
  if (!capture.reference_rate_radps[axis].empty())
    record.reference_radps = capture.reference_rate_radps[axis];
  record.reference_name =
      capture.axes[axis].empty() ? "reference_rate_radps" : "reference_rate_" + capture.axes[axis] + "_radps";
  for (const CaptureColumn& column : capture.channels)
    record.channels.push_back({column.name, column.values});
  for (std::size_t other = 0; other < capture.axes.size(); ++other)
    if (other != axis)
      record.other_axes.push_back({rate_of_axis(capture.axes[other]), capture.rate_radps[other]});
  return record;
}

// What a triad at rest says of the Earth: its mean rate along the mean specific force is the vertical part of
// the Earth's rate, whatever the mounting. Empty unless there are three gyros and three accelerometers.
std::string vertical_rate(const Capture& capture) {
  if (capture.axes != std::vector<std::string>{"x", "y", "z"}) return "";
  std::array<double, 3> rate{};
  std::array<double, 3> force{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto mean = [](const std::vector<double>& values) {
      double sum = 0.0;
      double n = 0.0;
      for (const double v : values) {
        if (!std::isfinite(v)) continue;
        sum += v;
        n += 1.0;
      }
      return n > 0.0 ? sum / n : 0.0;
    };
    rate[a] = mean(capture.rate_radps[a]);
    const CaptureColumn* accel = nullptr;
    for (const CaptureColumn& column : capture.channels) {
      if (column.name == "accel_" + capture.axes[a] + "_mps2") accel = &column;
    }
    if (!accel) return "";
    force[a] = mean(accel->values);
  }
  const double g = std::sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
  if (g < 9.0 || g > 10.5) return "";
  constexpr double kEarth = 7.292115e-5;  // rad/s, WGS 84
  const double up = (rate[0] * force[0] + rate[1] * force[1] + rate[2] * force[2]) / g;
  if (std::abs(up) > kEarth) return "";
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(),
                "the rate along the mean specific force is %.3f °/h; if the sensor stood still, that is the "
                "Earth's rate "
                "at latitude %.2f°",
                up / kDegreePerHour, std::asin(up / kEarth) / kDegree);
  return text.data();
}

std::vector<AxisDiagnosis> all_axes(const std::vector<Capture>& captures, const Arguments& arguments) {
  std::vector<AxisDiagnosis> found;
  const std::vector<std::string>& axes = captures.front().axes;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (!arguments.axes.empty() &&
        std::find(arguments.axes.begin(), arguments.axes.end(), axes[axis]) == arguments.axes.end()) {
      continue;
    }
    std::vector<Record> records;
    for (std::size_t c = 0; c < captures.size(); ++c) {
      if (captures[c].axes != axes) {
        throw std::runtime_error(arguments.captures[c] + ": has other axes than " + arguments.captures[0]);
      }
      records.push_back(record_of(captures[c], arguments.captures[c], axis));
    }
    DiagnoseOptions options;
    options.significance = arguments.significance;
    options.axis = axes[axis];
    options.fit_from = arguments.fit_from;
    options.fit_to = arguments.fit_to;
    options.subtract_earth_rate = arguments.earth;
    if (arguments.latitude_deg) options.latitude_rad = *arguments.latitude_deg * kDegree;
    auto progress = std::make_unique<Progress>(axes[axis].empty() ? "diagnose" : "diagnose " + axes[axis],
                                               options.most_effects + 1);
    options.progress = [&](std::size_t done, std::size_t) { progress->at(done); };
    Diagnosis diagnosis;
    try {
      diagnosis = diagnose(records, options);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(arguments.captures.front() + ": " + error.what());
    }
    progress.reset();
    found.push_back({axes[axis], std::move(diagnosis)});
  }
  if (!found.empty())
    for (const Capture& capture : captures) {
      auto& remarks = found.front().diagnosis.remarks;
      remarks.insert(remarks.begin(), capture.faults.begin(), capture.faults.end());
    }
  const std::string earth = captures.size() == 1 ? vertical_rate(captures.front()) : "";
  if (!found.empty() && !earth.empty()) found.front().diagnosis.remarks.push_back(earth);
  if (found.empty()) throw std::runtime_error("no such axis in " + arguments.captures[0]);
  return found;
}

Model model_of(const std::vector<AxisDiagnosis>& found, const Arguments& arguments,
               const std::vector<std::string>& hashes, Model model) {
  for (const AxisDiagnosis& each : found) {
    add_to_model(each.diagnosis, each.axis, model);
    const std::string prefix = each.axis.empty() ? "" : each.axis + ".";
    for (const auto& [name, value] : each.diagnosis.before) model.source.before[prefix + name] = value;
    for (const auto& [name, value] : each.diagnosis.after) model.source.after[prefix + name] = value;
  }
  model.source.capture.clear();
  for (const std::string& path : arguments.captures)
    model.source.capture += (model.source.capture.empty() ? "" : ", ") + printable(path, kLongestMessage);
  std::string all;
  for (const std::string& hash : hashes) all += hash;
  model.source.sha256 = hashes.size() == 1 ? all : sha256_hex(all);
  model.source.date = utc_now();
  return model;
}

void write_report(const std::vector<Capture>& captures, const std::vector<AxisDiagnosis>& found,
                  const Arguments& arguments, const std::vector<std::string>& hashes) {
  report::Page page;
  page.captures = arguments.captures;
  page.sensor = std::filesystem::path(arguments.captures.front()).filename().string();
  page.model_path = arguments.write_model;
  page.made = utc_now() + " by ifog " IFOG_VERSION;
  page.command = typed_command();
  for (std::size_t c = 0; c < captures.size(); ++c)
    page.inputs.push_back({arguments.captures[c], hashes[c], captures[c].comments});
  const std::vector<std::string>& axes = captures.front().axes;
  std::list<DerivedRecords> derived;  // whose columns the page draws
  for (const AxisDiagnosis& each : found) {
    report::PageAxis axis{each.axis, &each.diagnosis, {}};
    const auto index =
        static_cast<std::size_t>(std::find(axes.begin(), axes.end(), each.axis) - axes.begin());
    std::vector<Record> records;
    for (std::size_t c = 0; c < captures.size(); ++c)
      records.push_back(record_of(captures[c], arguments.captures[c], index));
    derived.push_back(with_derived_channels(records));
    axis.records = derived.back().records;
    page.axes.push_back(std::move(axis));
  }
  write_text_file(arguments.report, report::diagnosis_page(page));
}

void run(const Arguments& arguments) {
  will_write("--json", arguments.json);
  will_write("--write-model", arguments.write_model);
  will_write("--report", arguments.report);
  std::vector<Capture> captures;
  std::vector<std::string> hashes;  // for the model file, which says what it was found on
  for (const std::string& path : arguments.captures) {
    hashes.emplace_back();
    const bool wanted = !arguments.write_model.empty() || !arguments.report.empty();
    captures.push_back(arguments.input.read(path, wanted ? &hashes.back() : nullptr));
  }
  Model model;
  if (!arguments.model.empty()) {
    model = read_model(arguments.model);
    for (Capture& capture : captures) compensate(capture, model, arguments.since_power_up_s);
  }
  for (std::size_t c = 0; c < captures.size(); ++c) arguments.part.cut(captures[c], arguments.captures[c]);
  const std::vector<AxisDiagnosis> found = all_axes(captures, arguments);
  if (!arguments.quiet) {
    for (const AxisDiagnosis& each : found)
      say("%s%s", &each == &found.front() ? "" : "\n", diagnosis_text(each).c_str());
  }
  if (!arguments.json.empty()) write_json(arguments.json, diagnosis_json(found));
  if (!arguments.write_model.empty())
    write_file(arguments.write_model, model_text(model_of(found, arguments, hashes, model)));
  if (!arguments.report.empty()) write_report(captures, found, arguments, hashes);
}

}  // namespace

void add_diagnose(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("diagnose", "trace the error to its effects, with the model that corrects them");
  command->add_option("capture", arguments->captures, "captures of one sensor, fitted together")->required();
  arguments->input.add_to(*command);
  arguments->part.add_to(*command);
  command->add_option("--axis", arguments->axes, "only these axes");
  command->add_option("--model", arguments->model, "correct with this model first; find what it leaves");
  command
      ->add_option("--since-power-up", arguments->since_power_up_s,
                   "seconds from power-up to the captures' first sample: a warm_up of --model is corrected")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--write-model", arguments->write_model, "write the model with what was found");
  command->add_option("--json", arguments->json, "write the diagnosis as JSON");
  command->add_option("--report", arguments->report, "write the diagnosis as one self-contained HTML page");
  command
      ->add_option("--significance", arguments->significance,
                   "chance of a false effect, after correction for all tried")
      ->check(CLI::Range(1e-9, 0.5))
      ->capture_default_str();
  command
      ->add_option("--fit-from", arguments->fit_from,
                   "fit from this share of each capture's time; the rest judges")
      ->check(CLI::Range(0.0, 0.9));
  command
      ->add_option("--fit-to", arguments->fit_to,
                   "fit up to this share of each capture's time; the rest judges")
      ->check(CLI::Range(0.1, 1.0));
  command->add_flag(
      "--earth", arguments->earth,
      "subtract what is the Earth's rate by its size in a gyro that tilts; otherwise it is shown");
  command
      ->add_option("--latitude", arguments->latitude_deg,
                   "of the captures, degrees: bounds what can be the Earth's rate")
      ->check(CLI::Range(-90.0, 90.0));
  command->add_flag("--quiet", arguments->quiet, "no report on the console");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace ifog::tools
