// SPDX-License-Identifier: Apache-2.0
// What `ifog monitor` shows of a sensor, at any width; and messages as JSON.
#include <ifog/rate_t.hpp>
#include <ifog/status_t.hpp>
#include <nlohmann/json.hpp>

#include "msgs/counters.h"
#include "tests/unit/test.h"
#include "tools/ifog/monitor/message_json.h"
#include "tools/ifog/monitor/sensor_view.h"
#include "tools/report/text.h"

namespace ifog::tools {
namespace {

rate_t rate(std::int64_t seq, std::vector<double> denoised) {
  rate_t out{};
  out.seq = seq;
  out.axes = static_cast<std::int8_t>(denoised.size());
  for (auto* field : {&out.compensated, &out.variance, &out.delta_theta, &out.covered, &out.angle,
                      &out.innovation, &out.innovation_variance, &out.gain})
    field->assign(denoised.size(), 0.0);
  out.raw = out.denoised = std::move(denoised);
  return out;
}

status_t status_message() {
  status_t out{};
  out.state = status_t::STATE_RUNNING;
  out.axes = 3;
  out.nis_mean = {1.0, 1.01, 0.99};
  out.whiteness = {0.0, 0.01, -0.02};
  out.measurement_noise = {1.0, 1.0, 1.0};
  out.bytes_read = out.bytes_framed = 1'234'567'890'123;
  out.samples_in = out.samples_published = 34'293'552'503;
  out.fault = "the device is gone: /dev/serial/by-id/usb-FTDI_FT232R_USB_UART_A9048XYZ-if00-port0";
  out.channels = 3;
  out.channel_name = {"coil_degC", "supply_V", "hull\x1b[2J"};
  out.channel_value = {25.0, 12.0, 1.0};
  out.channel_age_s = {0.1, 5.0, std::numeric_limits<double>::infinity()};
  return out;
}

std::string joined(const std::vector<ShownLine>& lines) {
  std::string out;
  for (const ShownLine& line : lines) out += line.text + "\n";
  return out;
}

TEST(MonitorView, FiguresOfASecondAreThoseOfItsMessages) {
  SensorView view;
  // Mean 2, deviation sqrt(((-1)^2 + 0 + 1)/2) = 1, times 1e-6 rad/s = 0.2063 °/h.
  for (int i = 0; i < 3; ++i) view.take(rate(i, {1e-6 * (1 + i), 0.0, std::nan("")}));
  view.end_interval(1.5);
  ASSERT_EQ(view.axes().size(), 3U);
  EXPECT_DOUBLE_EQ(view.message_rate_hz(), 2.0);
  EXPECT_NEAR(view.axes()[0].rate_radps, 2e-6, 1e-18);
  EXPECT_NEAR(view.axes()[0].noise_radps, 1e-6, 1e-18);
  EXPECT_TRUE(std::isnan(view.axes()[2].rate_radps));
  const std::string text = joined(view_lines("NOSE", view, {}));
  EXPECT_TRUE(ifog::test::has(text, "  x  +0.4125 °/h  noise 0.2063 (raw 0.2063)  angle +0.000000°"));
  EXPECT_TRUE(ifog::test::has(text, "  y  "));
  EXPECT_TRUE(ifog::test::has(text, "  z  "));
  EXPECT_TRUE(ifog::test::has(text, "nothing lost"));
  view.end_interval(1.0);
  EXPECT_TRUE(view.axes().empty());
}

// A daemon that was killed says nothing of its end, and an axis that is not there is no fault.
TEST(MonitorView, WhatIsStaleOrAbsentIsNotShownAsLive) {
  SensorView view;
  view.take(rate(0, {1e-6, std::nan("")}));
  view.take(status_message());
  view.end_interval(1.0);
  std::string text = joined(view_lines("NOSE", view, {}));
  EXPECT_TRUE(ifog::test::has(text, "running"));
  EXPECT_TRUE(ifog::test::has(text, "  y  not measured"));
  for (int second = 0; second < 6; ++second) view.end_interval(1.0);
  text = joined(view_lines("NOSE", view, {}));
  EXPECT_FALSE(ifog::test::has(text, "running")) << text;
  EXPECT_FALSE(ifog::test::has(text, "nothing lost")) << text;
  EXPECT_TRUE(ifog::test::has(text, "no message for 6 s"));
}

TEST(MonitorView, FlagsAndLossesInWords) {
  SensorView view;
  rate_t message = rate(10, {0.0});
  message.flags = 8192 + 4;  // at rest, stale channel
  view.take(message);
  view.take(rate(14, {0.0}));  // 11 to 13 were lost on the way
  status_t health = status_message();
  health.frames_crc = 7;
  view.take(health);
  view.end_interval(1.0);
  std::string text = joined(view_lines("NOSE", view, {}));
  for (const char* part :
       {"at rest 1", "channel stale 1", "lost on LCM 3", "frames with a wrong checksum 7", "  rate  "})
    EXPECT_TRUE(ifog::test::has(text, part)) << part << " is not in\n" << text;
  view.forget_losses();
  health.frames_crc = 9;
  view.take(health);
  text = joined(view_lines("NOSE", view, {}));
  EXPECT_FALSE(ifog::test::has(text, "lost on LCM")) << text;
  EXPECT_TRUE(ifog::test::has(text, "frames with a wrong checksum 2"));
}

TEST(MonitorView, NoLineIsWiderThanTheScreen) {
  SensorView view;
  for (int i = 0; i < 200; ++i) {
    view.take(rate(i, {1e-5 * i, -3.0, 1e-9}));
    view.end_interval(1.0);
  }
  view.take(status_message());
  for (std::size_t width = 60; width < 200; ++width)
    for (const RateUnit unit :
         {RateUnit::automatic, RateUnit::degree_per_hour, RateUnit::radian_per_second}) {
      const auto lines = view_lines("NOSE", view, {width, true, unit});
      ASSERT_GT(lines.size(), 8U);
      for (const auto& [line, tone] : lines) {
        const bool cut = line.find("angle") != std::string::npos;
        EXPECT_LE(report::characters_in(line), cut ? width : std::max<std::size_t>(width, 95)) << line;
        EXPECT_FALSE(ifog::test::has(line, "\x1b"));
      }
    }
  const auto wide = view_lines("NOSE", view, {200, true, RateUnit::automatic});
  EXPECT_TRUE(ifog::test::has(wide[1].text, "▁"));
  EXPECT_TRUE(ifog::test::has(wide[1].text, "█"));
}

// Rates without the statuses that belong to them: what the last one said is not of now.
TEST(MonitorView, AnOldStatusIsNotShownWithNewRates) {
  SensorView view;
  view.take(status_message());
  for (int second = 0; second < 5; ++second) {
    view.take(rate(second, {1e-6}));
    view.end_interval(1.0);
  }
  const auto lines = view_lines("NOSE", view, {});
  const std::string text = joined(lines);
  EXPECT_TRUE(test::has(text, "no status for 4 s")) << text;
  for (const char* old : {"running", "nothing lost", "fault", "NIS", "books", "coil_degC"})
    EXPECT_FALSE(test::has(text, old)) << old << " is in\n" << text;
  EXPECT_EQ(lines[0].tone, Tone::warning);
}

TEST(MonitorJson, EveryFieldByTheNameOfItsType) {
  rate_t message = rate(41, {1.5, std::nan(""), -2.0});
  message.flags = 1 + 32;  // gap, invalid
  message.model = "\xff\x1b";
  const auto json = nlohmann::json::parse(message_json("NOSE", message));
  EXPECT_EQ(json["sensor"], "NOSE");
  EXPECT_EQ(json["type"], "rate");
  EXPECT_EQ(json["seq"], 41);
  EXPECT_EQ(json["flag_words"], nlohmann::json({"gap", "invalid"}));
  EXPECT_EQ(json["raw"][0], 1.5);
  EXPECT_TRUE(json["raw"][1].is_null());
  const std::string line = message_json("NOSE", status_message());
  EXPECT_FALSE(ifog::test::has(line, "\n"));
  const auto health = nlohmann::json::parse(line);
  EXPECT_EQ(health["state_name"], "running");
  EXPECT_EQ(health["channel_name"][1], "supply_V");
  EXPECT_EQ(health["bytes_read"], 1'234'567'890'123);
}

}  // namespace
}  // namespace ifog::tools

// The list of counters against the message's own definition.

TEST(StatusCounters, AreThoseOfTheMessageInItsOrder) {
  std::ifstream file(IFOG_SOURCE_DIR "/msgs/status_t.lcm");
  std::vector<std::string> defined;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string type, name;
    words >> type >> name;
    if (type == "int64_t" && name != "utime;" && name != "model_since;")
      defined.push_back(name.substr(0, name.find(';')));
  }
  ASSERT_GT(defined.size(), 40U);
  std::vector<std::string> listed;
  ifog::status_t message{};
  std::int64_t value = 0;
  for (const ifog::StatusCounter& each : ifog::kStatusCounters) {
    listed.emplace_back(each.name);
    message.*each.count = ++value;
  }
  EXPECT_EQ(listed, defined);
  // Each is a field of its own.
  value = 0;
  for (const ifog::StatusCounter& each : ifog::kStatusCounters)
    EXPECT_EQ(message.*each.count, ++value) << each.name;
}
