// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/notice/noise_kinds.h"

#include <cmath>

namespace ifog::bench {
namespace {

constexpr double kFloor = 0.664;  // of B

double instability_from(double floor_s) { return 1.0 / std::sqrt(floor_s) / kFloor; }

}  // namespace

std::vector<NoiseKind> kinds() {
  std::vector<NoiseKind> out{{"white", 1.0, 0.0, 0.0}};
  for (const double floor_s : {30.0, 100.0, 300.0, 1000.0})
    out.push_back({"N, B from " + std::to_string(static_cast<int>(floor_s)) + " s", 1.0,
                   instability_from(floor_s), 0.0});
  for (const double floor_s : {100.0, 300.0, 1000.0})
    out.push_back({"N, K from " + std::to_string(static_cast<int>(floor_s)) + " s", 1.0, 0.0,
                   std::sqrt(3.0) / floor_s});
  return out;
}

std::vector<NoiseKind> wandering_kinds() {
  const double B = instability_from(300.0);
  return {{"N, day", 1.0, 0.0, 0.0, 10.0 * B, 0.0},
          {"N, hour", 1.0, 0.0, 0.0, 0.0, 2.0 * B},
          {"N, B 300 s, day, hour", 1.0, B, 0.0, 10.0 * B, 2.0 * B}};
}

double bias_instability(const NoiseKind& kind) {
  if (kind.B > 0.0) return kind.B;
  if (kind.K > 0.0) return std::sqrt(2.0 / std::sqrt(3.0) * kind.N * kind.K) / kFloor;
  return 0.0;
}

}  // namespace ifog::bench
