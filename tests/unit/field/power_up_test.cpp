// SPDX-License-Identifier: Apache-2.0
// A warm-up counts from power-up: recordings of several power-ups are not one.
#include <gtest/gtest.h>

#include <string>

#include "drivers/flight/archive.h"
#include "drivers/flight/folder.h"
#include "drivers/transport/clock.h"
#include "tests/unit/own_folder.h"
#include "tools/ifog/field/recorded.h"

namespace ifog::tools {
namespace {

class PoweredRecordings : public testing::Test, protected test::OwnFolder {
 protected:
  PoweredRecordings() {
    sensor_.name = "nose";
    sensor_.record.folder = folder();
  }
  // A closed file of so many bytes, of a sensor that was switched on then.
  void record(std::optional<std::int64_t> powered_ns, std::size_t bytes, const std::string& boot = "") {
    FlightHeader header;
    header.sensor = "nose";
    header.driver = "kvh1750";
    header.powered_ns = powered_ns;
    header.boot = boot;
    FlightArchive archive(make_flight_folder(path("nose")), {}, header);
    std::vector<std::uint8_t> payload(bytes);
    // That no compression makes smaller.
    for (std::uint32_t i = 0; i < bytes; ++i)
      payload[i] = static_cast<std::uint8_t>((i * 2654435761U) >> 13U ^ i * i);
    archive.add({FlightKind::bytes, 0, 0, 0, 1}, payload);
    archive.close(1, realtime_ns());
  }
  [[nodiscard]] std::vector<std::uint64_t> judged() const {
    std::vector<std::uint64_t> out;
    for (const RecordedFile& file : of_one_power_up(recorded_files(sensor_))) out.push_back(file.number);
    return out;
  }
  SensorConfig sensor_;
};

TEST_F(PoweredRecordings, OfSeveralPowerUpsTheLongestIsJudged) {
  constexpr std::int64_t kDay = 86'400'000'000'000;
  record(5 * kDay, 3000);
  record(6 * kDay, 2000);
  record(6 * kDay + 1'000'000'000,
         2500);  // another run of the daemon: its clock is off by what the wall clock was set
  record(7 * kDay, 1000);
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{2, 3}));
  record(7 * kDay, 9000);
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{4, 5}));
}

TEST_F(PoweredRecordings, AComputerWithoutAClockBeginsEveryDayAtTheSameTime) {
  constexpr std::int64_t kDay = 86'400'000'000'000;
  record(kDay, 2500, "one");
  record(kDay, 2000, "other");
  record(kDay + 1'000'000'000, 2000, "other");
  record(kDay, 3000, "third");
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{2, 3}));
}

TEST_F(PoweredRecordings, AllAreWhereNobodySaysWhenItWas) {
  record(std::nullopt, 100);
  record(std::nullopt, 2000);
  record(std::nullopt, 100);
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{1, 2, 3}));
}

}  // namespace
}  // namespace ifog::tools
