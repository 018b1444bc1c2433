// SPDX-License-Identifier: Apache-2.0
#include "filters/series/samples.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <numeric>
#include <thread>

#include "filters/series/long_series.h"

namespace {

using ifog::LongSeries;
using ifog::Samples;

constexpr std::size_t kFew = ifog::FiledAllocator<double>::kInMemory / sizeof(double);

// Bytes of mapped files in memory.
std::size_t mapped_in() {
  std::size_t all = 0, resident = 0, shared = 0;
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  EXPECT_EQ(std::fscanf(file, "%zu %zu %zu", &all, &resident, &shared), 3);
  std::fclose(file);
  return shared * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

TEST(Samples, AreAVectorWhereverTheyAre) {
  for (const std::size_t n : {std::size_t{3}, kFew, kFew + 1, 2 * kFew + 12345}) {
    Samples samples;
    for (std::size_t i = 0; i < n; ++i) samples.push_back(static_cast<double>(i));
    EXPECT_EQ(samples.size(), n);
    const Samples copy = samples;
    EXPECT_EQ(copy, samples);
    samples[n / 2] = -1.0;
    EXPECT_FALSE(copy == samples);
    const Samples moved = std::move(samples);
    EXPECT_EQ(moved[n / 2], -1.0);
    EXPECT_EQ(std::accumulate(copy.begin(), copy.end(), 0.0),
              0.5 * static_cast<double>(n) * static_cast<double>(n - 1));
  }
}

TEST(Samples, LongOnesDoNotFillTheMemory) {
  constexpr std::size_t kMany = std::size_t{96} << 20U;  // 768 MiB
  Samples samples(kMany, 1.0);
  std::size_t most = 0;
  for (std::size_t i = 0; i < kMany; ++i) {
    samples[i] += static_cast<double>(i);
    if (i % (kMany / 64) == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the thread that gives back has its turn
      most = std::max(most, mapped_in());
    }
  }
  EXPECT_LT(most, ifog::kMostResident + (std::size_t{64} << 20U));
  // What was given back is there again.
  for (std::size_t i = 0; i < kMany; i += 4099) ASSERT_EQ(samples[i], 1.0 + static_cast<double>(i));
}

TEST(Samples, NoRoomIsSaidInOneLine) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{1U << 20U, 1U << 20U};
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_IGN);
    try {
      const Samples samples(2 * kFew, 0.0);
      _exit(1);
    } catch (const std::runtime_error& error) {
      const std::string line = error.what();
      _exit(line.find("cannot write") != std::string::npos && line.find("TMPDIR") != std::string::npos ? 0
                                                                                                       : 2);
    }
  }
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(LongSeries, IsAllThereAsMemoryToo) {
  for (const std::size_t in_memory : {100UL, 1000000UL}) {
    LongSeries series(in_memory);
    std::vector<double> all;
    for (int part = 0; part < 3; ++part) {
      for (int i = 0; i < 70001; ++i) {
        all.push_back(static_cast<double>(all.size()) * 0.1);
        series.add(all.back());
      }
      LongSeries other = std::move(series);
      const std::span<const double> seen = other.all();
      EXPECT_TRUE(std::equal(seen.begin(), seen.end(), all.begin(), all.end()));
      series = std::move(other);
      EXPECT_EQ(series.all().data(), seen.data());
    }
  }
}

}  // namespace
