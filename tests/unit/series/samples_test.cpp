// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "filters/series/samples.h"
#include "tests/unit/test.h"

namespace {

using ifog::Samples;

constexpr std::size_t kFew = Samples::kInMemory / sizeof(double);

// Bytes of mapped files in memory.
std::size_t mapped_in() {
  std::size_t all = 0, resident = 0, shared = 0;
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  EXPECT_EQ(std::fscanf(file, "%zu %zu %zu", &all, &resident, &shared), 3);
  std::fclose(file);
  return shared * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

// Files without a name that this program has open.
std::size_t unnamed_files() {
  std::size_t count = 0;
  for (const auto& each : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code closed;
    if (std::filesystem::read_symlink(each, closed).string().ends_with("(deleted)")) ++count;
  }
  return count;
}

TEST(Samples, AreAVectorWhereverTheyAre) {
  for (const std::size_t n : {std::size_t{3}, kFew, kFew + 1, 9 * kFew + 12345}) {
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
    EXPECT_EQ(Samples(n, 0.5), Samples(std::vector<double>(n, 0.5)));
  }
}

TEST(Samples, AreWhatWasAddedInPiecesOfAnyLength) {
  for (const std::size_t piece : {777UL, 70000UL, 3 * kFew}) {
    for (const bool announced : {false, true}) {
      Samples samples;
      if (announced) samples.reserve(4 * kFew);
      std::vector<double> some(piece), all;
      while (all.size() < 4 * kFew) {
        std::iota(some.begin(), some.end(), static_cast<double>(all.size()));
        all.insert(all.end(), some.begin(), some.end());
        samples.append(some);
        samples[all.size() - 1] = all.back() = -1.0;  // is not lost when more are added
      }
      EXPECT_TRUE(std::ranges::equal(samples, all)) << piece;
    }
  }
}

TEST(Samples, KeepAPart) {
  for (const std::size_t n : {100UL, 3 * kFew}) {
    std::vector<double> values(n);
    std::iota(values.begin(), values.end(), 0.0);
    Samples samples(values);
    samples.keep(7, n - 2);
    samples.push_back(0.5);
    values.erase(values.begin(), values.begin() + 7);
    values.back() = 0.5, values.erase(values.end() - 2);
    EXPECT_TRUE(std::ranges::equal(samples, values));
    samples.resize(3);
    samples.resize(5, 2.0);
    EXPECT_EQ(samples, (Samples(std::vector<double>{7.0, 8.0, 9.0, 2.0, 2.0})));
  }
}

// Values that do not divide a page.
TEST(Samples, MayBeOfAnyType) {
  struct Three {
    std::uint8_t a, b, c;
  };
  ifog::Column<Three> column;
  constexpr std::size_t kMany = 2 * ifog::Column<Three>::kInMemory;
  for (std::size_t i = 0; i < kMany; ++i)
    column.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8U), 9});
  for (std::size_t i = 0; i < kMany; i += 97) {
    ASSERT_EQ(column[i].a, i & 255U);
    ASSERT_EQ(column[i].b, i >> 8U & 255U);
    ASSERT_EQ(column[i].c, 9);
  }
}

TEST(Samples, LongOnesDoNotFillTheMemory) {
  constexpr std::size_t kMany = std::size_t{96} << 20U;  // 768 MiB
  Samples samples(kMany, 1.0);
  std::size_t most = 0;
  for (std::size_t i = 0; i < kMany; ++i) {
    samples[i] += static_cast<double>(i);
    if (i % (kMany / 64) == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the thread that releases has its turn
      most = std::max(most, mapped_in());
    }
  }
  EXPECT_LT(most, ifog::kMostResident + (std::size_t{64} << 20U));
  // What was released is there again.
  for (std::size_t i = 0; i < kMany; i += 4099) ASSERT_EQ(samples[i], 1.0 + static_cast<double>(i));
}

TEST(Samples, UseTheFileThatOthersAsLongReleased) {
  constexpr std::size_t kLong = 5 * kFew;
  { const Samples first(kLong, 1.0); }
  const std::size_t files = unnamed_files();
  const Samples second(kLong - 100, 2.0);
  EXPECT_EQ(unnamed_files(), files);
  EXPECT_EQ(std::accumulate(second.begin(), second.end(), 0.0), 2.0 * static_cast<double>(kLong - 100));
}

TEST(Samples, KeepNoMoreFilesThanAFew) {
  {
    std::vector<Samples> many;
    for (std::size_t i = 0; i < 2 * ifog::kMostSpare; ++i) many.emplace_back(2 * kFew, 1.0);
    EXPECT_GE(unnamed_files(), 2 * ifog::kMostSpare);
  }
  EXPECT_EQ(unnamed_files(), ifog::kMostSpare);
}

// In a process of its own, without released files.
TEST(Samples, SayInOneLineThatThereIsNoSpace) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{1U << 20U, 1U << 20U};
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_IGN);
    const std::string line = ifog::test::refusal([] { Samples(13 * kFew, 0.0); });
    _exit(line.find("cannot write") != std::string::npos && line.find("TMPDIR") != std::string::npos ? 0 : 2);
  }
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(Samples, SayThatThereIsNoFolderForTheFile) {
  const char* const before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  setenv("TMPDIR", "/nonexistent", 1);
  const std::string said = ifog::test::refusal([] { Samples(100 * kFew, 0.0); });
  kept.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", kept.c_str(), 1);
  EXPECT_EQ(
      said,
      "/nonexistent: cannot make a file for what is longer than memory is for: No such file or directory; "
      "expected room there, or TMPDIR with the name of another folder");
}

}  // namespace
