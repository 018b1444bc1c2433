// SPDX-License-Identifier: Apache-2.0
// Scores the diagnosis on sensors with unknown effects. Without arguments: 1000 sensors with effects of 12 to
// 80 sigma and 1000 without. Every sensor is reproducible from its seed.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <optional>
#include <sstream>
#include <thread>

#include "tests/bench/undeclared/logging_faults.h"
#include "tests/bench/undeclared/oracle_diagnosis.h"
#include "tests/bench/undeclared/project_diagnosis.h"
#include "tests/bench/undeclared/structure.h"
#include "tests/bench/undeclared/tally.h"

using namespace ifog::undeclared;

namespace {

struct Options {
  int with = 1000, without = 1000, captures = 1;
  std::uint64_t seed = 1;
  double sigma_low = 12.0, sigma_high = 80.0;
  std::string kind, method = "ifog", fault, structure;
  bool curve = false, quiet = false, promises = false;
  int jobs = 1;
  double minutes = 1e6;
  std::vector<std::uint64_t> only;
};

std::uint64_t seed_at(const Options& o, int place, bool with_effect) {
  return o.seed * 1'000'000U + (with_effect ? 0U : 500'000U) + static_cast<std::uint64_t>(place);
}

bool wanted(const Options& o, std::uint64_t seed) {
  return o.only.empty() || std::find(o.only.begin(), o.only.end(), seed) != o.only.end();
}

// The next sensor of the series; `place` cycles through the kinds so that every size occurs with every kind.
Sensor sensor_at(const Options& o, int place, bool with_effect) {
  const std::uint64_t seed = seed_at(o, place, with_effect);
  Draw draw(seed, 999);
  const auto& kinds = kinds_with_effect();
  Kind kind = with_effect      ? kinds[static_cast<std::size_t>(place) % kinds.size()]
              : place % 4 == 3 ? Kind::kLookalike
                               : Kind::kNothing;
  if (with_effect && !o.kind.empty()) {
    for (const Kind k : kinds)
      if (o.kind == name_of(k)) kind = k;
  }
  const double sigma = o.curve ? 4.0 + place / static_cast<int>(kinds.size()) % 9
                               : draw.log_uniform(o.sigma_low, o.sigma_high);
  return draw_sensor(seed, kind, sigma, o.captures);
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("--with", o.with, "sensors with effects");
  app.add_option("--without", o.without, "sensors without");
  app.add_option("--captures", o.captures, "captures of each sensor, diagnosed together")
      ->check(CLI::Range(1, 3));
  app.add_option("--seed", o.seed, "of the series");
  app.add_option("--sigma-low", o.sigma_low);
  app.add_option("--sigma-high", o.sigma_high);
  app.add_option("--kind", o.kind, "only this kind, as named in the table");
  app.add_option("--method", o.method)->check(CLI::IsMember({"ifog", "oracle", "blind"}));
  app.add_option("--fault", o.fault, "of the logger, in every capture that is diagnosed")
      ->check(CLI::IsMember(logging_faults()));
  app.add_option("--structure", o.structure, "what every sensor stands on while it is diagnosed")
      ->check(CLI::IsMember(structures()));
  app.add_flag("--curve", o.curve, "sizes 4, 5, … 12 sigma in turn: the detection curve");
  app.add_flag("--promises", o.promises, "list every effect, interval and heading error by sensor");
  app.add_flag("--quiet", o.quiet, "no list of failures");
  app.add_option("--jobs", o.jobs, "sensors at a time")->check(CLI::Range(1, 256));
  app.add_option("--minutes", o.minutes,
                 "no new sensor after so long; the tables are of those scored by then");
  app.add_option("--only", o.only, "only the sensors of these seeds, as the list of failures gives them");
}

struct Place {
  int number;
  bool with_effect;
};

// Alternately with and without effects, so that an interrupted run has both.
std::vector<Place> places_of(const Options& o) {
  std::vector<Place> places;
  for (int i = 0; i < std::max(o.with, o.without); ++i)
    for (const bool with_effect : {true, false})
      if (i < (with_effect ? o.with : o.without) && wanted(o, seed_at(o, i, with_effect)))
        places.push_back({i, with_effect});
  return places;
}

Score score_at(const Options& o, const Place& place) {
  const Sensor sensor = sensor_at(o, place.number, place.with_effect);
  Diagnose method = o.method == "ifog"     ? project_diagnosis()
                    : o.method == "oracle" ? oracle_diagnosis(sensor)
                                           : blind_diagnosis();
  if (!o.fault.empty()) method = logged_with(o.fault, method);
  if (!o.structure.empty()) method = moved_by(o.structure, sensor, method);
  return score(sensor, method);
}

// Sensors are independent; a score's place does not depend on the thread.
std::vector<std::optional<Score>> scored(const Options& o, const std::vector<Place>& places) {
  std::vector<std::optional<Score>> made(places.size());
  const auto start = std::chrono::steady_clock::now();
  const auto late = [&] {
    return std::chrono::steady_clock::now() - start > std::chrono::duration<double>(60.0 * o.minutes);
  };
  std::atomic<std::size_t> next{0}, done{0};
  {
    std::vector<std::jthread> threads;
    for (int job = 0; job < o.jobs; ++job)
      threads.emplace_back([&] {
        for (std::size_t i = next++; i < places.size() && !late(); i = next++) {
          made[i] = score_at(o, places[i]);
          if (++done % 50 == 0) std::fprintf(stderr, "%zu of %zu\n", done.load(), places.size());
          std::ostringstream wrong;
          print_failures(wrong, {*made[i]});
          std::fputs(wrong.str().c_str(), stderr);
        }
      });
  }
  return made;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  CLI::App app{"score the diagnosis on undeclared effects"};
  add_options(app, o);
  CLI11_PARSE(app, argc, argv);
  const std::vector<Place> places = places_of(o);
  const std::vector<std::optional<Score>> made = scored(o, places);
  std::vector<Score> scores;
  for (const bool with_effect : {true, false})
    for (std::size_t i = 0; i < places.size(); ++i)
      if (made[i] && places[i].with_effect == with_effect) scores.push_back(*made[i]);
  if (scores.size() < places.size())
    std::cout << "stopped after " << o.minutes << " minutes: " << scores.size() << " of " << places.size()
              << " sensors\n";
  if (!o.quiet) print_failures(std::cout, scores);
  if (o.promises) print_promises(std::cout, scores);
  print(std::cout, scores);
  return 0;
}
