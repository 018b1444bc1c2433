// SPDX-License-Identifier: Apache-2.0
// Pipeline runs with random faults, one per seed: are all data accounted for, is the angle that of the intact
// frames, and is anything left over?
#include <CLI/CLI.hpp>
#include <cstdio>

#include "tests/unit/daemon/faults/random_faults.h"

int main(int argc, char** argv) {
  CLI::App app("Runs with random faults; exit 1 if anything did not hold", "books_bench");
  unsigned runs = 5000, first = 1'000'000;  // differ from the unit test's
  app.add_option("--runs", runs)->check(CLI::PositiveNumber);
  app.add_option("--first", first, "seed of the first run");
  CLI11_PARSE(app, argc, argv);
  constexpr unsigned kWarm = 50;
  unsigned failed = 0;
  ifog::Held before;
  for (unsigned n = 0; n < runs; ++n) {
    if (n == kWarm) before = ifog::held_by_process();
    const std::string findings = ifog::random_faults(first + n);
    if (findings.empty()) continue;
    ++failed;
    std::printf("seed %u:\n%s\n", first + n, findings.c_str());
  }
  const ifog::Held after = ifog::held_by_process();
  std::printf("%u runs, %u with findings\n", runs, failed);
  if (runs > kWarm)
    std::printf("held after %u runs and at the end: %d and %d descriptors, %zu and %zu bytes\n", kWarm,
                before.descriptors, after.descriptors, before.bytes, after.bytes);
  return failed == 0 ? 0 : 1;
}
