// SPDX-License-Identifier: Apache-2.0
// The daemon as a user starts it: what it says and how it ends where something is wrong.
#include <sys/socket.h>
#include <sys/un.h>

#include "tests/unit/daemon/daemon_process.h"
#include "tests/unit/daemon/kvh_frames.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

class Ifogd : public DaemonProcess {
 protected:
  // One sensor that reads flight.kvh, and more.
  void configure(const std::string& more, const std::string& driver = "kvh1750") const {
    write("ifogd.toml",
          "[daemon]\nlock_memory = false\n[[sensor]]\nname = \"nose\"\ndriver = \"" + driver + "\"\n" + more);
  }
};

constexpr const char* kFile = "[sensor.transport]\ntype = \"file\"\npath = \"flight.kvh\"\n";

std::string recording(int count) {
  const std::vector<std::uint8_t> bytes = kvh_frames(0, count, [](int) { return 0.01; });
  return {bytes.begin(), bytes.end()};
}

// By the line of the key that is due to it, not of the sensor; the same with --check.
TEST_F(Ifogd, WhatShowsOnlyInThePartsIsToldByItsKeysLine) {
  write("model.toml",
        "version = 1\nsensor = \"nose\"\n\n[[effect]]\nform = \"linear\"\nchannel = \"supply_V\"\n"
        "  [[effect.parameter]]\n  name = \"coefficient\"\n  value = 1e-6\n");
  write("bad.toml", "version = 7\n");
  write("bus.dbc", "BU_: G\nBO_ 1 Rate: 8 G\n SG_ Rate_z : 0|16@1- (0.01,0) [-300|300] \"deg/s\" G\n");
  const std::string sensor = ": sensor \"nose\": ";
  for (const auto& [more, what] :
       {std::pair{std::string(kFile) + "[sensor.options]\nformat = \"q\"\n",
                  ":10" + sensor + "driver kvh1750: format is 'q', expected "},
        {std::string(kFile) + "[sensor.options]\nformat = \"a\"\nfromat = \"a\"\n",
         ":11" + sensor + "driver kvh1750: unknown option 'fromat'"},
        {"model = \"bad.toml\"\n" + std::string(kFile), ":6" + sensor + path("bad.toml") + ":1: version = 7"},
        {"model = \"model.toml\"\n" + std::string(kFile),
         ":6" + sensor + path("model.toml") + ":4: the model uses channel \"supply_V\", which"},
        {std::string(kFile) + "[sensor.filter]\nstate = \"foo\"\n",
         std::string(":10: sensor.filter.state = 'foo': expected ")},
        {std::string("[sensor.transport]\ntype = \"can\"\ninterface = \"can0\"\n"),
         ":7" + sensor + "driver \"kvh1750\" cannot be fed from a transport of type \"can\""},
        {std::string(kFile) + "[[sensor.channel]]\nname = \"coil_degC\"\nsource = \"can\"\ninterface = "
                              "\"can0\"\ndbc = \"bus.dbc\"\nsignal = \"Coil\"\n",
         ":14" + sensor + path("bus.dbc") + ": no signal \"Coil\""},
        {std::string(kFile) + "[[sensor.channel]]\nname = \"coil_degC\"\nsource = \"lcm\"\nlcm_channel = "
                              "\"HULL\"\nfield = \"raw[3]\"\n",
         std::string(":13: sensor.channel.field = 'raw[3]': expected ")}})
    for (const char* how : {"", "--check"}) {
      configure(more);
      EXPECT_EQ(ifogd(how), 2) << more;
      EXPECT_EQ(times_said(path("ifogd.toml") + what), 1) << what << "\n" << said();
    }
}

// Every sensor here has three axes.
TEST_F(Ifogd, ACheckSaysThatAModelIsOfASensorWithOneAxis) {
  write("model.toml",
        "version = 1\n[[noise]]\naxis = \"q\"\nN = 1e-6\n[[effect]]\nform = \"linear\"\nchannel = "
        "\"temperature_degC\"\n[[effect.parameter]]\nname = \"coefficient\"\nvalue = 1e-6\n");
  configure("model = \"model.toml\"\n" + std::string(kFile));
  EXPECT_EQ(ifogd("--check"), 0) << said();
  EXPECT_EQ(times_said("subtracted from each of x, y, z"), 1) << said();
  EXPECT_EQ(times_said("the noise of an axis 'q'"), 1) << said();
}

TEST_F(Ifogd, AnOptionThatIsNearlyRightIsTold) {
  configure(kFile);
  EXPECT_EQ(ifogd("--chekc"), 2);
  EXPECT_EQ(times_said("ifogd: unknown option '--chekc', did you mean '--check'?"), 1) << said();
}

TEST_F(Ifogd, WhatCannotBeSaidHasFailed) {
  configure(kFile);
  const std::string daemon = IFOG_BINARY_DIR "/daemon/ifogd ";
  for (const std::string& how :
       {"--config " + path("ifogd.toml") + " --check", std::string("--help"), std::string("--version")}) {
    const auto ended = [&](const char* to) {
      return WEXITSTATUS(std::system((daemon + how + " >" + to + " 2>/dev/null").c_str()));
    };
    EXPECT_EQ(ended("/dev/null"), 0) << how;
    EXPECT_EQ(ended("/dev/full"), 1) << how;
  }
}

TEST_F(Ifogd, ACheckOpensNothing) {
  configure(std::string(kFile) +
            "[sensor.record]\nfolder = \"tape\"\n"
            "[[sensor.channel]]\nname = \"hull_degC\"\nsource = \"lcm\"\nlcm_channel = \"HULL\"\n");
  // LCM would try to connect.
  std::string text;
  std::getline(std::ifstream(path("ifogd.toml")), text, '\0');
  write("ifogd.toml", text.replace(text.find("lock_memory"), 0, "lcm_url = \"tcpq://127.0.0.1:1\"\n"));
  EXPECT_EQ(ifogd("--check"), 0) << said();
  EXPECT_FALSE(std::filesystem::exists(path("tape")));
  ASSERT_EQ(lines_said().size(), 1U) << said();
  EXPECT_EQ(lines_said()[0], path("ifogd.toml") + ": good, 1 sensor(s)");
  EXPECT_EQ(ifogd(), 1) << said();
  EXPECT_GE(times_said("LCM tcpq"), 1) << said();
}

TEST_F(Ifogd, AFileWithoutAFrameHasFailed) {
  configure(kFile);
  write("flight.kvh", std::string(50'000, 'x'));
  EXPECT_EQ(ifogd(), 1) << said();
  EXPECT_EQ(times_said("nose: failed: " + path("flight.kvh") +
                       ": ended, and no frame of the sensor was in its 50000 bytes"),
            1)
      << said();
  write("flight.kvh", "");
  EXPECT_EQ(ifogd(), 1) << said();
}

// Of two that cannot be opened one would not run alone; here the other does, and what is said is what is.
TEST_F(Ifogd, ASensorThatIsNotOpenIsNotSaidToBeRead) {
  configure(std::string(kFile) +
            "[[sensor]]\nname = \"tail\"\ndriver = \"kvh1750\"\n[sensor.transport]\ntype "
            "= \"serial\"\ndevice = \"/dev/no-gyro\"\nbaud = 921600\n");
  write("flight.kvh", recording(30));
  const std::string command = "timeout -s TERM 3 " IFOG_BINARY_DIR "/daemon/ifogd --config " +
                              path("ifogd.toml") + " >" + path("said") + " 2>&1";
  (void)std::system(command.c_str());
  EXPECT_EQ(times_said("nose: reading "), 1) << said();
  EXPECT_EQ(times_said("tail: reading "), 0) << said();
  EXPECT_EQ(times_said("tail: trying again to open /dev/no-gyro at "), 1) << said();
}

// A gyro may be powered later than its computer: the service is ready, and waits.
TEST_F(Ifogd, WithoutItsOnlyDeviceItIsReadyAndWaits) {
  configure("[sensor.transport]\ntype = \"serial\"\ndevice = \"/dev/no-gyro\"\nbaud = 921600\n");
  const int manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path("notify").copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(manager, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const std::string command = "NOTIFY_SOCKET=" + path("notify") +
                              " timeout -s TERM 3 " IFOG_BINARY_DIR "/daemon/ifogd --config " +
                              path("ifogd.toml") + " >" + path("said") + " 2>&1";
  (void)std::system(command.c_str());
  std::array<char, 256> state{};
  const ssize_t length = recv(manager, state.data(), state.size(), 0);
  close(manager);
  EXPECT_TRUE(std::string_view(state.data(), static_cast<std::size_t>(std::max<ssize_t>(0, length)))
                  .starts_with("READY=1"));
  EXPECT_EQ(
      times_said("nose: /dev/no-gyro: cannot open: No such file or directory, expected a serial device"), 1)
      << said();
  EXPECT_EQ(times_said("nose: trying again to open /dev/no-gyro at "), 1) << said();
  EXPECT_EQ(times_said("stopping on SIGTERM"), 1) << said();
}

TEST_F(Ifogd, AFileCutOffWithinAFrameIsToldInOneLineAndCounted) {
  configure(kFile);
  std::string bytes = recording(300);
  bytes.resize(bytes.size() - 10);
  write("flight.kvh", bytes);
  EXPECT_EQ(ifogd(), 1);
  EXPECT_EQ(times_said("nose: failed: " + path("flight.kvh") +
                       ": ends within a frame, its last 26 bytes are no whole one (is the file cut off?)"),
            1)
      << said();
  EXPECT_EQ(times_said("bytes_skipped +26"), 1) << said();
  EXPECT_EQ(times_said("299 samples read, 299 published"), 1) << said();
}

// A line of a log that is no frame is reported with its place, while all else is read.
TEST_F(Ifogd, AFaultInALogIsToldWhereItIs) {
  configure("[sensor.options]\ndbc = \"" IFOG_SOURCE_DIR
            "/drivers/dbc/examples/ifogd_gyro.dbc\"\nsignal = \"Rate_x\"\nrate_hz = 100\n[sensor.transport]\n"
            "type = \"file\"\npath = \"gyro.log\"\nformat = \"candump\"\npace = \"recorded\"\n",
            "dbc");
  std::string log;
  for (int i = 0; i < 250; ++i) {
    if (i == 20) log += "rubbish\n";
    if (i > 200) log += "worse\n";
    char line[64];
    std::snprintf(line, sizeof line, "(1700000000.%06d) can0 100#0000003F00000000\n", i * 4000);
    log += line;
  }
  write("gyro.log", log);
  ifogd();
  EXPECT_GE(times_said(path("gyro.log") + ":21: "), 1) << said();
  EXPECT_GE(times_said(", found 'rubbish'"), 1) << said();
  EXPECT_EQ(times_said("worse"), 0) << said();
  EXPECT_GE(times_said("log_faults +"), 1) << said();
  EXPECT_EQ(times_said("250 samples read, 250 published"), 1) << said();
}

std::size_t line_length(const std::string& log) { return log.find('\n') + 1; }

// A sample of three frames: one frame twice, a whole sample twice, the last sample unfinished; and a slip in
// the DBC file.
TEST_F(Ifogd, WhatComesTwiceOrUnfinishedIsCounted) {
  std::string bus;
  for (int axis = 0; axis < 3; ++axis)
    bus += "BO_ " + std::to_string(256 + axis) + " M" + std::to_string(axis) + ": 8 X\n SG_ R" +
           std::to_string(axis) +
           " : 0|32@1- (1e-6,0) [0|0] \"rad/s\" X\n SG_ Count : 32|16@1+ (1,0) [0|0] \"\" X\n";
  write("bus.dbc", bus + " SG_ Slip : 48|8@3+ (1,0) [0|0] \"\" X\n");
  configure(
      "[sensor.options]\ndbc = \"" + path("bus.dbc") +
          "\"\nx = \"R0\"\ny = \"R1\"\nz = \"R2\"\ncounter = \"Count\"\nrate_hz = 100\n[sensor.transport]\n"
          "type = \"file\"\npath = \"gyro.log\"\nformat = \"candump\"\n",
      "dbc");
  std::string log;
  const auto frame = [&](int sample, int axis) {
    char line[80];
    std::snprintf(line, sizeof line, "(1700000000.%06d) can0 %03X#%02X%02X0000%02X%02X0000\n",
                  sample * 4000 + axis * 100, static_cast<unsigned>(256 + axis),
                  static_cast<unsigned>(sample % 251), static_cast<unsigned>(axis),
                  static_cast<unsigned>(sample & 0xFF), static_cast<unsigned>(sample >> 8));
    log += line;
  };
  for (int k = 0; k < 200; ++k)
    for (int axis = 0; axis < 3; ++axis) frame(k, axis);
  const auto place = [&](int sample, int axis) {
    return static_cast<std::size_t>(sample * 3 + axis) * line_length(log);
  };
  log.insert(place(120, 0), log.substr(place(119, 0), 3 * line_length(log)));
  log.insert(place(60, 2), log.substr(place(60, 1), line_length(log)));
  log.resize(log.size() - line_length(log));
  write("gyro.log", log);
  ifogd();
  EXPECT_EQ(times_said("frames_repeated +1"), 1) << said();
  EXPECT_EQ(times_said("samples_repeated +1"), 1) << said();
  EXPECT_EQ(times_said("samples_incomplete +1"), 1) << said();
  EXPECT_EQ(times_said("199 samples read, 199 published"), 1) << said();
  EXPECT_EQ(times_said("bus.dbc:10: '3+ (1,0) [0|0] \"\" X', expected one of 01"), 1) << said();
}

// A driver that throws ends its own sensor, and is named with what it threw.
TEST_F(Ifogd, ADriverThatThrowsEndsItsSensorAlone) {
  write("flight.kvh", recording(300));
  configure(kFile +
            std::string("[[sensor]]\nname = \"tail\"\ndriver = \"throwing\"\nnominal_rate_hz = 100\n") +
            kFile);
  setenv("IFOG_PLUGIN_PATH", IFOG_BINARY_DIR "/tests/unit/drivers/refused/plugins", 1);
  EXPECT_EQ(ifogd(), 1);
  EXPECT_EQ(
      times_said("warning: tail: failed: " + path("flight.kvh") +
                 ": the driver has thrown an exception and is not called any more, found 'throwing: boom'"),
      1)
      << said();
  EXPECT_EQ(times_said("nose: 300 samples read, 300 published"), 1) << said();
}

// Of that process, as the kernel has it: bit n - 1 is signal n.
std::uint64_t blocked_signals(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("SigBlk:", 0) == 0) return std::stoull(line.substr(7), nullptr, 16);
  return 0;
}

// Blocked at the first thing that it does, writing its version into a pipe that is full, it can no longer be
// killed by a reload that is too early. SIGTERM and Ctrl-C end it at once.
TEST_F(Ifogd, AReloadWaitsFromItsFirstMoment) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(fcntl(ends[1], F_SETFL, O_NONBLOCK), 0);
  for (const char c = 'x'; ::write(ends[1], &c, 1) == 1;) {
  }
  ASSERT_EQ(fcntl(ends[1], F_SETFL, 0), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    execl(IFOG_BINARY_DIR "/daemon/ifogd", "ifogd", "--version", nullptr);
    _exit(127);
  }
  constexpr std::uint64_t kOurs = 1U << (SIGHUP - 1);
  for (int turn = 0; turn < 1000 && blocked_signals(child) != kOurs; ++turn) usleep(10'000);
  EXPECT_EQ(blocked_signals(child), kOurs);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace ifog
