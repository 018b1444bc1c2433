// SPDX-License-Identifier: Apache-2.0
#include "filters/series/long_series.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "filters/series/series_view.h"
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

}  // namespace
