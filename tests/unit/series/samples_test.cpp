// SPDX-License-Identifier: Apache-2.0
#include "filters/series/long_series.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <random>
#include <span>
#include <thread>
#include <vector>

#include "filters/series/samples.h"
#include "filters/series/series_view.h"
#include "filters/series/shared_samples.h"
#include "tests/unit/refusal.h"

namespace {

using ifog::LongSeries;
using ifog::SeriesView;

TEST(LongSeries, IsWhatWasAddedWhereverItIs) {
  for (const std::size_t in_memory : {0UL, 1UL, 1000UL, 70000UL, 1000000UL})
    for (const std::size_t piece : {1UL, 777UL, 70000UL}) {
      LongSeries series(in_memory);
      std::vector<double> all;
      while (all.size() < 200000) {
        std::vector<double> some(std::min(piece, 200000 - all.size()));
        for (std::size_t i = 0; i < some.size(); ++i) some[i] = std::sin(static_cast<double>(all.size() + i));
        all.insert(all.end(), some.begin(), some.end());
        if (piece == 1)
          series.add(some[0]);
        else
          series.add(some);
      }
      ASSERT_EQ(series.size(), all.size());
      EXPECT_EQ(series.filed() > 0, in_memory < all.size());
      const SeriesView view(series);
      EXPECT_EQ(view.in_memory().empty(), in_memory < all.size());
      std::vector<double> room;
      for (const auto& [first, count] : {std::pair<std::size_t, std::size_t>{0, 200000},
                                         {199999, 1},
                                         {65530, 12},
                                         {131072, 65536},
                                         {5, 0}}) {
        const auto got = view.piece(first, count, room);
        ASSERT_EQ(got.size(), count);
        EXPECT_TRUE(std::equal(got.begin(), got.end(), all.begin() + static_cast<std::ptrdiff_t>(first)));
        std::vector<double> read(count);
        view.read(first, read);
        EXPECT_TRUE(std::equal(read.begin(), read.end(), all.begin() + static_cast<std::ptrdiff_t>(first)));
      }
      const SeriesView part = view.part(1000, 150000);
      EXPECT_EQ(part.size(), 149000U);
      EXPECT_EQ(part.at(0), all[1000]);
      EXPECT_EQ(part.part(10, 20).at(9), all[1019]);
      std::vector<double> through;
      ifog::for_each_piece(part, 3, part.size(), [&](std::span<const double> values, std::size_t first) {
        EXPECT_EQ(values[0], all[1000 + first]);
        through.insert(through.end(), values.begin(), values.end());
      });
      EXPECT_TRUE(std::equal(through.begin(), through.end(), all.begin() + 1003));
      EXPECT_EQ(through.size(), 148997U);
    }
}

// Against the library's selection of all steps at once.
TEST(LongSeries, TheMedianStepIsTheMiddleOfAll) {
  std::mt19937 random(3);
  for (const std::size_t n : {2UL, 3UL, 10UL, 30001UL}) {
    std::vector<double> time{-5.0};
    std::exponential_distribution<double> step(1e3);
    while (time.size() < n) time.push_back(time.back() + step(random));
    LongSeries series(7);
    series.add(time);
    std::vector<double> steps;
    for (std::size_t i = 1; i < n; ++i) steps.push_back(time[i] - time[i - 1]);
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                     steps.end());
    EXPECT_EQ(ifog::median_step(series), steps[steps.size() / 2]) << n;
    EXPECT_EQ(ifog::median_step(time), steps[steps.size() / 2]) << n;
  }
}

TEST(LongSeries, SaysWhereThereIsNoRoomForTheFile) {
  const char* const before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  setenv("TMPDIR", "/nonexistent", 1);
  LongSeries series(1);
  const std::string said = ifog::test::refusal([&] { series.add(std::vector<double>(10)); });
  kept.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", kept.c_str(), 1);
  EXPECT_EQ(
      said,
      "/nonexistent: cannot make a file for what is longer than memory is for: No such file or directory; "
      "expected room there, or TMPDIR with the name of another folder");
}

// 64 million numbers, half a GB, in an address space of a quarter.
TEST(LongSeries, DoesNotGrowInMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer wants address space of its own";
#endif
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit limit{std::size_t{256} << 20U, std::size_t{256} << 20U};
    if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(2);
    try {
      LongSeries series;
      std::vector<double> some(std::size_t{1} << 16U, 1.0);
      for (int i = 0; i < 1000; ++i) series.add(some);
      double sum = 0.0;
      ifog::for_each_piece(series, 0, series.size(), [&](std::span<const double> values, std::size_t) {
        for (const double value : values) sum += value;
      });
      _exit(sum == 65536000.0 ? 0 : 3);
    } catch (...) {
      _exit(4);
    }
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

using ifog::Samples;
using ifog::SharedSamples;

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

// Limit of the program's address space.
std::size_t mapped_at_all() {
  std::size_t all = 0;
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  EXPECT_EQ(std::fscanf(file, "%zu", &all), 1);
  std::fclose(file);
  return all * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

TEST(Samples, TakeTheRoomThatOthersAsLongGaveBack) {
  constexpr std::size_t kLong = 5 * kFew;
  const double* room = nullptr;
  {
    const Samples first(kLong, 1.0);
    room = first.data();
  }
  const Samples second(kLong - 100, 2.0);
  EXPECT_EQ(second.data(), room);
  EXPECT_EQ(std::accumulate(second.begin(), second.end(), 0.0), 2.0 * static_cast<double>(kLong - 100));
  const Samples third(kLong, 3.0);  // there is no other
  EXPECT_NE(third.data(), room);
}

TEST(Samples, KeepNoMoreRoomThanAFew) {
  constexpr std::size_t kLong = 7 * kFew, kBytes = kLong * sizeof(double);
  const std::size_t before = mapped_at_all();
  {
    std::vector<Samples> many;
    for (std::size_t i = 0; i < 2 * ifog::kMostSpare; ++i) many.emplace_back(kLong, 1.0);
    EXPECT_GE(mapped_at_all(), before + 2 * ifog::kMostSpare * kBytes);
  }
  EXPECT_LE(mapped_at_all(), before + (ifog::kMostSpare + 1) * kBytes);
}

// What is given back is there for whoever writes a series of about that length, and for one only.
TEST(LongSeries, WritesIntoAFileThatWasGivenBack) {
  constexpr std::size_t kLong = 2 * kFew, kBytes = kLong * sizeof(double);
  while (ifog::take_spare_file(kBytes)) {
  }
  { const Samples given_back(kLong, 1.0); }
  ifog::LongSeries first(0), second(0);
  first.expect(kLong - 5);
  EXPECT_FALSE(ifog::take_spare_file(kBytes));
  second.expect(kLong - 5);
  std::vector<double> some(100000);
  for (std::size_t i = 0; i < some.size(); ++i) some[i] = static_cast<double>(i);
  for (ifog::LongSeries* series : {&first, &second}) {
    series->add(some);
    series->add(7.0);
    EXPECT_EQ(series->size(), some.size() + 1);
    std::vector<double> read(some.size() + 1);
    series->read(0, read);
    EXPECT_TRUE(std::equal(some.begin(), some.end(), read.begin()));
    EXPECT_EQ(read.back(), 7.0);
    EXPECT_EQ(series->all().back(), 7.0);
  }
}

TEST(SharedSamples, AreOneUntilOneIsChanged) {
  SharedSamples one(std::vector<double>{1.0, 2.0, 3.0}), other = one;
  EXPECT_TRUE(other.is(one));
  other.own()[1] = 5.0;
  EXPECT_FALSE(other.is(one));
  EXPECT_EQ(one.values(), (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_EQ(other.values(), (std::vector<double>{1.0, 5.0, 3.0}));
  const double* const where = other.data();
  other.own()[0] = 4.0;
  EXPECT_EQ(other.data(), where);  // nobody else's any more: no copy
  EXPECT_TRUE(SharedSamples().empty());
}

TEST(SharedSamples, ThoseOfOthersAreCopiedBeforeTheyAreChanged) {
  const std::vector<double> others{1.0, 2.0, 3.0};
  SharedSamples one = SharedSamples::of(others), same = one;
  EXPECT_EQ(one.data(), others.data());
  EXPECT_TRUE(same.is(one));
  same.own()[0] = 5.0;
  EXPECT_FALSE(same.is(one));
  EXPECT_EQ(same.values(), (std::vector<double>{5.0, 2.0, 3.0}));
  EXPECT_EQ(others, (std::vector<double>{1.0, 2.0, 3.0}));
}

// A size that no test before has left in the spare room.
TEST(Samples, NoRoomIsSaidInOneLine) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{1U << 20U, 1U << 20U};
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_IGN);
    try {
      const Samples samples(13 * kFew, 0.0);
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
