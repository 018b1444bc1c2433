// SPDX-License-Identifier: Apache-2.0
// The daemon as it runs, its flight recorder on: what the command line makes of the recording is what the
// daemon published and what the device sent.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "tests/unit/daemon/recorder/recorded_flight.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

// Of a sensor that has run before: what it knew of its noise is in the recording, too, though the state
// folder has gone on since.
TEST_F(RecordedFlight, DenoiseBeginsWithTheNoiseTheDaemonBeganWith) {
  KeptNoise kept;
  kept.sensor = "nose";
  kept.driver = "kvh1750";
  kept.axes = 3;
  kept.sample_rate_hz = 1000.0;
  kept.learned = "2026-01-31T13:05:09Z";
  kept.noise.process_noise = 3e-11;
  kept.noise.measurement_noise = 2e-8;
  kept.noise.noise = {2e-8, 2.2e-8, 1.8e-8};
  kept.noise.samples = 1e6;
  fs::create_directories(path("state"));
  write("state/nose.noise.toml", kept_noise_text(kept));
  filter_lines_ = "";
  configure();
  start();
  ASSERT_TRUE(send_and_await(1500)) << said();
  ASSERT_EQ(end(SIGTERM), 0) << said();
  fs::remove_all(path("state"));
  fs::remove(path("ifogd.toml"));
  ASSERT_EQ(ifog("denoise " + path("record/nose") + " --output " + path("denoised.csv")), 0) << complaint_;
  expect_as_published("denoised.csv");
  // The noise did come from there: without it that of the first seconds is not known.
  EXPECT_EQ(published()[1000].flags & static_cast<std::int32_t>(rate_t::FLAG_NOISE_UNKNOWN), 0);
  EXPECT_GT(published()[1000].variance[0], 0.0);
}

// Through a reload that changes nothing, one that changes the model, one that changes the filter, and a
// restart: each sample comes out as it was published.
TEST_F(RecordedFlight, DenoiseGivesWhatWasPublishedThroughReloadsAndRestarts) {
  configure();
  start();
  const auto reload = [&](const std::string& expected) {
    kill(child_, SIGHUP);
    for (int n = 0; n < 600 && said().find(expected) == std::string::npos; ++n) listen(20);
    EXPECT_TRUE(test::has(said(), expected));
    // New parts are in use from the next delivery on: the next one at the latest.
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  };
  for (int n = 0; n < 12; ++n) {
    if (n % 4 == 2) write("supply", std::to_string(11'600 + 500 * n) + "\n");
    ASSERT_TRUE(send_and_await(50)) << said();
  }
  ASSERT_NE(published().back().denoised[0], published().back().compensated[0]);  // its noise is known
  reload("nothing changed, the filter continues");
  const std::size_t unchanged = published().size();
  ASSERT_TRUE(send_and_await(200)) << said();
  for (std::size_t n = unchanged; n < published().size(); ++n)
    ASSERT_EQ(published()[n].flags & static_cast<std::int32_t>(rate_t::FLAG_NOISE_UNKNOWN), 0) << n;
  std::string other = content("model.toml");
  other.replace(other.find("1e-3"), 4, "4e-3");
  write("model.toml", other);
  reload("reloaded: model");
  ASSERT_TRUE(send_and_await(600)) << said();
  filter_lines_ = "[sensor.filter]\nprocess_noise = 2e-10\nmeasurement_noise = 1e-8\n";
  configure();
  write("model.toml", other);
  reload("reloaded: model");
  ASSERT_TRUE(send_and_await(300)) << said();
  ASSERT_EQ(end(SIGTERM), 0) << said();
  start();
  ASSERT_TRUE(send_and_await(300)) << said();
  ASSERT_EQ(end(SIGTERM), 0) << said();
  std::set<std::string> models;
  for (const rate_t& message : published()) models.insert(message.model);
  EXPECT_EQ(models.size(), 2U);
  // Neither model nor configuration nor channel is there any more: the recording carries what it needs.
  for (const char* name : {"model.toml", "ifogd.toml", "supply"}) fs::remove(path(name));
  ASSERT_EQ(ifog("denoise " + path("record/nose") + " --output " + path("denoised.csv")), 0) << complaint_;
  EXPECT_TRUE(complaint_.starts_with(path("record/nose") + ": 2 runs of what wrote it, with ")) << complaint_;
  EXPECT_EQ(complaint_.substr(complaint_.find('\n') + 1), stale_in_words("record/nose"));
  expect_as_published("denoised.csv");
  EXPECT_TRUE(std::ranges::any_of(
      published(), [](const rate_t& message) { return message.compensated[1] != message.raw[1]; }));
  // Every command reads it as a capture, the channel from elsewhere among its columns.
  ASSERT_EQ(ifog("convert " + path("record/nose") + " " + path("capture.csv")), 0) << complaint_;
  EXPECT_TRUE(test::has(content("capture.csv").substr(0, 200), "supply_V"));
  EXPECT_EQ(rows_of("capture.csv").size(), published().size());
  EXPECT_EQ(ifog("allan " + path("record/nose") + " --json " + path("allan.json")), 0) << complaint_;
  // And it is sent again as it came, to the bit.
  ASSERT_EQ(ifog("replay " + path("record/nose") + " --speed 0 --to file:" + path("again")), 0) << complaint_;
  EXPECT_EQ(content("again"), sent_);
  // Without its beginning nobody knows how the filter stood: that is said.
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path("record/nose"))) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  ASSERT_EQ(files.size(), 4U);
  fs::remove(files.front());
  ASSERT_EQ(ifog("denoise " + path("record/nose") + " --output " + path("denoised.csv")), 0) << complaint_;
  EXPECT_TRUE(test::has(complaint_,
                        "from 0 s on, until the filter has settled, this need not be what was published"));
}

// All settings of the configuration: where the drivers are, too.
TEST_F(RecordedFlight, DenoiseLooksForDriversWhereTheConfigurationSays) {
  configure();
  start();
  ASSERT_TRUE(send_and_await(100)) << said();
  ASSERT_EQ(end(SIGTERM), 0) << said();
  write("raw.bin", sent_);
  // A program that is not in the build tree finds no drivers near itself.
  fs::create_directories(path("bin"));
  fs::copy(IFOG_BINARY_DIR "/tools/ifog/ifog", path("bin/ifog"));
  fs::path plugin;
  for (const auto& entry : fs::recursive_directory_iterator(IFOG_BINARY_DIR "/plugins"))
    if (entry.path().filename().string().find("kvh1750") != std::string::npos) plugin = entry.path();
  fs::create_directories(path("plugins"));
  fs::copy(plugin, path("plugins") / plugin.filename());
  std::string configuration = content("ifogd.toml");
  configuration.replace(0, 8, "[daemon]\nplugin_folder = \"plugins\"");
  write("ifogd.toml", configuration);
  for (const std::string recording : {"record/nose", "raw.bin"}) {
    const int status =
        std::system((path("bin/ifog") + " denoise " + path(recording) + " --config " + path("ifogd.toml") +
                     " --output " + path("out.csv") + " >/dev/null 2>" + path("complaint"))
                        .c_str());
    EXPECT_EQ(status, 0) << recording << ": " << content("complaint");
  }
}

TEST_F(RecordedFlight, AfterAKillAllButTheLastSecondIsThereAndTheNextRunGoesOn) {
  model_line_ = "";
  configure();
  start();
  ASSERT_TRUE(send_and_await(500)) << said();
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  ASSERT_EQ(end(SIGKILL), 1000 + SIGKILL);
  ASSERT_EQ(ifog("replay " + path("record/nose") + " --speed 0 --to file:" + path("again")), 0) << complaint_;
  EXPECT_EQ(content("again"), sent_);
  EXPECT_TRUE(test::has(complaint_, "without an end"));
  published().clear();
  start();
  ASSERT_TRUE(send_and_await(500)) << said();
  ASSERT_EQ(end(SIGTERM), 0);
  for (const auto& entry : fs::directory_iterator(path("record/nose")))
    EXPECT_EQ(entry.path().extension(), ".ifr") << entry.path();
  // Every reader names the run that was killed, and for how long nothing was recorded.
  for (const std::string& command :
       {"denoise " + path("record/nose") + " --output " + path("denoised.csv"),
        "convert " + path("record/nose") + " " + path("capture.csv"), "allan " + path("record/nose")}) {
    EXPECT_EQ(ifog(command), 0) << complaint_;
    EXPECT_TRUE(test::has(complaint_, "1 run(s) of what wrote it were cut off"));
    EXPECT_TRUE(test::has(complaint_, "2 runs of what wrote it, with "));
  }
  EXPECT_NE(rows_of("denoised.csv").size(), 0U);
  ASSERT_EQ(ifog("replay " + path("record/nose") + " --speed 0 --to file:" + path("again")), 0) << complaint_;
  EXPECT_EQ(content("again"), sent_);
}

// Bursts that the ring has no room for: as many rows more than were published are reported, and where.
TEST_F(RecordedFlight, WhatTheRingMergedIsToldByDenoise) {
  realtime_lines_ = "[sensor.realtime]\nring_slots = 2\ndirect = false\n";
  // A source that does not wait until it is read.
  transport_lines_ = "type = \"udp\"\nbind = \"127.0.0.1\"\nport = 45671\n";
  fifos_["udp"] = line_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(45671);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(connect(line_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  configure();
  start();
  for (int n = 0; n < 600 && said().find("reading udp") == std::string::npos; ++n) listen(50);
  for (int n = 0; n < 200; ++n) {
    send(1);
    ASSERT_TRUE(await(samples_)) << said();
  }
  const auto came = [&] {
    std::uint64_t out = 0;
    for (const rate_t& message : published())
      out += static_cast<std::uint64_t>(std::max<std::int32_t>(message.merged, 1));
    return out;
  };
  for (int burst = 0; burst < 100 && published().size() == came(); ++burst) {
    send(50);
    for (int n = 0; n < 600 && came() < samples_; ++n) listen(50);
    ASSERT_EQ(came(), samples_) << said();
  }
  const std::size_t merged = static_cast<std::size_t>(samples_) - published().size();
  ASSERT_GT(merged, 0U);
  ASSERT_EQ(end(SIGTERM), 0) << said();
  ASSERT_EQ(ifog("denoise " + path("record/nose") + " --output " + path("denoised.csv") + " --json " +
                 path("denoised.json")),
            0)
      << complaint_;
  EXPECT_EQ(rows_of("denoised.csv").size(), published().size() + merged);
  EXPECT_TRUE(test::has(complaint_, ": " + std::to_string(merged) + " samples, the first about 0."));
  EXPECT_TRUE(test::has(complaint_, "were published as one with others (the ring was full)"));
  EXPECT_TRUE(test::has(content("denoised.json"), "\"merged\": " + std::to_string(merged) + ","));
  // Until the first of them, every row is what was published.
  const auto rows = rows_of("denoised.csv");
  for (std::size_t n = 0; n < 200; ++n) ASSERT_EQ(rows[n][3], published()[n].denoised[0]) << n;
}

TEST_F(RecordedFlight, LcmIsRecordedOnAnotherComputerWithItsChannels) {
  rate_hz_ = "100";
  configure();
  const pid_t recorder = fork();
  ASSERT_GE(recorder, 0);
  if (recorder == 0) {
    close(STDOUT_FILENO);
    open("/dev/null", O_WRONLY);
    execl(IFOG_BINARY_DIR "/tools/ifog/ifog", "ifog", "record", "--output", path("heard").c_str(), "--sensor",
          "nose", nullptr);
    _exit(127);
  }
  // It listens soon after its folder is there, which it keeps for itself first; a message that came before is
  // none of it.
  start();
  for (int n = 0; n < 600 && !fs::exists(path("heard")); ++n) listen(10);
  for (int n = 0; n < 100; ++n) listen(10);
  const std::size_t before = published().size();
  // At the sensor's own rate, so that the fitted time advances.
  auto due = std::chrono::steady_clock::now();
  for (int n = 0; n < 300; ++n) {
    std::this_thread::sleep_until(due += std::chrono::milliseconds(10));
    send(1);
    ASSERT_TRUE(await(before + static_cast<std::size_t>(samples_))) << said();
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(2200));  // two status messages
  ASSERT_EQ(end(SIGTERM), 0);
  kill(recorder, SIGTERM);
  int status = 0;
  waitpid(recorder, &status, 0);
  EXPECT_EQ(status, 0);
  ASSERT_EQ(ifog("convert " + path("heard") + " " + path("capture.csv")), 0) << complaint_;
  const std::string capture = content("capture.csv");
  EXPECT_TRUE(test::has(capture.substr(0, 200), "supply_V"));
  const auto rows = rows_of("capture.csv");
  ASSERT_EQ(rows.size(), published().size());
  for (std::size_t n = 0; n < rows.size(); ++n) ASSERT_EQ(rows[n][1], published()[n].raw[0]) << n;
  EXPECT_EQ(ifog("allan " + path("heard") + " --json " + path("allan.json")), 0) << complaint_;
}

}  // namespace
}  // namespace ifog
