// SPDX-License-Identifier: Apache-2.0
// `ifog replay` as a user runs it, and the two small parts it is made of. How late it is, is measured beside
// canplayer in tests/bench/replay; here nothing may come early or be lost.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "daemon/sensor/duration_histogram.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/file/pace.h"
#include "tests/unit/test.h"

namespace {

namespace fs = std::filesystem;

TEST(DurationHistogram, PercentilesAreWithinABucketOfTheSortedValues) {
  ifog::DurationHistogram late;
  std::vector<std::int64_t> values;
  std::uint64_t x = 1;
  for (int i = 0; i < 20'000; ++i) {
    x = x * 6364136223846793005ULL + 1442695040888963407ULL;
    values.push_back(static_cast<std::int64_t>(x >> (24U + x % 36U)));
    late.add(values.back());
  }
  std::sort(values.begin(), values.end());
  for (const double share : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const auto exact = static_cast<double>(values[static_cast<std::size_t>(share * 20'000)]);
    EXPECT_GE(1e3 * late.percentile_us(share), exact * (1.0 - 1e-12));
    EXPECT_LE(1e3 * late.percentile_us(share), exact * (1.0 + 1.0 / 32.0) + 1.0);
  }
  EXPECT_DOUBLE_EQ(late.max_us(), static_cast<double>(values.back()) * 1e-3);
  EXPECT_EQ(late.count(), 20'000U);
  EXPECT_EQ(late.percentile_us(1.0), late.max_us());
  late.clear();
  EXPECT_EQ(late.percentile_us(0.5), 0.0);
  late.add(-5);
  late.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(late.count(), 2U);
}

TEST(Pace, DeadlinesComeFromTheFirstAndKeepNanosecondsForDays) {
  ifog::Pace pace;
  pace.start(1'700'000'000'000'000'000, 5);
  constexpr std::int64_t kTenDays_ns = 864'000'000'000'001;
  EXPECT_EQ(pace.due_ns(1'700'000'000'000'000'000 + kTenDays_ns), 5 + kTenDays_ns);
  EXPECT_EQ(pace.due_ns(1'699'999'999'999'999'999), 4);
  ifog::Pace slow(0.5);
  slow.start(100, 1000);
  EXPECT_EQ(slow.due_ns(200), 1200);
}

class Replay : public testing::Test, protected ifog::test::OwnFolder {
 protected:
  // Exit status; what it prints goes to the file `out`.
  int ifog(const std::string& arguments) const {
    const std::string command = IFOG_PROGRAM " replay " + arguments + " >" + path("out") + " 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  }
  // The same under way, with what it prints in the same place.
  pid_t started(std::vector<std::string> words) const {
    words.insert(words.begin(), {"ifog", "replay"});
    std::ofstream(path("out")).close();
    const pid_t child = fork();
    if (child != 0) return child;
    const int out = open(path("out").c_str(), O_WRONLY | O_APPEND);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execv(IFOG_PROGRAM, argv.data());
    _exit(127);
  }
  // Exit status of a replay that is interrupted in the middle, into again.log with a report.json.
  int interrupted_in(const std::vector<std::string>& options) const {
    std::vector<std::string> words{log(), "--to", "file:" + path("again.log"), "--json", path("report.json")};
    words.insert(words.end(), options.begin(), options.end());
    const pid_t child = started(words);
    // Until it is whole the file has no name: it is seen among what the process has open, in the folder that
    // it will be in. Elsewhere there are others, as the copy of a plugin.
    const auto written = [&] {
      std::uintmax_t most = 0;
      for (const auto& one : fs::directory_iterator("/proc/" + std::to_string(child) + "/fd")) {
        struct stat file {};
        std::error_code gone;
        if (!fs::read_symlink(one.path(), gone).string().starts_with(folder())) continue;
        if (stat(one.path().c_str(), &file) == 0 && S_ISREG(file.st_mode) && file.st_nlink == 0)
          most = std::max(most, static_cast<std::uintmax_t>(file.st_size));
      }
      return most;
    };
    int status = 0;
    while (written() < 1000) {
      if (waitpid(child, &status, WNOHANG) != 0) return -1;  // it ended by itself
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    kill(child, SIGINT);
    return waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  // 100 frames, 1 ms apart.
  std::string log() const {
    std::ofstream out(path("gyro.log"));
    for (int i = 0; i < 100; ++i)
      out << "(1700000000." << (100'000 + i * 1000) << ") can3 12345678#" << std::to_string(1000 + i) << "\n";
    return path("gyro.log");
  }
};

TEST_F(Replay, WritesTheSameLogNeverEarly) {
  const std::int64_t before = ifog::monotonic_ns();
  ASSERT_EQ(ifog(log() + " --to file:" + path("again.log") + " --json " + path("report.json")), 0)
      << content("out");
  EXPECT_GE(ifog::monotonic_ns() - before, 99'000'000);
  EXPECT_EQ(content("again.log"), content("gyro.log"));
  const auto report = nlohmann::json::parse(content("report.json"));
  EXPECT_EQ(report["schema"], "ifog.replay/1");
  EXPECT_EQ(report["sent"], 100);
  EXPECT_EQ(report["unit"], "frame");
  EXPECT_GE(report["seconds"], 0.099);
  EXPECT_LE(report["lateness_us"]["p50"], report["lateness_us"]["p99"]);
  EXPECT_LE(report["lateness_us"]["p99"], report["lateness_us"]["max"]);
}

TEST_F(Replay, EachFrameGoesToALogWithItsInterfaceAndTwoDevicesNotOntoOneBus) {
  std::ofstream(path("two.log"))
      << "(1.000000) vcan0 123#11\n(1.000000) vcan1 123#22\n(1.001000) vcan0 123#33\n";
  ASSERT_EQ(ifog(path("two.log") + " --speed 0 --to file:" + path("again.log")), 0) << content("out");
  EXPECT_EQ(content("again.log"),
            "(0000000001.000000) vcan0 123#11\n(0000000001.000000) vcan1 123#22\n(0000000001.001000) vcan0 "
            "123#33\n");
  ASSERT_EQ(ifog(path("two.log") + " --channel vcan1 --speed 0 --to file:" + path("again.log")), 0);
  EXPECT_EQ(content("again.log"), "(0000000001.000000) vcan1 123#22\n");
  EXPECT_EQ(ifog(path("two.log") + " --to can:vcan0"), 1);
  EXPECT_EQ(content("out"),
            "ifog: " + path("two.log") +
                ": frames of one id come on 'vcan0' and on 'vcan1', as from two devices, expected "
                "--channel with one of them\n");
}

TEST_F(Replay, LoopsAndScales) {
  ASSERT_EQ(ifog(log() + " --to file:" + path("again.log") + " --loop 3 --speed 20"), 0) << content("out");
  EXPECT_EQ(content("again.log"), content("gyro.log") + content("gyro.log") + content("gyro.log"));
  ASSERT_EQ(ifog(log() + " --to file:" + path("again.log") + " --loop 3 --speed 0"), 0) << content("out");
  EXPECT_EQ(content("again.log"), content("gyro.log") + content("gyro.log") + content("gyro.log"));
}

TEST_F(Replay, SendsRawBytesInBlocks) {
  std::string bytes;
  for (int i = 0; i < 1001; ++i) bytes += static_cast<char>(i * 7);
  std::ofstream(path("gyro.bin"), std::ios::binary) << bytes;
  ASSERT_EQ(ifog(path("gyro.bin") + " --block 100 --rate 1000 --to file:" + path("again.bin")), 0)
      << content("out");
  EXPECT_EQ(content("again.bin"), bytes);
  EXPECT_TRUE(ifog::test::has(content("out"), "sent 11 blocks"));
  EXPECT_EQ(ifog(path("gyro.bin") + " --to file:" + path("x")), 1);
  EXPECT_EQ(content("out"),
            "ifog: " + path("gyro.bin") +
                ": raw bytes carry no times, expected --block BYTES and --rate HZ, or --driver NAME\n");
}

// Rows become KVH frames of 40 bytes, which the driver cuts again where each ends.
TEST_F(Replay, EncodesACaptureAndCutsBytesByTheDriver) {
  std::ofstream out(path("gyro.csv"));
  out << "time_s,rate_x_radps,rate_y_radps,rate_z_radps\n";
  for (int i = 0; i < 50; ++i) out << i * 0.001 << "," << i * 1e-3 << ",0,0\n";
  out.close();
  ASSERT_EQ(ifog(path("gyro.csv") + " --driver kvh1750 --option format=b --to file:" + path("gyro.kvh")), 0)
      << content("out");
  EXPECT_EQ(content("gyro.kvh").size(), 50U * 40U);
  EXPECT_EQ(content("gyro.kvh").substr(0, 4), "\xFE\x81\xFF\x56");
  ASSERT_EQ(ifog(path("gyro.kvh") + " --driver kvh1750 --option format=b --to file:" + path("again.kvh")), 0)
      << content("out");
  EXPECT_EQ(content("again.kvh"), content("gyro.kvh"));
  EXPECT_TRUE(ifog::test::has(content("out"), "sent 50 blocks"));
  EXPECT_EQ(ifog(path("gyro.csv") + " --to file:" + path("x")), 1);
}

// One without end comes to its end by the interrupt; of another that is less than what was asked for, which is a failure
// that says how much was sent.
TEST_F(Replay, AnInterruptEndsItWithTheReport) {
  for (const bool endless : {true, false}) {
    EXPECT_EQ(interrupted_in({"--loop", endless ? "0" : "20000"}), endless ? 0 : 1);
    const auto report = nlohmann::json::parse(content("report.json"));
    EXPECT_EQ(report["interrupted"], true);
    EXPECT_EQ(report["failed"], false);
    EXPECT_EQ(report["of"], endless ? nlohmann::json() : nlohmann::json(2'000'000));
    const std::string sent = content("again.log");
    EXPECT_EQ(report["sent"], std::count(sent.begin(), sent.end(), '\n'));
    const std::string said =
        "interrupted: sent " + std::to_string(report["sent"].get<int>()) + " of 2000000 frames in ";
    EXPECT_EQ(content("out").starts_with(said), !endless) << content("out");
  }
}

TEST_F(Replay, AnInterruptedWaitForAReaderIsSaid) {
  const std::string capture = log();
  const pid_t child = started({capture, "--to", "fifo:" + path("fifo")});
  while (content("out").find("waiting for a reader") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    kill(child, SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  // A second signal, where the first came before the wait, ends it by itself.
  if (WIFSIGNALED(status)) return;
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_TRUE(ifog::test::has(content("out"), "interrupted before anything was sent"));
}

// What was collected to be written together and then not taken has not been sent.
TEST_F(Replay, WhatTheTargetDidNotTakeIsNotSaidToBeSent) {
  EXPECT_EQ(ifog(log() + " --speed 0 --loop 5 --to file:/dev/full --json " + path("report.json")), 1);
  EXPECT_TRUE(ifog::test::has(content("out"), "failed: sent 0 of 500 frames in "));
  const auto report = nlohmann::json::parse(content("report.json"));
  EXPECT_EQ(report["sent"], 0);
  EXPECT_EQ(report["of"], 500);
  EXPECT_EQ(report["failed"], true);
}

TEST_F(Replay, AReaderThatGoesAwayIsAFailureWithAReport) {
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  std::thread reader([&] {
    std::ifstream in(path("fifo"));
    std::string line;
    std::getline(in, line);
  });
  EXPECT_EQ(ifog(log() + " --loop 0 --to fifo:" + path("fifo")), 1);
  reader.join();
  EXPECT_TRUE(ifog::test::has(content("out"), "fifo: the reader went away"));
  EXPECT_TRUE(ifog::test::has(content("out"), "failed: sent "));
  EXPECT_TRUE(ifog::test::has(content("out"), "lateness p50"));
}

TEST_F(Replay, WrongUseIsTwoWhatCannotBeSentIsOne) {
  EXPECT_EQ(ifog(log() + " --to nowhere"), 2);
  EXPECT_EQ(ifog(log()), 2);
  EXPECT_EQ(ifog(log() + " --to file:" + path("x") + " --speed -1"), 2);
  EXPECT_EQ(ifog(log() + " --to serial:/dev/null"), 1);
  EXPECT_EQ(content("out"), "ifog: /dev/null: CAN frames cannot go onto a serial line, expected bytes\n");
  std::ofstream(path("empty.log")).close();
  EXPECT_EQ(ifog(path("empty.log") + " --to file:" + path("x")), 1);
  EXPECT_EQ(content("out"), "ifog: " + path("empty.log") + ": nothing in it to send\n");
}

}  // namespace
