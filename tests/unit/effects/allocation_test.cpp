// SPDX-License-Identifier: Apache-2.0
// Heap allocations of Compensator::step() with a rebuilt ramp: none, while its phase is sought, found, lost
// in gaps and turns, and taken over at a reload.
#include "filters/effects/compensator.h"
#include "tests/unit/malloc_counter.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog;
using namespace ifog::test;

Model model() {
  Effect effect;
  effect.form = "rebuilt_ramp";
  effect.angle = true;
  effect.period = 1.0;
  for (int i = 0; i <= 64; ++i) {
    effect.table_x.push_back(i / 64.0);
    effect.table_y.push_back(4e-9 * std::sin(2.0 * M_PI * i / 64.0));
  }
  effect.parameters = {{"cycles_per_rad", 77e3, 0.0, ""}, {"noise_density", 1e-9, 0.0, ""}};
  Model made;
  made.effects = {effect};
  return made;
}

TEST(Allocation, NoStepOfARebuiltRampAllocates) {
  if (!allocations_can_be_counted())
    GTEST_SKIP() << "a sanitizer has its own allocator; a build without one (preset release) counts";
  ASSERT_TRUE(allocation_counter_works());
  Compensator compensator(model(), {""});
  Compensator reloaded(model(), {""});
  Noise normal(1);
  CompensatorInput in;
  CompensatorOutput out;
  double phase = 0.3;
  int known = 0;
  int unknown = 0;
  count_allocations(true);
  for (int i = 0; i < 20000; ++i) {
    const double truth = i % 5000 > 4000 ? 0.1 : 5.4e-5;
    const double before = 4e-9 * std::sin(2.0 * M_PI * phase);
    phase += 77e3 * truth * 0.005;
    in.dt_s = 0.005;
    in.rate_radps[0] = truth + (4e-9 * std::sin(2.0 * M_PI * phase) - before) / 0.005 + 1e-8 * normal();
    if (i % 701 == 7) in.rate_radps[0] = std::nan("");
    in.missed_s[0] = i % 3001 == 3000 ? 0.004 : 0.0;
    if (i == 10000) reloaded.take_over(compensator);
    (i < 10000 ? compensator : reloaded).step(in, out);
    ++((out.flags & kRampUnknown) != 0 ? unknown : known);
  }
  count_allocations(false);
  EXPECT_EQ(take_allocations(), 0U);
  EXPECT_GT(known, 1000);
  EXPECT_GT(unknown, 1000);
}

}  // namespace
