// SPDX-License-Identifier: Apache-2.0
// Checks recorded messages of a reload with a new model: every sample is there, and the model changes once.
// Before and after the change the compensated rate is bit for bit that of `ifog denoise` with the respective
// model. The published angle is the sum of the increments to 1e-12 rad.
//
// usage: log_reload LOG CHANNEL BEFORE.csv AFTER.csv
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/system/log_columns.h"

namespace {

int check(char** argv) {
  const auto messages = read_log(argv[1], argv[2]);
  const auto before = read_columns(argv[3]).at("compensated_radps");
  const auto after = read_columns(argv[4]).at("compensated_radps");
  if (messages.size() != before.size()) {
    std::fprintf(stderr, "%zu messages in the log, %zu samples in the capture\n", messages.size(),
                 before.size());
    return 1;
  }
  std::size_t changes = 0;
  std::size_t changed_at = 0;
  std::size_t different = 0;
  long double sum = 0.0L;
  double off = 0.0;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (i > 0 && messages[i].seq != messages[i - 1].seq + 1) {
      std::fprintf(stderr, "sequence %lld after %lld\n", static_cast<long long>(messages[i].seq),
                   static_cast<long long>(messages[i - 1].seq));
      return 1;
    }
    if (i > 0 && messages[i].model != messages[i - 1].model) {
      ++changes;
      changed_at = i;
    }
    if (i > 0) sum += messages[i].delta_theta.at(0);
    off =
        std::max(off, std::abs(static_cast<double>(messages[i].angle.at(0) - messages[0].angle.at(0) - sum)));
    const double expected = changes == 0 ? before.at(i) : after.at(i);
    different += same_bits(messages[i].compensated.at(0), expected) ? 0 : 1;
  }
  std::printf("%zu samples, the model changed %zu times, at %zu; %zu differences; angle off by %.1e rad\n",
              messages.size(), changes, changed_at, different, off);
  return changes == 1 && different == 0 && off <= 1e-12 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: log_reload LOG CHANNEL BEFORE.csv AFTER.csv\n");
    return 2;
  }
  try {
    return check(argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "log_reload: %s\n", error.what());
    return 1;
  }
}
