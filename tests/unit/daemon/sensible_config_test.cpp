// SPDX-License-Identifier: Apache-2.0
// Configurations whose every key is well formed and that still cannot work: names, numbers, pairs of sensors.
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/config/config.h"
#include "daemon/config/lcm_url.h"
#include "tests/unit/daemon/config_complaint.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

std::string sensor(const std::string& name, const std::string& transport, const std::string& more = "") {
  return "[[sensor]]\nname = \"" + name + "\"\ndriver = \"x\"\n[sensor.transport]\n" + transport + more;
}

constexpr const char* kFile = "type = \"file\"\npath = \"a\"\n";

std::string channel(const std::string& keys) { return sensor("nose", kFile, "[[sensor.channel]]\n" + keys); }

// The oracle is what a capture's header may be: README of captures, columns time_s, rate_AXIS_radps,
// reference_rate_AXIS_radps and NAME_UNIT.
TEST(SensibleConfig, AChannelIsCalledByItsQuantityAndUnit) {
  for (const char* const good : {"coil_degC", "load_us", "rate_ramp_x_radps", "humidity_percent", "p_1_Pa"})
    EXPECT_EQ(complaint(channel("name = \"" + std::string(good) + "\"\nsource = \"file\"\npath = \"b\"\n")),
              "")
        << good;
  for (const char* const taken :
       {"time_s", "rate_radps", "rate_x_radps", "reference_rate_radps", "reference_rate_z_radps"})
    EXPECT_EQ(
        complaint(channel("name = \"" + std::string(taken) + "\"\nsource = \"lcm\"\nlcm_channel = \"B\"\n")),
        "f.toml:8: sensor.channel.name = '" + std::string(taken) +
            "': expected another name, captures call their time or a rate so");
  for (const char* const bare : {"foo", "_degC", "coil_", "coil degC", "a,b_degC", "a[0]_V"})
    EXPECT_EQ(complaint(channel("name = \"" + std::string(bare) + "\"\nsource = \"file\"\npath = \"b\"\n")),
              "f.toml:8: sensor.channel.name = '" + std::string(bare) +
                  "': expected NAME_UNIT without blanks, commas, quotes and brackets, \"temperature_degC\"");
  // Those of the frames are the driver's to name.
  EXPECT_EQ(complaint(channel("name = \"foo\"\nsource = \"frame\"\n")), "");
}

// One wrong key, one complaint.
TEST(SensibleConfig, NumbersThatLetNothingThroughAreRefused) {
  const std::string coil = channel("name = \"coil_degC\"\nsource = \"file\"\npath = \"b\"\n");
  const std::string head = "[[sensor]]\nname = \"nose\"\ndriver = \"x\"\n";
  const std::string tail = std::string("[sensor.transport]\n") + kFile;
  expect_complaints(
      "", {{coil + "max_step = 0\n", "11: sensor.channel.max_step = 0: "},
           {coil + "scale = 0\n", "11: sensor.channel.scale = 0: "},
           {coil + "maximum = -300\n", "11: sensor.channel.maximum: expected limits within -273.15 ... 3000"},
           {coil + "period_s = 60\n", "11: sensor.channel.period_s: read every 60 s with max_age_s = 10: "},
           {head + "max_step = 0\n" + tail, "4: sensor.max_step = 0: "},
           {head + "range_radps = 2.0\nminimum = 3.0\n" + tail, "5: sensor.minimum: "},
           {sensor("nose", kFile, "pace = \"recorded\"\nbytes_per_second = 1e300\n"),
            "8: sensor.transport.bytes_per_second = 1e+300: "},
           {sensor("nose", kFile, "[sensor.record]\nfolder = \"r\"\nbytes = 5\nfile_bytes = 900_000_000\n"),
            "9: sensor.record.bytes = 5: "}});
  EXPECT_EQ(complaint(coil + "period_s = 60\nmax_age_s = 0\n"), "");
  const std::string twice =
      complaint(sensor("a", "type = \"udp\"\nport = 0\n") + sensor("b", "type = \"udp\"\nport = 0\n"));
  EXPECT_EQ(std::count(twice.begin(), twice.end(), '\n'), 1) << twice;
}

TEST(SensibleConfig, TheFieldOfAnLcmChannelIsOneThatMessagesHave) {
  const std::string hull = "name = \"hull_degC\"\nsource = \"lcm\"\nlcm_channel = \"HULL\"\n";
  for (const char* const good : {"hull_degC", "raw[2]", "channel_value[coil_degC]", "nis_mean[0]"})
    EXPECT_EQ(complaint(channel(hull + "field = \"" + good + "\"\n")), "") << good;
  for (const char* const bad : {"raw[3]", "raw[x]", "raw[", "raw[0]x", "angle[0]", "channel_value[]",
                                "clock_offset_ppm[0]", "foo[0]"})
    EXPECT_EQ(complaint(channel(hull + "field = \"" + bad + "\"\n"))
                  .rfind("f.toml:11: sensor.channel.field = '" + std::string(bad) +
                             "': expected the name in an ifog.channel_t; raw[i]",
                         0),
              0U)
        << bad;
}

TEST(SensibleConfig, AnLcmUrlIsOneThatLcmUnderstands) {
  for (const char* const good :
       {"udpm://239.255.76.67:7667?ttl=0", "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4000000", "udpm://",
        "udpm://?ttl=1", "memq://", "tcpq://localhost:7700"})
    EXPECT_EQ(lcm_url_complaint(good), "") << good;
  for (const char* const bad :
       {"foo://", "", "udpm://239.255.76.67:99999", "udpm://1.2.3.4:1", "udpm://239.255.76.67:7667?ttl=abc",
        "udpm://239.255.76.67:7667?foo=1", "udpm://239.255.76.67:7667?ttl=0x", "udpm://239.255.76.67:7667?",
        "udpm://239.255.76.67:7667?ttl=256", "udpm://[ff02::1]:7667", "239.255.76.67:7667"})
    EXPECT_NE(lcm_url_complaint(bad), "") << bad;
  EXPECT_EQ(complaint("[daemon]\nlcm_url = \"foo://\"\n" + sensor("nose", kFile))
                .rfind("f.toml:2: daemon.lcm_url = 'foo://': expected \"udpm://GROUP:PORT?ttl=N\"", 0),
            0U);
}

std::string shared(const std::string& key, const std::string& value) {
  return ": sensor.transport." + key + " = " + value +
         ": sensor 'a' reads from there already; expected a source of its own for each";
}

TEST(SensibleConfig, TwoSensorsDoNotReadOneSource) {
  const test::OwnFolder own;
  const std::string folder = own.folder(), fifo = folder + "/fifo", link = folder + "/link",
                    file = folder + "/file";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  std::filesystem::create_symlink("fifo", link);
  struct Case {
    std::string first, second, told;  // told "": they do not share
  };
  const auto path = [](const std::string& name) { return "type = \"file\"\npath = \"" + name + "\"\n"; };
  const auto udp = [](const std::string& more) { return "type = \"udp\"\nport = 5000\n" + more; };
  const auto serial = [](const std::string& name) {
    return "type = \"serial\"\ndevice = \"" + name + "\"\n";
  };
  const auto tcp = [](const std::string& host) {
    return "type = \"tcp\"\nport = 4001\nhost = \"" + host + "\"\n";
  };
  const std::string group = "group = \"239.1.2.3\"\ninterface = \"eth0\"\n";
  for (const Case& each : std::initializer_list<Case>{
           {udp(""), udp(""), shared("port", "5000")},
           {udp("bind = \"127.0.0.1\"\n"), udp(""), shared("port", "5000")},
           {udp("bind = \"127.0.0.1\"\n"), udp("bind = \"0.0.0.0\"\n"), shared("port", "5000")},
           {udp("bind = \"127.0.0.1\"\n"), udp("bind = \"127.0.0.2\"\n"), ""},
           {udp("bind = \"::1\"\n"), udp("bind = \"0:0::1\"\n"), shared("port", "5000")},
           {udp("bind = \"::\"\n"), udp(""), ""},  // IPv6 sockets here keep to IPv6
           {udp(group), udp(group), ""},           // each is sent its own copy
           {udp(group), udp(""), shared("port", "5000")},
           {udp(""), "type = \"udp\"\nport = 5001\n", ""},
           {serial("/dev/no-1"), serial("/dev/no-1"), shared("device", "'/dev/no-1'")},
           {serial("/dev/no-1"), serial("/dev/no-2"), ""},
           {serial(folder + "/x/../no"), serial(folder + "/no"), shared("device", "'" + folder + "/no'")},
           {tcp("10.0.0.1"), tcp("10.0.0.1"), shared("port", "10.0.0.1:4001")},
           {tcp("fd00::1"), tcp("fd00:0::1"), shared("port", "[fd00:0::1]:4001")},
           {tcp("10.0.0.1"), tcp("10.0.0.2"), ""},
           {tcp("127.0.0.1"), tcp("127.0.0.2"), ""},
           {path("-"), path("-"), shared("path", "'-'")},
           {path(fifo), path(fifo), shared("path", "'" + fifo + "'")},
           {path(fifo), path(link), shared("path", "'" + link + "'")},
           {path("/dev/zero"), serial("/dev/zero"), shared("device", "'/dev/zero'")},
           {path(file), path(file), ""},  // a recording is read by as many as like
           {"type = \"can\"\ninterface = \"can0\"\n", "type = \"can\"\ninterface = \"can0\"\n", ""}}) {
    const std::string told = complaint(sensor("a", each.first) + sensor("b", each.second));
    const std::string without_line = told.substr(std::min(told.size(), told.find(": sensor")));
    EXPECT_EQ(without_line, each.told) << each.first << each.second;
  }
  EXPECT_EQ(complaint(sensor("a", udp("")) + sensor("b", udp(""))), "f.toml:12" + shared("port", "5000"));
}

// Whatever it is called; the test's own is a pipe while it is asked.
TEST(SensibleConfig, StandardInputIsOneSource) {
  const int before = dup(STDIN_FILENO);
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  dup2(ends[0], STDIN_FILENO);
  const auto path = [](const std::string& name) { return "type = \"file\"\npath = \"" + name + "\"\n"; };
  for (const char* const name : {"/dev/stdin", "/proc/self/fd/0", "-"})
    EXPECT_TRUE(test::has(complaint(sensor("a", path("-")) + sensor("b", path(name))),
                          shared("path", "'" + std::string(name) + "'")))
        << name;
  dup2(before, STDIN_FILENO);
  for (const int end : {before, ends[0], ends[1]}) close(end);
}

TEST(SensibleConfig, ARateDoesNotComeBackAsAChannelOfItsOwn) {
  const auto from = [](const std::string& channel, const std::string& field) {
    return "[[sensor.channel]]\nname = \"own_radps\"\nsource = \"lcm\"\nlcm_channel = \"" + channel +
           "\"\nfield = \"" + field + "\"\n";
  };
  const auto own = [&](const std::string& field) {
    return complaint(sensor("own", kFile, from("IFOG_OWN", field)));
  };
  const std::string told =
      "f.toml:10: sensor.channel.own_radps.lcm_channel = 'IFOG_OWN': the rate of sensor 'own' would come "
      "back as a channel of its own; expected one that does not depend on it";
  EXPECT_EQ(own("compensated[0]"), told);
  EXPECT_EQ(own("denoised[2]"), told);
  EXPECT_EQ(own("raw[0]"), told);
  // Its health does not follow the rate, and another sensor's measured rate no correction.
  EXPECT_EQ(complaint(sensor("own", kFile, from("IFOG_OWN_STATUS", "input_rate_hz"))), "");
  EXPECT_EQ(
      complaint(sensor("a", kFile, from("IFOG_B", "raw[0]")) + sensor("b", kFile, from("IFOG_A", "raw[0]"))),
      "");
  EXPECT_EQ(complaint(sensor("a", kFile, from("IFOG_B", "denoised[0]")) + sensor("b", kFile)), "");
  const std::string mutual = complaint(sensor("a", kFile, from("IFOG_B", "denoised[0]")) +
                                       sensor("b", kFile, from("IFOG_A", "compensated[0]")));
  EXPECT_TRUE(test::has(mutual, "the rate of sensor 'a' would come back"));
  EXPECT_TRUE(test::has(mutual, "the rate of sensor 'b' would come back"));
}

// A recording of an earlier version is read, whatever the daemon would now say of its configuration.
TEST(SensibleConfig, ARecordedConfigurationIsReadAsItWas) {
  const std::string text =
      channel("name = \"foo\"\nsource = \"file\"\npath = \"b\"\nscale = 0\nmax_step = 0\n");
  EXPECT_NE(complaint(text), "");
  EXPECT_EQ(parse_recorded_config(text, "f.toml").sensors.at(0).channels.at(0).name, "foo");
}

// Serial lines of ARM boards have other names than those of a PC.
TEST(Unit, LetsTheDaemonToTheSerialLinesOfArmBoards) {
  std::ifstream unit(IFOG_SOURCE_DIR "/systemd/ifogd.service.in");
  std::set<std::string> allowed;
  for (std::string line; std::getline(unit, line);)
    if (line.starts_with("DeviceAllow=")) allowed.insert(line);
  for (const char* name : {"ttyS", "ttyAMA", "ttymxc", "ttyTHS", "ttyPS", "ttySC"})
    EXPECT_EQ(allowed.count(std::string("DeviceAllow=char-") + name + " rw"), 1U) << name;
}

}  // namespace
}  // namespace ifog
