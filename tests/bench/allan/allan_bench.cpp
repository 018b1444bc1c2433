// SPDX-License-Identifier: Apache-2.0
// Overlapping Allan deviation of a file of doubles (rad/s, native byte order) at the averaging times of a
// second file (integers as text). Prints the processor time of the analysis (user, and total), the bytes of
// the samples and the peak memory, then one deviation per line.
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "filters/allan/deviation.h"

namespace {

// Of this program only: the value of getrusage includes that of the program that called exec.
long peak_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stol(line.substr(6));
  }
  return 0;
}

// Independent of other work on the machine.
struct ProcessorTime {
  double user = 0.0, all = 0.0;  // s
};

ProcessorTime processor_time() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {seconds(used.ru_utime), seconds(used.ru_utime) + seconds(used.ru_stime)};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("expected: SAMPLES TIMES\n", stderr);
    return 2;
  }
  const std::size_t count = std::filesystem::file_size(argv[1]) / sizeof(double);
  std::vector<double> rate(count);
  std::ifstream samples(argv[1], std::ios::binary);
  samples.read(reinterpret_cast<char*>(rate.data()),
               static_cast<std::streamsize>(rate.size() * sizeof(double)));
  std::vector<std::size_t> m;
  std::ifstream times(argv[2]);
  for (std::size_t value = 0; times >> value;) m.push_back(value);
  if (!samples || m.empty()) {
    std::fputs("cannot read samples or times\n", stderr);
    return 1;
  }

  const ProcessorTime start = processor_time();
  const std::vector<ifog::Stretch> all{{0, rate.size()}};
  const ifog::AngleSum sum(rate, all);
  const auto points = ifog::deviation(sum, m);
  const ProcessorTime end = processor_time();
  std::printf("%.6f %.6f %zu %ld\n", end.user - start.user, end.all - start.all, count * sizeof(double),
              peak_kib() * 1024);
  for (const auto& point : points) std::printf("%.17g\n", std::sqrt(point.variance));
}
