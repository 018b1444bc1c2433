// SPDX-License-Identifier: Apache-2.0
// A process that records and is killed at any moment: what it had written is there, to the bit, and the files
// are whole.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/unit/flight/recordings.h"
#include "tests/unit/own_folder.h"

namespace ifog {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kStep_ns = 1'000'000;

// Goes on from entry `n` until it is killed; after each round it tells how many are written.
[[noreturn]] void record(const std::string& folder, std::uint64_t n, int told) {
  ArchiveLimits limits;
  limits.file_bytes = 30'000;
  FlightArchive archive(make_flight_folder(folder), limits, some_header());
  for (std::int64_t now_ns = 0;; now_ns += kStep_ns) {
    for (int i = 0; i < 20; ++i) archive.add({FlightKind::bytes, 0, 0, 0, now_ns}, numbered(n++, 300));
    archive.turn(now_ns, 1'700'000'000'000'000'000 + now_ns, true);
    if (archive.error() != 0 || write(told, &n, sizeof n) != sizeof n) _exit(1);
  }
}

std::vector<std::uint8_t> all_in(const std::string& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<std::uint8_t> out;
  for (const fs::path& path : paths) {
    std::ifstream in(path, std::ios::binary);
    out.insert(out.end(), std::istreambuf_iterator<char>(in), {});
  }
  return out;
}

TEST(FlightKilled, WhatWasWrittenIsThereToTheBit) {
  const test::OwnFolder own;
  const std::string folder = own.path("record");
  std::mt19937 random(40);
  std::uint64_t from = 0;  // what the folder holds
  for (int kills = 0; kills < 40; ++kills) {
    int pipe_ends[2];
    ASSERT_EQ(pipe(pipe_ends), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      close(pipe_ends[0]);
      record(folder, from, pipe_ends[1]);
    }
    close(pipe_ends[1]);
    // Killed after so many rounds and some microseconds: in the middle of whatever it does then.
    const int rounds = static_cast<int>(random() % 60);
    std::uint64_t told = from, n = 0;
    for (int i = 0; i < rounds && read(pipe_ends[0], &n, sizeof n) == sizeof n; ++i) told = n;
    usleep(static_cast<unsigned>(random() % 3000));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    while (read(pipe_ends[0], &n, sizeof n) == sizeof n) told = n;
    close(pipe_ends[0]);
    if (told == from && !fs::exists(folder)) continue;

    int open = 0;
    for (const auto& entry : fs::directory_iterator(folder))
      open += entry.path().extension() == ".open" ? 1 : 0;
    ASSERT_LE(open, 1);  // what the one before left is closed
    const std::vector<std::uint8_t> recording = all_in(folder);
    if (recording.empty()) continue;
    const ReadBack read = read_back(recording);
    ASSERT_GE(read.payloads.size(), told) << "kill " << kills;
    for (std::uint64_t i = 0; i < read.payloads.size(); ++i)
      ASSERT_EQ(read.payloads[i], numbered(i, 300)) << i;
    ASSERT_EQ(read.counts.damaged_bytes, 0U);
    ASSERT_EQ(read.counts.missing_entries, 0U);
    from = read.payloads.size();
  }
  EXPECT_GT(from, 1000U);
}

}  // namespace
}  // namespace ifog
