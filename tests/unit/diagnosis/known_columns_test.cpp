// SPDX-License-Identifier: Apache-2.0
// What one axis worked out of the sensor's channels is taken for the others, and of no other column.
#include "filters/diagnosis/record/known_columns.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "filters/diagnosis/cleaning/prepared_records.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {
namespace {

TEST(KnownColumns, AreWorkedOutOnceByWhatIsAsked) {
  const std::vector<double> column{1.0, 2.0}, other{3.0, 4.0};
  KnownColumns known;
  known.add(column);
  std::atomic<int> worked = 0;
  const auto ask = [&](const KnownColumns::Asked& asked, double value) {
    return *known.of(asked, [&] {
      ++worked;
      return value;
    });
  };
  EXPECT_EQ(ask({"mean", column}, 1.5), 1.5);
  EXPECT_EQ(ask({"mean", column}, 7.0), 1.5);
  EXPECT_EQ(ask({"least", column}, 1.0), 1.0);
  EXPECT_EQ(ask({"mean", column, 0.5}, 2.0), 2.0);
  EXPECT_EQ(ask({"mean", column, 0.5, 3}, 3.0), 3.0);
  EXPECT_EQ(worked, 4);
  // Not one of them: its memory may be another's tomorrow.
  EXPECT_EQ(ask({"mean", other}, 3.5), 3.5);
  EXPECT_EQ(ask({"mean", other}, 3.6), 3.6);
  EXPECT_EQ(ask({"mean", std::span(column).first(1)}, 1.0), 1.0);
  EXPECT_EQ(worked, 7);
  EXPECT_EQ(*known_or(nullptr, {"mean", column}, [] { return 8.0; }), 8.0);
  const auto fails = [&] {
    return known.of({"fails", column}, []() -> int { throw std::runtime_error("no"); });
  };
  EXPECT_THROW(fails(), std::runtime_error);
  EXPECT_EQ(*known.of({"fails", column}, [] { return 9; }), 9);
}

TEST(KnownColumns, WhoPreparesDoesNotWait) {
  const std::vector<double> column{1.0}, other{2.0};
  KnownColumns known;
  known.add(column);
  int worked = 0;
  const auto work = [&] { return ++worked; };
  known.prepare({"times", other}, work);  // none of them
  EXPECT_EQ(worked, 0);
  known.prepare({"times", column}, work);
  known.prepare({"times", column}, work);
  EXPECT_EQ(*known.of({"times", column}, work), 1);
  // While one is at work the other goes on without it.
  const int found = *known.of({"slow", column}, [&] {
    std::thread([&] { known.prepare({"slow", column}, work); }).join();
    return 7;
  });
  EXPECT_EQ(found, 7);
  EXPECT_EQ(worked, 1);
}

TEST(KnownColumns, SeveralThreadsAskAtOnce) {
  const std::vector<double> column{1.0};
  KnownColumns known;
  known.add(column);
  std::atomic<int> worked = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (std::size_t i = 0; i < 100; ++i)
        EXPECT_EQ(*known.of({"times", column, 0.0, i},
                            [&] {
                              ++worked;
                              return i;
                            }),
                  i);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(worked, 100);
}

struct Sensor {
  std::vector<double> time, x, y, temperature, supply;

  Sensor() {
    std::mt19937_64 draw(31);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < 30000; ++i) {
      time.push_back(0.01 * static_cast<double>(i));
      x.push_back(1e-6 * normal(draw) + (i >= 12000 && i < 12600 ? 0.1 : 0.0));  // turned
      y.push_back(1e-6 * normal(draw));
      temperature.push_back(25.0 + 1e-3 * time.back() + 1e-3 * normal(draw));
      supply.push_back(5.0 + 1e-3 * normal(draw));
    }
    x[500] = 1e-1;  // a knock of one of them
    temperature[7] = std::nan("");
  }

  [[nodiscard]] std::vector<Record> of(bool axis_y) const {
    Record record;
    record.name = "made";
    record.time_s = time;
    record.rate_radps = axis_y ? y : x;
    record.channels = {{"temperature_degC", temperature}, {"supply_V", supply}};
    record.other_axes = {axis_y ? RecordChannel{"rate_x_radps", x} : RecordChannel{"rate_y_radps", y}};
    return {record};
  }
};

TEST(KnownColumns, GiveEachAxisWhatItHadByItself) {
  const Sensor sensor;
  const std::vector<Record> of_x = sensor.of(false);
  const PreparedChannels channels(of_x);
  for (const bool axis_y : {false, true, true}) {
    const std::vector<Record> captures = sensor.of(axis_y);
    const PreparedRecords shared(captures, {}, 0.01, &channels), own(captures);
    const Record &one = shared.whole().front(), &other = own.whole().front();
    ASSERT_EQ(one.at_rest.size(), other.at_rest.size());
    ASSERT_EQ(one.at_rest.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(one.at_rest[i].begin, other.at_rest[i].begin);
      EXPECT_EQ(one.at_rest[i].end, other.at_rest[i].end);
    }
    Record alone = other;
    alone.known = nullptr;
    const BlockData found = cut_to_blocks({one}), expected = cut_to_blocks({alone});
    EXPECT_EQ(found.grid.error, expected.grid.error);
    EXPECT_EQ(found.grid.valid, expected.grid.valid);
    ASSERT_EQ(found.channels.size(), 2U);
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_EQ(found.channels[c].values, expected.channels[c].values);
      EXPECT_EQ(found.channels[c].power, expected.channels[c].power);
    }
  }
}

}  // namespace
}  // namespace ifog
