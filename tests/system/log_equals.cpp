// SPDX-License-Identifier: Apache-2.0
// Compares recorded messages of the daemon with the output of `ifog denoise` for the same frames: bit for
// bit, sample by sample.
//
// usage: log_equals LOG CHANNEL DENOISED.csv [CAPTURE.csv RESOLUTION_RADPS] With a capture also: raw equals
// the capture's rate within half of the frame format's resolution.
#include <cstdio>
#include <cstdlib>

#include "tests/system/log_columns.h"

namespace {

int compare(int argc, char** argv) {
  const auto messages = read_log(argv[1], argv[2]);
  const auto denoised = read_columns(argv[3]);
  if (messages.empty()) throw std::runtime_error("the log has no message on " + std::string(argv[2]));
  const std::vector<std::pair<std::string, std::vector<double> ifog::rate_t::*>> fields = {
      {"raw_radps", &ifog::rate_t::raw},
      {"compensated_radps", &ifog::rate_t::compensated},
      {"denoised_radps", &ifog::rate_t::denoised},
      {"variance_rad2ps2", &ifog::rate_t::variance}};

  std::size_t different = 0;
  const auto differs = [&](const std::string& what, std::size_t i, double is, double expected) {
    if (++different <= 5)
      std::fprintf(stderr, "sample %zu (seq %lld) %s: %.17g in the log, expected %.17g\n", i,
                   static_cast<long long>(messages[i].seq), what.c_str(), is, expected);
  };
  for (const auto& [name, field] : fields) {
    const auto& column = denoised.at(name);
    if (column.size() != messages.size()) {
      std::fprintf(stderr, "%zu messages in the log, %zu rows of %s offline\n", messages.size(),
                   column.size(), name.c_str());
      return 1;
    }
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const double value = (messages[i].*field).at(0);
      if (!same_bits(value, column[i])) differs(name, i, value, column[i]);
    }
  }

  double furthest = 0.0;
  if (argc == 6) {
    const auto capture = read_columns(argv[4]);
    const double resolution = std::strtod(argv[5], nullptr);
    const auto& rate = capture.at("rate_radps");
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const auto row = static_cast<std::size_t>(messages[i].seq - messages[0].seq);
      if (row >= rate.size()) throw std::runtime_error("more samples in the log than in the capture");
      const double apart = std::abs(messages[i].raw.at(0) - rate[row]);
      furthest = std::max(furthest, apart);
      // value / resolution is rounded too.
      if (!(apart <= 0.5 * resolution * (1 + 1e-9) + 1e-15 * std::abs(rate[row])))
        differs("raw against the capture", i, messages[i].raw.at(0), rate[row]);
    }
  }
  std::printf("%zu samples, %zu differences", messages.size(), different);
  if (argc == 6) std::printf(", at most %.3g rad/s from the capture", furthest);
  std::printf("\n");
  return different == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 && argc != 6) {
    std::fprintf(stderr, "usage: log_equals LOG CHANNEL DENOISED.csv [CAPTURE.csv RESOLUTION_RADPS]\n");
    return 2;
  }
  try {
    return compare(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "log_equals: %s\n", error.what());
    return 1;
  }
}
