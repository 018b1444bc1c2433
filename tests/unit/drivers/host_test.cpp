// SPDX-License-Identifier: Apache-2.0
// Finding, loading and refusing plugins, and refusing options.
#include "tests/unit/drivers/decoded.h"
#include "tests/unit/test.h"

namespace {

namespace fs = std::filesystem;

const std::string kRefused = IFOG_REFUSED_PLUGINS;

std::string refused_plugin(const std::string& name) {
  const std::string line = ifog::refusal(name, {}, {kRefused});
  const std::string path = kRefused + "/" + name + ".so: ";
  return line.starts_with(path) ? line.substr(path.size()) : line;
}

TEST(DriverHost, NamesKeyValueAndExpectation) {
  EXPECT_EQ(ifog::refusal("kvh1750", {{"formt", "a"}}),
            "driver kvh1750: unknown option 'formt' (value 'a'), did you mean 'format'? Known here: format, "
            "angle_unit, output, acceleration, temperature, time_stamp, rate_hz, full_scale");
  EXPECT_EQ(ifog::refusal("kvh1750", {{"format", "d"}}),
            "driver kvh1750: format is 'd', expected one of auto, a, b, c");
  EXPECT_EQ(ifog::refusal("kvh1750", {{"rate_hz", "-3"}}),
            "driver kvh1750: rate_hz is '-3', expected a number > 0, at most 100000");
  EXPECT_EQ(ifog::refusal("kvh1750", {{"rate_hz", "1000x"}}),
            "driver kvh1750: rate_hz is '1000x', expected a number > 0, at most 100000");
  EXPECT_EQ(ifog::refusal("dbc", {}),
            "driver dbc: option 'dbc' is missing, expected a file (Vector DBC file that describes the bus)");
}

TEST(DriverHost, WhatIsNoDriverIsRefused) {
  EXPECT_EQ(refused_plugin("other_version"), "built for interface version 99, this program has version " +
                                                 std::to_string(IFOG_DRIVER_ABI) +
                                                 "; build the plugin against this version");
  EXPECT_EQ(refused_plugin("without_entry"), "is no ifogd plugin: it has no function ifog_driver_entry");
  EXPECT_EQ(refused_plugin("misnamed"), "calls itself 'something_else', expected the name of its file");
  EXPECT_EQ(refused_plugin("without_create"), "its table lacks 'create'");
  EXPECT_EQ(refused_plugin("option_unsaid"), "its table lacks 'values and help of an option'");
  EXPECT_EQ(refused_plugin("too_many_axes"),
            "driver too_many_axes: describes a number of axes outside 1 … 3");
  const std::string twice =
      ": describes a channel or an axis by the name of another, of a rate or of the time: ";
  EXPECT_EQ(refused_plugin("axes_unnamed"), "driver axes_unnamed" + twice + "'rate_radps'");
  EXPECT_EQ(refused_plugin("channel_of_rate"), "driver channel_of_rate" + twice + "'rate_x_radps'");
}

TEST(DriverHost, AMissingDriverIsNamedWithThoseThereAre) {
  const std::string line = ifog::refusal("kvh", {}, {kRefused});
  EXPECT_EQ(line,
            "driver is 'kvh', expected one of: axes_unnamed, channel_of_rate, misnamed, option_unsaid, "
            "other_version, throwing, too_many_axes, without_create, without_entry (looked in " +
                kRefused + ")");
  EXPECT_TRUE(
      ifog::test::has(ifog::refusal("other_verison", {}, {kRefused}), "did you mean 'other_version'?"));
  EXPECT_TRUE(ifog::test::has(ifog::refusal("../plugins/kvh1750", {}), "driver is '../plugins/kvh1750'"));
}

TEST(DriverHost, AFileThatIsNoObjectIsRefusedAndTheListGoesOn) {
  const ifog::test::OwnFolder own;
  own.write("broken.so", "not an object");
  const std::vector<ifog::FoundPlugin> list =
      ifog::list_plugins({own.folder(), std::string(IFOG_BINARY_DIR) + "/plugins"});
  ASSERT_GE(list.size(), 3U);
  EXPECT_EQ(list[0].plugin, nullptr);
  EXPECT_TRUE(ifog::test::has(list[0].refusal, "broken.so: cannot load: "));
  EXPECT_TRUE(std::any_of(list.begin(), list.end(), [](const ifog::FoundPlugin& found) {
    return found.plugin && std::string(found.plugin->table().name) == "kvh1750";
  }));
}

// The linker maps what the headers promise; a cut-off object then ended the program with SIGBUS.
TEST(DriverHost, ACutOffObjectIsRefusedAtEveryLength) {
  const ifog::test::OwnFolder folder;
  const fs::path whole = std::string(IFOG_BINARY_DIR) + "/plugins/kvh1750.so";
  // By half pages down to nothing: the sections at the end of the file are not loaded, all else is. A file of
  // its own each: one that was loaded before may still be mapped.
  int refused = 0;
  for (std::uintmax_t size = fs::file_size(whole); size > 2048; size -= 2048) {
    const fs::path own = folder.path(std::to_string(size));
    fs::create_directories(own);
    fs::copy_file(whole, own / "kvh1750.so");
    fs::resize_file(own / "kvh1750.so", size - 2048);
    const std::string said =
        ifog::test::refusal([&] { (void)ifog::find_plugin("kvh1750", {own.string()}); }, "");
    if (said.empty()) continue;
    EXPECT_TRUE(ifog::test::has(said, "kvh1750.so: cannot load: "));
    ++refused;
  }
  EXPECT_GE(refused, 4);
}

TEST(DriverHost, WhatAnybodyMayWriteIsNotLoaded) {
  const ifog::test::OwnFolder own;
  const fs::path folder = own.folder(), copy = folder / "kvh1750.so";
  fs::copy_file(std::string(IFOG_BINARY_DIR) + "/plugins/kvh1750.so", copy);
  const auto refusal_of = [&] { return ifog::refusal("kvh1750", {}, {folder.string()}); };
  EXPECT_EQ(refusal_of(), "accepted");
  fs::permissions(copy, fs::perms::others_write, fs::perm_options::add);
  EXPECT_EQ(refusal_of(),
            copy.string() + ": anybody may write it, expected a file that only its owner may change");
  fs::permissions(copy, fs::perms::others_write, fs::perm_options::remove);
  fs::permissions(folder, fs::perms::others_write, fs::perm_options::add);
  EXPECT_EQ(refusal_of(),
            copy.string() + ": anybody may write its folder, expected one that only its owner may change");
}

TEST(DriverHost, FoldersOfTheEnvironmentComeBeforeTheBuildTree) {
  setenv("IFOG_PLUGIN_PATH", ("/nowhere/at/all:" + kRefused).c_str(), 1);
  const std::vector<std::string> folders = ifog::plugin_folders({"first"});
  unsetenv("IFOG_PLUGIN_PATH");
  ASSERT_GE(folders.size(), 3U);
  EXPECT_EQ(folders[0], "first");
  EXPECT_EQ(folders[1], kRefused);
  EXPECT_EQ(folders[2], std::string(IFOG_BINARY_DIR) + "/plugins");
}

// A plugin's functions are C and noexcept: what a sink throws would end the program there.
TEST(DriverHost, WhatASinkThrowsComesOutBehindThePlugin) {
  const std::string rows = "time_s,rate_x_radps\n0,1\n1,2\n2,3\n";
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(rows.data()), rows.size());
  ifog::DriverInstance driver = ifog::make_driver("capture", {{"columns", "rate_x_radps"}});
  int taken = 0;
  const auto sink = [&](const ifog_sample&) {
    if (++taken == 2) throw std::runtime_error("the disk is full");
  };
  EXPECT_THROW(driver.decode_bytes(bytes, 0, sink), std::runtime_error);
  EXPECT_EQ(taken, 2) << "a sink that has thrown gets no more";
}

TEST(DriverHost, WhatCannotBeEncodedLeavesNothingBehind) {
  ifog::DriverInstance driver = ifog::make_driver("template", {});
  ifog_sample sample{};
  sample.value[0] = 100.0;
  std::vector<std::uint8_t> bytes{1, 2, 3};
  EXPECT_THROW(driver.encode_bytes(sample, bytes), std::runtime_error);
  EXPECT_EQ(bytes.size(), 3U);
  std::vector<ifog_can_frame> frames;
  EXPECT_THROW(driver.encode_can(sample, frames), std::runtime_error);
}

}  // namespace
