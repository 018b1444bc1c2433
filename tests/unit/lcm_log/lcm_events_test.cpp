// SPDX-License-Identifier: Apache-2.0
#include <lcm/lcm-cpp.hpp>

#include "tests/unit/test.h"
#include "tools/ifog/captures/lcm/lcm_events.h"

namespace ifog::tools {
namespace {

// A log as LCM writes it, then damaged.
class DamagedLog : public testing::Test, protected test::OwnFolder {
 protected:
  static constexpr int kEvents = 12;
  static constexpr std::size_t kData = 300;

  void SetUp() override {
    {
      lcm::LogFile log(path_, "w");
      for (int n = 0; n < kEvents; ++n) {
        std::vector<std::uint8_t> data(kData, static_cast<std::uint8_t>(n));
        lcm::LogEvent event{};
        event.timestamp = 1000 * n;
        event.channel = "NOSE";
        event.datalen = static_cast<int>(data.size());
        event.data = data.data();
        ASSERT_EQ(log.writeEvent(&event), 0);
      }
    }
    whole_ = content("log");
    event_ = whole_.size() / kEvents;
  }

  struct Found {
    std::vector<int> events;
    std::size_t damaged = 0, places = 0, first_place = 0, behind = 0;
  };
  // These bytes instead of so many at `at`.
  Found with(std::size_t at, const std::string& bytes, std::size_t instead_of) const {
    std::string damaged = whole_;
    write("log", damaged.replace(at, instead_of, bytes));
    LcmEvents log(path_);
    Found found;
    while (const LcmEvents::Event* event = log.next()) {
      found.events.push_back(static_cast<int>(event->timestamp_us / 1000));
      EXPECT_EQ(event->channel, "NOSE");
      EXPECT_EQ(std::vector(event->data.begin(), event->data.end()),
                std::vector<std::uint8_t>(kData, static_cast<std::uint8_t>(found.events.back())));
    }
    found.damaged = log.damaged();
    found.places = log.places();
    found.first_place = log.first_place();
    found.behind = log.size() - log.at();
    return found;
  }
  // All but these.
  static std::vector<int> without(std::vector<int> lost) {
    std::vector<int> all(kEvents);
    std::iota(all.begin(), all.end(), 0);
    std::erase_if(all, [&](int n) { return std::find(lost.begin(), lost.end(), n) != lost.end(); });
    return all;
  }

  const std::string path_ = path("log");
  std::string whole_;
  std::size_t event_ = 0;
};

TEST_F(DamagedLog, AWholeOneIsReadWhole) {
  const Found found = with(0, "", 0);
  EXPECT_EQ(found.events, without({}));
  EXPECT_EQ(found.places + found.damaged + found.behind, 0U);
  EXPECT_THROW(LcmEvents("/nowhere/at.lcm"), std::runtime_error);
}

// LCM's reader ends at the first of these, or takes a length of 2 GB or less than nothing for what it says.
TEST_F(DamagedLog, ALengthThatCannotBeCostsItsEvent) {
  for (const std::size_t length : {20UL, 24UL})  // of the channel's name, of the data
    for (const std::string& bytes :
         {std::string(4, '\xFF'), std::string("\x7F\xFF\xFF\xFF", 4), std::string("\0\0\0\x21", 4),
          std::string("\0\0\2\0", 4), std::string(4, '\0')}) {
      const Found found = with(5 * event_ + length, bytes, 4);
      EXPECT_EQ(found.events, without({5})) << length;
      EXPECT_EQ(found.places, 1U) << length;
      EXPECT_EQ(found.damaged, event_) << length;
      EXPECT_EQ(found.first_place, 5 * event_) << length;
    }
}

// An event followed by foreign bytes cannot be distinguished from a truncated one, and is dropped with them.
TEST_F(DamagedLog, BytesThatCameBetweenAndBytesThatAreLost) {
  const std::string junk(100'000, 'j');
  Found found = with(7 * event_, junk, 0);
  EXPECT_EQ(found.events, without({6}));
  EXPECT_EQ(found.damaged, event_ + junk.size());
  EXPECT_EQ(found.first_place, 6 * event_);
  found = with(3 * event_, "\xED\xA1\xDA\x02", 4);
  EXPECT_EQ(found.events, without({2, 3}));
  EXPECT_EQ(found.damaged, 2 * event_);
  found = with(4 * event_ + 40, "", 60);
  EXPECT_EQ(found.events, without({4}));
  EXPECT_EQ(found.damaged, event_ - 60);
  found = with(0, "\1\2", 0);
  EXPECT_EQ(found.events, without({}));
  EXPECT_EQ(found.damaged, 2U);
}

TEST_F(DamagedLog, TheEndIsNoDamage) {
  for (const std::size_t left : {2UL, 30UL, event_ - 1}) {
    const Found found = with(11 * event_ + left, "", event_ - left);
    EXPECT_EQ(found.events, without({11})) << left;
    EXPECT_EQ(found.places, 0U) << left;
    EXPECT_EQ(found.behind, left);
  }
}

}  // namespace
}  // namespace ifog::tools
