// SPDX-License-Identifier: Apache-2.0
// Writes captures of a sensor with undeclared effects, and the hidden effects in a separate folder that a
// reader of the captures cannot see.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/csv/csv_writer.h"
#include "drivers/capture/files/output_file.h"
#include "tests/bench/undeclared/sensor.h"

// All captures here have one axis.
static void write(const ifog::Capture& capture, const std::string& path) {
  std::vector<std::string> names{"time_s", "rate_radps"};
  std::vector<std::span<const double>> columns{capture.time_s, capture.rate_radps[0]};
  if (!capture.reference_rate_radps[0].empty()) {
    names.emplace_back("reference_rate_radps");
    columns.emplace_back(capture.reference_rate_radps[0]);
  }
  for (const ifog::CaptureColumn& channel : capture.channels) {
    names.push_back(channel.name);
    columns.emplace_back(channel.values);
  }
  std::string comments;
  for (const std::string& comment : capture.comments) comments += comment + '\n';
  ifog::CsvWriter file(path, comments, names);
  file.rows(columns, capture.origin);
  file.finish();
}

int main(int argc, char** argv) {
  using namespace ifog::undeclared;
  std::uint64_t seed = 1;
  double sigma = 40.0;
  int captures = 1;
  std::string kind_name = "temperature linear", folder, truth;
  CLI::App app{"make captures with undeclared effects"};
  app.add_option("--seed", seed);
  app.add_option("--kind", kind_name,
                 "as in the table of score_undeclared; also 'nothing', 'lookalike walk'");
  app.add_option("--sigma", sigma, "GLS visibility of each effect");
  app.add_option("--captures", captures, "to be diagnosed together")->check(CLI::Range(1, 3));
  app.add_option("--output", folder, "folder for capture1.csv … and next.csv, another capture to judge on")
      ->required();
  app.add_option("--truth", truth, "folder for truth.json and next_effect.csv")->required();
  CLI11_PARSE(app, argc, argv);

  std::vector<Kind> kinds = kinds_with_effect();
  kinds.insert(kinds.end(), {Kind::kNothing, Kind::kLookalike});
  for (const Kind kind : kinds) {
    if (kind_name != name_of(kind)) continue;
    const Sensor sensor = draw_sensor(seed, kind, sigma, captures);
    std::filesystem::create_directories(folder);
    std::filesystem::create_directories(truth);
    for (int c = 0; c < captures; ++c)
      write(record(sensor, c).capture, folder + "/capture" + std::to_string(c + 1) + ".csv");
    const Record next = record(sensor, 50);
    write(next.capture, folder + "/next.csv");
    ifog::Capture hidden;  // the sum of the true effects in next.csv, as a rate
    hidden.time_s = next.capture.time_s;
    hidden.axes = {""};
    hidden.rate_radps = {std::vector<double>(hidden.size(), 0.0)};
    hidden.reference_rate_radps = {{}};
    for (const auto& effect : next.effects)
      for (std::size_t k = 0; k < hidden.size(); ++k) hidden.rate_radps[0][k] += effect[k];
    write(hidden, truth + "/next_effect.csv");
    ifog::write_file(truth + "/truth.json", truth_text(sensor));
    return 0;
  }
  std::cerr << "make_undeclared: --kind is '" << kind_name << "', expected a kind of the table\n";
  return 2;
}
