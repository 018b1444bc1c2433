// SPDX-License-Identifier: Apache-2.0
// A fixed handful of the bench's sensors: enough to notice when the diagnosis breaks, not to measure it. What
// it is worth is measured by score_undeclared.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <span>

#include "filters/diagnosis/record/compensated_error.h"
#include "filters/diagnosis/record/even_grid.h"
#include "tests/bench/undeclared/contradictions.h"
#include "tests/bench/undeclared/logging_faults.h"
#include "tests/bench/undeclared/project_diagnosis.h"
#include "tests/bench/undeclared/tally.h"

namespace {

using namespace ifog::undeclared;

TEST(UndeclaredDiagnosis, FindsWhatIsHiddenAndNothingElse) {
  std::vector<Score> scores;
  std::uint64_t seed = 7000;
  for (const Kind kind : kinds_with_effect())
    scores.push_back(score(draw_sensor(seed++, kind, 40.0), project_diagnosis()));
  print_failures(std::cout, scores);
  const Totals t = total(scores);
  EXPECT_GE(t.right, t.sensors - 1);
  EXPECT_LE(t.extra, 1);
  EXPECT_EQ(t.made_worse, 0);
}

TEST(UndeclaredDiagnosis, FindsNothingWhereNothingIs) {
  std::vector<Score> scores;
  for (std::uint64_t seed = 8000; seed < 8016; ++seed)
    scores.push_back(score(draw_sensor(seed, seed % 4 == 3 ? Kind::kLookalike : Kind::kNothing, 0.0),
                           project_diagnosis()));
  print_failures(std::cout, scores);
  EXPECT_EQ(total(scores).false_alarms, 0);
}

// Root mean square about the mean.
double rms(std::span<const double> values) {
  double sum = 0.0, square = 0.0;
  for (const double v : values) sum += v, square += v * v;
  const double n = static_cast<double>(values.size());
  return std::sqrt(square / n - sum / n * (sum / n));
}

// Whatever is hidden, and whatever the logger did: the correction that the findings write does not make the
// error of this capture larger, and leaves no more of it than the report says.
TEST(UndeclaredDiagnosis, NoReportPromisesWhatItsModelDoesNotKeep) {
  std::uint64_t seed = 7500;
  std::vector<std::string> faults = {""};
  faults.insert(faults.end(), logging_faults().begin(), logging_faults().end());
  std::size_t turn = 0;
  for (std::size_t k = 0; k < kinds_with_effect().size(); k += 2) {
    const Kind kind = kinds_with_effect()[k];
    const Sensor sensor = draw_sensor(seed++, kind, 30.0);
    const std::string& fault = faults[turn++ % faults.size()];
    std::vector<ifog::Capture> captures = {record(sensor, 0).capture};
    if (!fault.empty()) captures = spoilt(fault, captures);
    const ifog::Capture& capture = captures[0];
    const ifog::Record logged = record_of(capture, "capture", 0);
    const ifog::Diagnosis d = ifog::diagnose({logged}, {});
    ifog::Model model;
    ifog::add_to_model(d, "", model);
    const std::string where = std::string(name_of(kind)) + " " + fault;
    const double before = rms(ifog::error_of(logged));
    EXPECT_NEAR(d.before.at("residual_rms_radps"), before, 1e-3 * before) << where;
    EXPECT_LE(d.after.at("residual_rms_radps"), 1.02 * before) << where;
    for (const std::string& each : contradictions(d, captures)) ADD_FAILURE() << where << ": " << each;
    if (fault.empty() || fault == "hole") {
      const double left = rms(ifog::compensated_error(logged, model));
      EXPECT_LE(left, 1.001 * d.after.at("residual_rms_radps")) << where;
    }
  }
}

TEST(UndeclaredDiagnosis, WhatTheLoggerDidHidesNoEffect) {
  std::vector<Score> scores;
  std::uint64_t seed = 7600;
  for (const std::string& fault : logging_faults())
    for (const Kind kind : {Kind::kTemperatureRate, Kind::kSupply})
      scores.push_back(score(draw_sensor(seed++, kind, 50.0), logged_with(fault, project_diagnosis())));
  print_failures(std::cout, scores);
  const Totals t = total(scores);
  EXPECT_GE(t.right, t.sensors - 1);
  EXPECT_LE(t.extra, 1);
}

// Two short captures, each with a switch-on bias of its own, say what neither says as well alone.
TEST(UndeclaredDiagnosis, SeveralCapturesAreFittedTogether) {
  const Score s = score(draw_sensor(9000, Kind::kTemperatureLinear, 40.0, 2), project_diagnosis());
  EXPECT_TRUE(s.right()) << s.names;
  EXPECT_EQ(s.extra, 0) << s.names;
}

}  // namespace
