// SPDX-License-Identifier: Apache-2.0
// Heap allocations of Estimator::step(): none, whatever the rule, the weights and the model, through rest,
// outliers, gaps, missing samples, a manoeuvre and a divergence.
#include "filters/rules/rule.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/malloc_counter.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog::test;

std::uint64_t allocations_of(const ifog::FilterSettings& settings) {
  const Record r =
      record(3, 4000, 1e-3, [](int i) { return i < 2000 ? 0.0 : (i < 2500 ? 30.0 : 0.05 * (i - 2500)); });
  Fed filter(settings, 3);
  count_allocations(true);
  for (std::size_t i = 0; i < r.measured.size(); ++i) {
    filter.in.dt_s = i % 701 == 700 ? 20 * kPeriod : kPeriod;
    filter.in.valid_axes = i % 97 == 5 ? 5 : 7;
    const double rate = i == 1500 ? 1e4 : (i % 501 == 7 ? std::nan("") : r.measured[i]);
    filter.step({rate, -rate, 0.5 * rate});
  }
  count_allocations(false);
  return take_allocations();
}

TEST(Allocation, NoStepAllocates) {
  if (!allocations_can_be_counted())
    GTEST_SKIP() << "a sanitizer has its own allocator; a build without one (preset release) counts";
  ASSERT_TRUE(allocation_counter_works());

  struct Model {
    const char* name;
    std::vector<double> parameters;
  };
  const std::vector<Model> models{
      {"random-walk", {}},
      {"integrated-random-walk", {}},
      {"arma(2,1)", {0.5, 0.2, 0.3}},
      {"random-walk + ar(3) + harmonic + harmonic", {0.5, 0.1, 0.1, 1.0, 4.17, 0.1, 8.34, 0.1}}};
  for (const Model& model : models) {
    for (const ifog::RuleEntry& rule : ifog::rules()) {
      for (const char* weights : {"kept", "fresh", "uniform"}) {
        ifog::FilterSettings settings = told(1e-3);
        settings.state = model.name;
        settings.state_parameters = model.parameters;
        settings.rule = rule.name;
        settings.weights = weights;
        settings.draws = 3;
        EXPECT_EQ(allocations_of(settings), 0U) << rule.name << ", " << weights << ", " << model.name;
        if (settings.rule != "irwe-akfg") break;  // the others draw no weights
      }
    }
  }
  ifog::FilterSettings lost = told(1e-9);
  lost.rule = "ckf";
  lost.follow_manoeuvres = false;
  EXPECT_EQ(allocations_of(lost), 0U);
}

}  // namespace
