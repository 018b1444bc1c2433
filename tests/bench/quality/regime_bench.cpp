// SPDX-License-Identifier: Apache-2.0
// The denoised rate in every regime, compared with the conventional Kalman filter with true Q and R at rest.
//
//   regime_bench [--seed FIRST] [--seeds N] [--qr Q/R]... [--regime NAME]... [--filter NAME] [--json F]
//
// Prints a markdown table. RMSE is over the judged samples against the true rate. "Over CKF" is its ratio to
// the RMSE of the conventional filter on the same record, median over seeds with least and most; the limit
// applies to it. "Over the better" is the ratio to the better of that filter and the raw samples; where it is
// judged, no seed may exceed the limit, which includes 5 % for chance. "Over informed" is the ratio to a
// conventional filter that also knows each sample's variance and the start of rest. It shows the possible
// gain, and how much of a good figure is a weakness of the conventional filter, which at small Q/R needs long
// to recover from motion or strong noise. NEES is the mean of (estimate − truth)²/variance, mean over seeds
// with least and most; where it is judged, 0.8 … 1.25 is required. The conventional filter's NEES shows the
// influence of chance. The last column names failed limits. Exit: 0 all limits kept, 1 not, 2 wrong usage.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "tests/bench/quality/trial.h"

namespace {

using ifog::bench::Figures;
using ifog::bench::Regime;
using Json = nlohmann::ordered_json;

constexpr double kLeastNees = 0.8, kMostNees = 1.25;

struct Options {
  std::uint64_t first_seed = 1;
  int seeds = 10;
  std::vector<double> ratios{1e-3, 1e-6, 1e-9};
  std::vector<std::string> regimes;
  std::string filter = "default", json;
};

struct Spread {
  std::vector<double> values;
  double median = 0.0, mean = 0.0, least = 0.0, most = 0.0;
};

Spread spread(const std::vector<Figures>& trials, double Figures::*figure) {
  Spread out;
  out.values.reserve(trials.size());
  for (const Figures& trial : trials) out.values.push_back(trial.*figure);
  std::vector<double> sorted = out.values;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  out.median = 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
  out.mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(n);
  out.least = sorted.front();
  out.most = sorted.back();
  return out;
}

struct Row {
  std::string regime;
  double ratio = 0.0, limit = 0.0;
  std::size_t settle = 0, judged = 0;
  bool raw_only = false;
  Spread over_conventional, over_raw, over_better, over_informed, nees, nees_conventional;
  std::vector<std::string> missed;
};

Row measure(const Regime& regime, double ratio, const Options& options) {
  std::vector<Figures> trials;
  trials.reserve(static_cast<std::size_t>(options.seeds));
  for (int i = 0; i < options.seeds; ++i)
    trials.push_back(ifog::bench::judge(regime, options.filter, ratio,
                                        options.first_seed + static_cast<std::uint64_t>(i)));
  Row row{.regime = regime.name,
          .ratio = ratio,
          .limit = regime.limit_at(ratio),
          .settle = trials[0].settle,
          .judged = trials[0].judged,
          .raw_only = regime.judge_raw_only,
          .over_conventional = spread(trials, &Figures::over_conventional),
          .over_raw = spread(trials, &Figures::over_raw),
          .over_better = spread(trials, &Figures::over_better),
          .over_informed = spread(trials, &Figures::over_informed),
          .nees = spread(trials, &Figures::nees),
          .nees_conventional = spread(trials, &Figures::nees_conventional),
          .missed = {}};
  if (regime.judge_raw_only) {
    if (!(row.over_raw.most <= row.limit)) row.missed.emplace_back("raw");
    return row;
  }
  if (!(row.over_conventional.median <= row.limit)) row.missed.emplace_back("limit");
  if (regime.judge_against_raw && !(row.over_better.most <= row.limit)) row.missed.emplace_back("better");
  if (regime.judge_variance && !(row.nees.mean >= kLeastNees && row.nees.mean <= kMostNees))
    row.missed.emplace_back("NEES");
  return row;
}

void print(const Row& row) {
  const Spread& beside = row.raw_only ? row.over_raw : row.over_better;
  std::printf("| %s | %g | %zu + %zu | %.3f (%.3f–%.3f) | %g | %.3f (–%.3f) | ", row.regime.c_str(),
              row.ratio, row.settle, row.judged, row.over_conventional.median, row.over_conventional.least,
              row.over_conventional.most, row.limit, beside.median, beside.most);
  if (std::isnan(row.over_informed.median)) {
    std::printf("– | ");
  } else {
    std::printf("%.3f | ", row.over_informed.median);
  }
  std::printf("%.3g (%.3g–%.3g) | %.3g | ", row.nees.mean, row.nees.least, row.nees.most,
              row.nees_conventional.mean);
  for (const std::string& what : row.missed) std::printf("**%s** ", what.c_str());
  std::printf("%s|\n", row.missed.empty() ? "ok " : "");
  std::fflush(stdout);
}

Json json(const Spread& s) {
  return {{"median", s.median}, {"mean", s.mean}, {"min", s.least}, {"max", s.most}, {"values", s.values}};
}

Json json(const Row& row) {
  Json out{{"regime", row.regime},
           {"ratio", row.ratio},
           {"settle_samples", row.settle},
           {"judged_samples", row.judged},
           {"limit", row.limit},
           {"over_conventional", json(row.over_conventional)},
           {"over_raw", json(row.over_raw)},
           {"over_better", json(row.over_better)}};
  out["over_informed"] = std::isnan(row.over_informed.median) ? Json(nullptr) : json(row.over_informed);
  out["nees"] = json(row.nees);
  out["nees_conventional"] = json(row.nees_conventional);
  out["missed"] = row.missed;
  return out;
}

// A name, or the beginning of several names: "sea" selects every sea.
bool wanted(const Regime& regime, const std::vector<std::string>& names) {
  return names.empty() || std::any_of(names.begin(), names.end(),
                                      [&](const std::string& name) { return regime.name.starts_with(name); });
}

std::string check_regime(const std::string& name) {
  std::string known;
  for (const Regime& regime : ifog::bench::regimes()) {
    if (wanted(regime, {name})) return "";
    known += " " + regime.name;
  }
  return "no regime \"" + name + "\"; there are:" + known;
}

bool write_json(const Options& options, const std::vector<Row>& rows) {
  Json out{{"schema", "ifog.regimes/1"},
           {"filter", options.filter},
           {"first_seed", options.first_seed},
           {"seeds", options.seeds},
           {"rows", Json::array()}};
  for (const Row& row : rows) out["rows"].push_back(json(row));
  std::ofstream file(options.json);
  file << out.dump(1) << '\n';
  file.close();
  if (!file) std::fprintf(stderr, "%s: cannot be written\n", options.json.c_str());
  return static_cast<bool>(file);
}

int run(const Options& options) {
  std::printf("Filter %s, seeds %llu to %llu, 200 Hz.\n\n", options.filter.c_str(),
              static_cast<unsigned long long>(options.first_seed),
              static_cast<unsigned long long>(options.first_seed) +
                  static_cast<unsigned long long>(options.seeds) - 1);
  std::printf(
      "| regime | Q/R | samples settled + judged | RMSE over CKF | limit | over the better | over informed | "
      "NEES | NEES of CKF | |\n|---|---|---|---|---|---|---|---|---|---|\n");
  std::vector<Row> rows;
  for (const Regime& regime : ifog::bench::regimes()) {
    if (!wanted(regime, options.regimes)) continue;
    for (const double ratio : options.ratios) {
      rows.push_back(measure(regime, ratio, options));
      print(rows.back());
    }
  }
  const auto held =
      std::count_if(rows.begin(), rows.end(), [](const Row& row) { return row.missed.empty(); });
  std::printf("\n%td of %zu rows within their limits.\n", held, rows.size());
  if (!options.json.empty() && !write_json(options, rows)) return 1;
  return held == static_cast<std::ptrdiff_t>(rows.size()) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"the denoised rate in every regime"};
  app.add_option("--seed", options.first_seed, "the first")->capture_default_str();
  app.add_option("--seeds", options.seeds, "how many")->check(CLI::Range(1, 10'000))->capture_default_str();
  app.add_option("--qr", options.ratios, "process over measurement variance, a sample")
      ->check(CLI::Range(1e-11, 1.0));
  app.add_option("--regime", options.regimes, "its name, or the beginning of several")->check(check_regime);
  app.add_option("--filter", options.filter)->check(CLI::IsMember(ifog::bench::filter_names()));
  app.add_option("--json", options.json, "every figure of every seed, to this file");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "regime_bench: %s\n", error.what());
    return 1;
  }
}
