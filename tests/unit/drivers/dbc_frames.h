// SPDX-License-Identifier: Apache-2.0
// Frames of a bus, the samples that the driver `dbc` makes of them, and DBC files of a test's own.
#pragma once

#include "drivers/host/driver_instance.h"
#include "tests/unit/test.h"

namespace ifog {

inline const std::string kDbcExamples = std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/";

inline ifog_can_frame frame(std::uint32_t id, std::initializer_list<int> bytes, std::int64_t arrival_ns = 0) {
  ifog_can_frame f{};
  f.id = id;
  f.arrival_ns = arrival_ns;
  for (const int byte : bytes) f.data[f.length++] = static_cast<std::uint8_t>(byte);
  return f;
}

// A frame of ifogd_gyro.dbc, put together here byte by byte: little-endian float, 16-bit counter, status.
inline ifog_can_frame axis_frame(std::uint32_t id, float rate, std::uint16_t counter,
                                 std::uint8_t status = 0) {
  const auto bits = std::bit_cast<std::uint32_t>(rate);
  return frame(id, {static_cast<int>(bits & 0xFF), static_cast<int>(bits >> 8 & 0xFF),
                    static_cast<int>(bits >> 16 & 0xFF), static_cast<int>(bits >> 24), counter & 0xFF,
                    counter >> 8, status, 0});
}

// A sensor of three axes by that file, with the counter or other settings.
inline DriverInstance three_axes(const DriverSettings& more = {{"counter", "Counter"}}) {
  DriverSettings settings{
      {"dbc", kDbcExamples + "ifogd_gyro.dbc"}, {"x", "Rate_x"}, {"y", "Rate_y"}, {"z", "Rate_Z.Rate_z"}};
  settings.insert(more.begin(), more.end());
  return make_driver("dbc", settings);
}

inline std::vector<ifog_sample> decode(DriverInstance& driver, const std::vector<ifog_can_frame>& frames) {
  std::vector<ifog_sample> samples;
  for (const ifog_can_frame& f : frames)
    driver.decode_can(f, [&](const ifog_sample& sample) { samples.push_back(sample); });
  return samples;
}

// A DBC file that a test writes.
class DbcText : public testing::Test, protected test::OwnFolder {
 protected:
  DriverInstance driver(const std::string& text, DriverSettings settings) {
    write("bus.dbc", text);
    settings["dbc"] = path("bus.dbc");
    return make_driver("dbc", settings);
  }
  std::string refusal(const std::string& text, const DriverSettings& settings) {
    std::string what = test::refusal([&] { driver(text, settings); });
    const std::string file = path("bus.dbc");
    for (std::size_t at = what.find(file); at != std::string::npos; at = what.find(file))
      what.replace(at, file.size(), "F");
    return what;
  }
};

}  // namespace ifog
