// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.h"
#include "daemon/sensor/flight_header.h"
#include "daemon/sensor/sensor_parts.h"
#include "drivers/transport/clock.h"
#include "tests/unit/daemon/config_complaint.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr const char* kGood = R"(
[[sensor]]
name = "nose"
driver = "kvh1750"
[sensor.transport]
type = "file"
path = "a.kvh"
)";

TEST(Config, ReadsWhatIsThereAndFillsInTheRest) {
  const Config config = parse_config(std::string(kGood) + R"(
[sensor.options]
format = "b"
rate_hz = 962.5
[sensor.filter]
window = 20
[sensor.realtime]
filter_priority = 60
filter_cpus = [1]
[[sensor.channel]]
name = "supply_V"
source = "file"
path = "/sys/class/hwmon/hwmon0/in0_input"
scale = 1e-3
)",
                                     "/etc/ifogd/f.toml");
  ASSERT_EQ(config.sensors.size(), 1U);
  const SensorConfig& sensor = config.sensors[0];
  EXPECT_EQ(sensor.lcm_channel(), "IFOG_NOSE");
  EXPECT_EQ(sensor.transport.file.path, "/etc/ifogd/a.kvh");  // relative to the configuration
  EXPECT_EQ(sensor.options.at("rate_hz"), "962.5");
  EXPECT_EQ(sensor.options.at("format"), "b");
  EXPECT_EQ(sensor.filter.window, 20);
  EXPECT_FALSE(sensor.filter.measurement_noise.has_value());
  EXPECT_EQ(sensor.realtime.filter_priority, 60);
  ASSERT_EQ(sensor.channels.size(), 1U);
  EXPECT_EQ(sensor.channels[0].scale, 1e-3);
}

// Wherever the daemon was started: a service starts in the root folder.
TEST(Config, AFileNamedAmongTheDriversOptionsLiesBesideTheConfiguration) {
  const test::OwnFolder folder;
  std::filesystem::create_directory(folder.path("bus"));
  folder.write("bus/gyro.dbc",
               "BU_: G\nBO_ 1 Rate: 8 G\n SG_ Rate_z : 0|16@1- (0.01,0) [-300|300] \"deg/s\" G\n");
  const Config config = parse_config(R"(
[[sensor]]
name = "nose"
driver = "dbc"
nominal_rate_hz = 100
[sensor.transport]
type = "can"
interface = "can0"
[sensor.options]
dbc = "bus/gyro.dbc"
z = "Rate_z"
)",
                                     folder.path("ifogd.toml"));
  const DriverInstance driver = make_sensor_driver(config.sensors.at(0), {});
  EXPECT_EQ(driver.description().axes, 1U);
}

SensorConfig serial_sensor(const std::string& keys, const std::string& driver = "kvh1750") {
  const std::string text = "[[sensor]]\nname = \"nose\"\ndriver = \"" + driver +
                           "\"\n[sensor.transport]\ntype = \"serial\"\ndevice = \"/dev/ttyS1\"\n";
  return parse_config(text + keys, "f.toml").sensors.at(0);
}

// What is not said of it is the driver's speed, here the maker's, and 8N1.
TEST(Config, TheLineReachesTheTransportAsConfigured) {
  const auto line_of = [](const SensorConfig& sensor) {
    return sensor_serial_settings(sensor, make_sensor_driver(sensor, {}));
  };
  EXPECT_EQ(line_of(serial_sensor(
                "baud = 460800\ndata_bits = 7\nparity = \"odd\"\nstop_bits = 2\nbaud_base = 4000000\n")),
            (SerialSettings{.device = "/dev/ttyS1",
                            .baud = 460800,
                            .data_bits = 7,
                            .parity = SerialSettings::Parity::odd,
                            .stop_bits = 2,
                            .baud_base = 4'000'000}));
  EXPECT_EQ(line_of(serial_sensor("", "dsp3000")), (SerialSettings{.device = "/dev/ttyS1", .baud = 38400}));
}

constexpr const char* kCan = "\ndriver = \"x\"\n[sensor.transport]\ntype = \"can\"\ninterface = \"can0\"\n";
constexpr const char* kSerial =
    "[[sensor]]\nname = \"b\"\ndriver = \"x\"\n[sensor.transport]\ntype = \"serial\"\ndevice = "
    "\"/dev/ttyS0\"\n";

// What is wrong is named by file, line, key and value, in one line.
TEST(Config, NamesWhereAndWhat) {
  const std::string frame = "[[sensor.channel]]\nname = \"t_degC\"\nsource = \"frame\"\n";
  const std::string publish = "[[sensor.publish]]\ntype = \"bot_core.ins_t\"\nchannel = ";
  expect_complaints(
      kGood,  // whose lines are 1 … 7
      {{"colour = 1\n", "8: sensor.transport.colour: unknown key; known here: "},
       {"speed = \"fast\"\n", "8: sensor.transport.speed = 'fast': expected a number 0.001 ... 1e+06"},
       {"speed = -1\n", "8: sensor.transport.speed = -1: "},
       {"pace = \"slow\"\n", "8: sensor.transport.pace = 'slow': expected \"free\" | \"recorded\""},
       {"pace = \"recorded\"\n", "8: sensor.transport.pace = \"recorded\": raw bytes carry no times"},
       {"bytes_per_second = -1.0\n", "8: sensor.transport.bytes_per_second = -1: "},
       {"interface = \"\"\n", "8: sensor.transport.interface = '': "},
       {"await_writer = 1\n", "8: sensor.transport.await_writer = 1: "},
       {"block_bytes = 65537\n", "8: sensor.transport.block_bytes = 65537: "},
       {"[sensor.filter]\nwindow = 1\n", "9: sensor.filter.window = 1: "},
       {"[sensor.filter]\nwindow = 5.5\n", "9: sensor.filter.window = 5.5: expected a whole number"},
       {"[sensor.filter]\nprocess_noise = -1e-9\n", "9: sensor.filter.process_noise = -1e-09: "},
       {"[sensor.filter]\nprocess_noise = nan\n", "9: sensor.filter.process_noise = nan: "},
       {"[sensor.realtime]\nreader_cpus = [0, -1]\n", "9: sensor.realtime.reader_cpus = [ 0, -1 ]: "},
       {"[[sensor.channel]]\nname = \"t_degC\"\n", "8: sensor.channel.source: missing; expected "},
       {std::string("[[sensor]]\nname = \"NOSE\"") + kCan,
        "9: sensor.name = 'NOSE': another sensor publishes"},
       {std::string("[[sensor]]\nname = \"nose_status\"") + kCan, "9: sensor.name = 'nose_status': "},
       {std::string("[[sensor]]\nname = \"nose_imu\"") + kCan, "9: sensor.name = 'nose_imu': "},
       {std::string(kSerial) + "set_up = [\"=CONFIG,1\", \"DR\"]\n",
        "14: sensor.transport.set_up = ['DR']: "},
       {std::string(kSerial) + "parity = \"mark\"\n", "14: sensor.transport.parity = 'mark': "},
       {std::string(kSerial) + "baud = 49\n", "14: sensor.transport.baud = 49: "},
       {std::string(kSerial) + "data_bits = 9\n", "14: sensor.transport.data_bits = 9: "},
       {std::string(kSerial) + "stop_bits = 0\n", "14: sensor.transport.stop_bits = 0: "},
       {"[[sensor.publish]]\nchannel = \"A\"\n", "8: sensor.publish.type: missing; expected "},
       {"[[sensor.publish]]\ntype = \"bot_core.ins\"\nchannel = \"A\"\n",
        "9: sensor.publish.type = 'bot_core.ins': "},
       {publish + "\"IFOG_A\"\n", "10: sensor.publish.channel = 'IFOG_A': "},
       {publish + "\"A\"\n" + publish + "\"A\"\n",
        "10: sensor.publish.channel = 'A': something else is published"},
       {frame + "minimum = 5.0\nmaximum = 5.0\n", "12: sensor.channel.maximum: not above minimum; "},
       {frame + "max_step = -1.0\n", "11: sensor.channel.max_step = -1: "},
       {"[[sensor.channel]]\nname = \"t_degC\"\nsource = \"lcm\"\nlcm_channel = \"A\"\nscale = inf\n",
        "12: sensor.channel.scale = inf: "},
       {"[daemon]\nlog_level = \"loud\"\n", "9: daemon.log_level = 'loud': "}});
}

std::string network(const std::string& transport) {
  return "[[sensor]]\nname = \"nose\"\ndriver = \"x\"\n[sensor.transport]\n" + transport;
}

TEST(Config, ReadsANetworkSensor) {
  const Config udp = parse_config(network("type = \"udp\"\nport = 5000\ngroup = \"239.1.2.3\"\ninterface = "
                                          "\"eth0\"\nhost = \"192.168.1.20\"\n"),
                                  "f.toml");
  EXPECT_EQ(udp.sensors[0].transport.kind, TransportConfig::Kind::udp);
  EXPECT_EQ(
      udp.sensors[0].transport.udp,
      (UdpSettings{
          .port = 5000, .bind = "", .group = "239.1.2.3", .interface = "eth0", .host = "192.168.1.20"}));
  const Config tcp =
      parse_config(network("type = \"tcp\"\nhost = \"fe80::20%eth0\"\nport = 4001\n"), "f.toml");
  EXPECT_EQ(tcp.sensors[0].transport.kind, TransportConfig::Kind::tcp);
  EXPECT_EQ(tcp.sensors[0].transport.tcp, (TcpSettings{.host = "fe80::20%eth0", .port = 4001}));
  EXPECT_EQ(udp.sensors[0].restart_for(tcp.sensors[0]), "transport");
}

TEST(Config, NamesWhatIsWrongWithANetworkSensor) {
  const std::string udp = "type = \"udp\"\nport = 5000\n", tcp = "type = \"tcp\"\nport = 4001\n";
  expect_complaints(
      network(""),
      {{"type = \"udp\"\n", "4: sensor.transport.port: missing; "},
       {"type = \"udp\"\nport = 70000\n", "6: sensor.transport.port = 70000: "},
       {udp + "bind = \"here\"\n", "7: sensor.transport.bind = 'here': expected a numeric address of this "},
       {udp + "bind = \"239.1.2.3\"\n", "7: sensor.transport.bind = '239.1.2.3': "},
       {udp + "interface = \"eth0\"\n", "7: sensor.transport.interface = 'eth0': "},
       {udp + "group = \"239.1.2.3\"\n", "4: sensor.transport.interface: missing; "},
       {udp + "group = \"10.1.2.3\"\ninterface = \"eth0\"\n",
        "7: sensor.transport.group = '10.1.2.3': expected a multicast address"},
       {udp + "group = \"239.1.2.3\"\ninterface = \"eth0\"\nbind = \"10.0.0.1\"\n",
        "9: sensor.transport.bind = '10.0.0.1': "},
       {udp + "host = \"gyro\"\n", "7: sensor.transport.host = 'gyro': "},
       {udp + "bind = \"::1\"\nhost = \"10.0.0.1\"\n",
        "8: sensor.transport.host = '10.0.0.1': expected an address of the same kind, IPv4 or IPv6, as "
        "::1"},
       {tcp, "4: sensor.transport.host: missing; "},
       {tcp + "host = \"10.0.0.1\"\nbaud = 9600\n", "8: sensor.transport.baud: unknown key; "}});
  for (const std::string host :
       {"gyro.local", "239.1.2.3", "fe80::1", "ff02::1", "192.168.1", "192.168.1.256", "1.2.3.4:5", "[::1]",
        "fe80::1%", "fe80::1%an-interface-too-long", "::1 "})
    EXPECT_TRUE(complaint(network(tcp + "host = \"" + host + "\"\n"))
                    .starts_with("f.toml:7: sensor.transport.host = '" + host + "': expected a numeric"));
  for (const std::string host : {"223.255.255.255", "::1", "fe80::1%eth0"})
    EXPECT_EQ(complaint(network(tcp + "host = \"" + host + "\"\n")), "");
  EXPECT_EQ(complaint(network(udp + "group = \"ff02::1:2\"\ninterface = \"eth0\"\nhost = \"fe80::1\"\n")),
            "");
}

TEST(Config, GathersAllErrors) {
  const std::string all = complaint("[[sensor]]\nname = \"a b\"\nmodle = \"x\"\n");
  EXPECT_EQ(all,
            "f.toml:2: sensor.name = 'a b': expected at most 32 letters, digits, _ and -\n"
            "f.toml:1: sensor.driver: missing; expected the name of a driver, see `ifog drivers`\n"
            "f.toml:1: sensor.transport: missing; expected a table [sensor.transport]\n"
            "f.toml:3: sensor.modle: unknown key, did you mean 'model'? Known here: channel, driver, filter, "
            "imu, max_step, maximum, minimum, model, name, nominal_rate_hz, options, powered_with_computer, "
            "publish, range_radps, realtime, record, transport");
}

// The kernel's own file is the oracle of the time since boot.
TEST(Config, ASensorPoweredWithTheComputerHasBeenOnSinceBoot) {
  const std::string head = "[[sensor]]\nname = \"n\"\ndriver = \"kvh1750\"\n";
  const std::string tail = "[sensor.transport]\ntype = \"file\"\npath = \"x\"\n";
  EXPECT_FALSE(powered_ns(parse_config(head + tail, "f.toml").sensors.at(0)));
  const Config config = parse_config(head + "powered_with_computer = true\n" + tail, "f.toml");
  const std::optional<std::int64_t> since_ns = powered_ns(config.sensors.at(0));
  ASSERT_TRUE(since_ns);
  const double since_s = static_cast<double>(arrival_clock_ns() - *since_ns) * 1e-9;
  double boot_s = 0.0;
  ASSERT_TRUE(std::ifstream("/proc/uptime") >> boot_s);
  EXPECT_LE(since_s, boot_s + 0.02);  // hundredths
  EXPECT_GE(since_s, boot_s - 60.0);  // however long this test was held up in between
}

// systemd's name of a run has no dashes, the kernel's has.
TEST(Config, TheComputersRunHasTheNameThatTheKernelGivesIt) {
  std::string name;
  ASSERT_TRUE(std::ifstream("/proc/sys/kernel/random/boot_id") >> name);
  std::erase(name, '-');
  EXPECT_EQ(boot_id(), name);
  ASSERT_EQ(setenv("IFOGD_BOOT_ID", "0f8fad5b-d9cb469fa16570867728950e", 1), 0);
  EXPECT_EQ(boot_id(), "0f8fad5bd9cb469fa16570867728950e");
  unsetenv("IFOGD_BOOT_ID");
}

TEST(Config, NothingToDoNoTomlAndNoFileAreErrors) {
  EXPECT_EQ(complaint("[daemon]\n"), "f.toml: no [[sensor]]: expected at least one");
  EXPECT_TRUE(complaint("[daemon]\nlock_memory = \n").starts_with("f.toml:2: "));
  EXPECT_TRUE(complaint("[[sensor]]\nname = nose\n").starts_with("f.toml:2: a text needs quotes; "));
  const std::string no_file = test::refusal([] { read_config("/nonexistent/ifogd.toml"); });
  EXPECT_TRUE(test::has(no_file, "/nonexistent/ifogd.toml") && !test::has(no_file, "\n")) << no_file;
}

// What the file holds may have line ends of its own.
TEST(Config, AComplaintIsOneLineWhateverTheFileHolds) {
  for (const char* text : {"venso\nx = 1\n", "\"a\\nb\" = 1\n", "x = \"\"\"a\nb\"\"\"\n"}) {
    std::string config = kGood;
    config.append("[sensor.realtime]\nspin = true\n[sensor.filter]\n").append(text);
    const std::string all = complaint(config);
    EXPECT_EQ(all.rfind("f.toml:1", 0), 0U) << all;
    EXPECT_FALSE(test::has(all, "\n")) << all;
  }
}

// As the reference has them; without, everything that a sensor can measure passes.
TEST(Config, TheUsersLimitsOfSensorAndChannel) {
  const Config config = read_config(std::string(IFOG_SOURCE_DIR) + "/daemon/examples/reference.toml");
  const SensorConfig& sensor = config.sensors.at(0);
  EXPECT_EQ(sensor.limits, (Limits{.minimum = -5.0, .maximum = 5.0, .max_step = 1.0}));
  ASSERT_EQ(sensor.channels.at(0).name, "temperature_degC");
  EXPECT_EQ(sensor.channels.at(0).limits, (Limits{.minimum = -40.0, .maximum = 85.0, .max_step = 5.0}));
  EXPECT_EQ(sensor.channels.at(1).limits, Limits{});
  EXPECT_EQ(complaint("[[sensor]]\nname = \"a\"\ndriver = \"kvh1750\"\nminimum = 2.0\nmaximum = -2.0\n"
                      "max_step = -1.0\n[sensor.transport]\ntype = \"file\"\npath = \"x\"\n"),
            "f.toml:6: sensor.max_step = -1: expected a number > 0 and <= 20000\n"
            "f.toml:5: sensor.maximum: not above minimum; expected minimum < maximum");
}

constexpr const char* kRecorded =
    "[[sensor]]\nname = \"a\"\ndriver = \"kvh1750\"\n[sensor.transport]\ntype = \"file\"\npath = \"x\"\n"
    "[sensor.record]\n";

TEST(Config, TheRecordersLimitsAreHeldToOneAnother) {
  const Config reference = read_config(std::string(IFOG_SOURCE_DIR) + "/daemon/examples/reference.toml");
  RecordConfig defaults;
  defaults.folder = "/var/lib/ifogd/record";
  EXPECT_EQ(reference.sensors.at(0).record, defaults);  // the reference shows the defaults
  EXPECT_EQ(complaint(kRecorded),
            "f.toml:7: sensor.record.folder: missing; expected a folder, "
            "\"/var/lib/ifogd/record\"");
  EXPECT_EQ(
      complaint(std::string(kRecorded) + "folder = \"r\"\nbytes = 3_000_000\nfile_bytes = 1_000_000\n"),
      "f.toml:9: sensor.record.bytes: bytes = 3000000 with file_bytes = 1000000: expected room for at least "
      "four files");
  EXPECT_EQ(complaint(std::string(kRecorded) + "folder = \"r\"\ndays = 0\n"),
            "f.toml:9: sensor.record.days = 0: expected a number 0.001 ... 100000");
}

// What a flight recording carries is the sensor as it is now configured, and reads as that.
TEST(Config, ASensorsTextReadsAsTheSensorAlsoWhenReloaded) {
  const std::string file = std::string(IFOG_SOURCE_DIR) + "/daemon/examples/reference.toml";
  const SensorConfig sensor = read_config(file).sensors.at(0);
  const auto same = [&](const SensorConfig& read, const SensorConfig& expected) {
    EXPECT_EQ(read.restart_for(expected), "");
    EXPECT_EQ(read.name, expected.name);
    EXPECT_EQ(read.model, expected.model);
    EXPECT_EQ(read.start_up_s, expected.start_up_s);
    EXPECT_EQ(read.filter.process_noise, expected.filter.process_noise);
    EXPECT_EQ(read.filter.window, expected.filter.window);
  };
  same(parse_config(sensor.text, file).sensors.at(0), sensor);
  const SensorConfig fresh =
      parse_config(
          "[[sensor]]\nname = \"nose\"\ndriver = \"kvh1750\"\nmodel = \"other.toml\"\nrange_radps = 1.0\n"
          "[sensor.transport]\ntype = \"file\"\npath = \"x\"\n[sensor.filter]\nwindow = 77\n",
          file)
          .sensors.at(0);
  const SensorConfig reloaded = sensor.reloaded(fresh);
  EXPECT_EQ(reloaded.model, fresh.model);
  EXPECT_EQ(reloaded.filter.window, 77);
  EXPECT_EQ(reloaded.range_radps, sensor.range_radps);
  same(parse_config(reloaded.text, file).sensors.at(0), reloaded);
}

// A log's frames go back onto the interface that they came on: by the first that the driver wants.
TEST(RecordedHeader, OfALogOfCandumpTheInterfaceIsKept) {
  const test::OwnFolder folder;
  const std::string log = folder.path("frames.log");
  const DriverInstance driver = make_driver(
      "dbc", {{"dbc", std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/goetting_hg_g_84300.dbc"},
              {"signal", "Angle"},
              {"kind", "angle"}});
  ASSERT_EQ(driver.description().can_ids, 1U);
  std::array<char, 4> id{};
  std::snprintf(id.data(), id.size(), "%03X", driver.description().can_id[0].id);
  std::ofstream(log) << "(1.0) can7 7FF#00\n(1.1) vcan3 " << id.data() << "#0000000000000000\n";
  SensorConfig sensor;
  sensor.name = "nose";
  sensor.driver = "dbc";
  sensor.transport.kind = TransportConfig::Kind::file;
  sensor.transport.file.format = FileSettings::Format::candump;
  sensor.transport.file.path = log;
  Config config;
  config.file = "ifogd.toml";
  const auto interface = [&] { return flight_header(sensor, config, driver, "").interface; };
  EXPECT_EQ(interface(), "vcan3");
  sensor.transport.interface = "can1";
  EXPECT_EQ(interface(), "can1");
  sensor.transport.kind = TransportConfig::Kind::can;
  EXPECT_EQ(interface(), "can1");
  sensor.transport.kind = TransportConfig::Kind::file;
  sensor.transport.interface.clear();
  sensor.transport.file.path = log + ".not-there";
  EXPECT_EQ(interface(), "");
}

TEST(Config, TheExamplesAreGood) {
  int read = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(IFOG_SOURCE_DIR) + "/daemon/examples")) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW(read_config(entry.path().string())) << entry.path();
    ++read;
  }
  EXPECT_GE(read, 3);
}

}  // namespace
}  // namespace ifog
