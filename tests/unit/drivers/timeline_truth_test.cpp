// SPDX-License-Identifier: Apache-2.0
// The truth table of device time: what happens on a line or bus, and what the daemon's chain must make of it.
// The making of each stream knows when every sample was taken, and is the oracle.
#include "daemon/sensor/facts.h"
#include "filters/chain/incrementer.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

enum class Event {
  none,
  off_and_on,   // silent for `seconds`; counter and clock begin at 0 again
  unplugged,    // likewise, and the device counts on
  paused,       // likewise, and its clock runs on but not its counter
  recounted,    // likewise, its counter begins at 0 again and its clock (of GNSS) runs on
  held_up,      // nothing is delivered for so long, then all at once
  early_stamp,  // one time of arrival is so much too early
  late_stamp,   // or too late
  late_stamps,  // one in seven is
  clock_set,    // the device's clock is set by so much
  wall_set,     // the wall clock, which stamps the arrivals in a log, is set by so much
  twice,        // every 40th frame comes a second time
  exchanged,    // every 40th changes places with the next
  lost,         // every 40th is lost
  stray_count,  // one counter is damaged
  second_device
};

struct Case {
  const char* name;
  std::uint32_t modulus;
  double rate_hz;
  Event event;
  double seconds = 0.0;
  std::int64_t tick_ns = 0;   // of the device's clock; 0: it has none
  std::int64_t wrap_ns = 0;   // it rolls over after this; 0: never
  double portion_s = 0.0;     // deliveries come so often
  bool recorded = false;      // arrivals are the stamps of a log
  double dt_doubt_s = 0.002;  // of the step over the event
  double label_doubt_s = 0.02;
  std::uint64_t restarts = 0;
  bool arrivals = true;  // false: a file of bytes
};

std::ostream& operator<<(std::ostream& out, const Case& one) { return out << one.name; }

constexpr double kBefore_s = 20.0, kAfter_s = 10.0;
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

struct Sent {
  double taken_s = 0.0, arrives_s = 0.0;  // when it came, and what the log says of it
  double stamped_s = 0.0, clock_s = 0.0, wall_set_s = 0.0;
  std::uint64_t count = 0;
  std::uint32_t at_once = 1;  // samples in its delivery
  bool first_again = false;   // the first behind the event
  bool surplus = false;       // must not be taken
};

std::vector<Sent> frames_of(const Case& one) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter_s(0.0, 5e-4);
  std::vector<Sent> out;
  const double period_s = 1.0 / one.rate_hz;
  const bool paused = one.event == Event::paused;
  const bool silent = paused || one.event == Event::off_and_on || one.event == Event::unplugged ||
                      one.event == Event::recounted;
  const auto before = static_cast<std::uint64_t>(kBefore_s * one.rate_hz);
  const auto dark = silent ? static_cast<std::uint64_t>(std::llround(one.seconds * one.rate_hz)) : 0;
  const auto all = before + dark + static_cast<std::uint64_t>(kAfter_s * one.rate_hz);
  for (std::uint64_t n = 0; n < all; ++n) {
    if (n >= before && n < before + dark) continue;
    Sent sent;
    sent.taken_s = static_cast<double>(n) * period_s;
    const bool again = one.event == Event::off_and_on && n >= before;
    sent.count = again || (one.event == Event::recounted && n >= before) ? n - before - dark
                 : paused && n >= before                                 ? n - dark + 77
                                                                         : n + 77;
    sent.clock_s = again ? static_cast<double>(n - before - dark) * period_s : 300.0 + sent.taken_s;
    if (one.event == Event::clock_set && n >= before) sent.clock_s += one.seconds;
    sent.first_again = n == before + dark;
    sent.arrives_s = sent.taken_s + jitter_s(random);
    if (one.portion_s > 0.0) sent.arrives_s = std::ceil(sent.taken_s / one.portion_s) * one.portion_s;
    const double held_until_s = kBefore_s + one.seconds;
    if (one.event == Event::held_up && n >= before && sent.arrives_s < held_until_s)
      sent.arrives_s = held_until_s + 1e-5 * static_cast<double>(n - before);
    sent.stamped_s = sent.arrives_s;
    if (one.event == Event::early_stamp && n == before) sent.stamped_s -= one.seconds;
    if (one.event == Event::late_stamp && n == before) sent.stamped_s += one.seconds;
    if (one.event == Event::late_stamps && n % 7 == 3) sent.stamped_s += one.seconds;
    if (one.event == Event::wall_set && n >= before) sent.wall_set_s = one.seconds;
    if (one.event == Event::stray_count && n == before) sent.count += 55;
    const bool now = n > 100 && n % 40 == 7;
    if (now && one.event == Event::lost) continue;
    out.push_back(sent);
    if (now && one.event == Event::twice) {
      out.push_back(sent);
      out.back().surplus = true;
    }
    if (n > 101 && n % 40 == 8 && one.event == Event::exchanged) {
      std::swap(out[out.size() - 1], out[out.size() - 2]);
      std::swap(out[out.size() - 1].stamped_s, out[out.size() - 2].stamped_s);
      out.back().surplus = true;
    }
    if (one.event == Event::second_device && n >= before) {
      sent.count = n + 5000;
      sent.surplus = true;
      out.push_back(sent);
    }
  }
  std::map<double, std::uint32_t> delivered;
  for (const Sent& sent : out) ++delivered[sent.arrives_s];
  for (Sent& sent : out) sent.at_once = delivered[sent.arrives_s];
  return out;
}

Reading reading_of(const Case& one, const Sent& sent, double value) {
  Reading reading;
  const double in_log_s = one.recorded ? sent.wall_set_s : 0.0;
  if (one.arrivals) reading.arrival_ns = kStart_ns + std::llround((sent.stamped_s + in_log_s) * 1e9);
  reading.wall_shift_ns = std::llround((sent.wall_set_s - in_log_s) * 1e9);
  reading.arrival_recorded = one.recorded;
  reading.valid_axes = 1;
  reading.value[0] = value;
  reading.has_sequence = one.modulus > 0;
  reading.sequence = one.modulus > 0 ? static_cast<std::uint32_t>(sent.count % one.modulus) : 0;
  if (one.tick_ns > 0) {
    std::int64_t stamp_ns = std::llround(sent.clock_s * 1e9) / one.tick_ns * one.tick_ns;
    if (one.wrap_ns > 0) stamp_ns %= one.wrap_ns;
    reading.device_time_ns = stamp_ns;
    reading.device_wrap_ns = one.wrap_ns;
  }
  reading.at_once = sent.at_once;
  return reading;
}

class TimelineTruth : public testing::TestWithParam<Case> {};

TEST_P(TimelineTruth, EachFrameHasItsTimeAndNoOther) {
  const Case& one = GetParam();
  ifog_description description{};
  description.axes = 1;
  description.sequence_modulus = one.modulus;
  description.has_device_time = one.tick_ns > 0 ? 1 : 0;
  description.nominal_rate_hz = one.rate_hz;
  Incrementer chain(sensor_facts(description, 0.0, 0));
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.1, 1e-3);
  double told_s = 0.0, last_s = 0.0, worst_label_s = 0.0, worst_dt_s = 0.0;
  std::uint64_t flagged = 0, wrongly_taken = 0, wrongly_left = 0;
  bool event_flagged = false;
  double since_event_s = 0.0;
  const std::vector<Sent> all = frames_of(one);
  double value = 0.0, latest_s = 0.0;
  for (const Sent& sent : all) {
    if (!sent.surplus || one.event != Event::twice) value = noise(random);
    Increment increment;
    latest_s = std::max(latest_s, sent.taken_s);
    const bool taken = chain.next(reading_of(one, sent, value), increment);
    if (one.event == Event::second_device) continue;
    wrongly_taken += taken && sent.surplus ? 1 : 0;
    wrongly_left += !taken && !sent.surplus ? 1 : 0;
    if (!taken) continue;
    told_s += increment.dt_s;
    flagged += (increment.flags & kClockStep) != 0 ? 1 : 0;
    if (sent.first_again) {
      event_flagged = (increment.flags & kGapBefore) != 0;
      since_event_s = increment.dt_s - (sent.taken_s - last_s);
    } else {
      worst_dt_s = std::max(worst_dt_s, std::abs(increment.dt_s - (sent.taken_s - last_s)));
    }
    const double label_s = static_cast<double>(increment.utime_ns - kStart_ns) * 1e-9 - sent.wall_set_s;
    const bool of_a_set_log = one.recorded && one.event == Event::wall_set;
    if (one.arrivals && sent.taken_s > 2.0 && sent.stamped_s == sent.arrives_s && !of_a_set_log)
      worst_label_s = std::max(worst_label_s, std::abs(label_s - sent.taken_s));
    last_s = sent.taken_s;
  }
  const IncrementerCounts& counts = chain.counts();
  if (one.event == Event::second_device) {
    EXPECT_TRUE(chain.mixed());
    EXPECT_LT(static_cast<double>(counts.samples), (kBefore_s + 1.0) * one.rate_hz);
    return;
  }
  const double period_s = 1.0 / one.rate_hz;
  const auto missing = static_cast<double>(
      all.empty() ? 0 : std::llround(latest_s * one.rate_hz) + 1 - static_cast<std::int64_t>(counts.samples));
  EXPECT_EQ(wrongly_taken, 0U);
  EXPECT_EQ(wrongly_left, one.event == Event::stray_count ? 1U : 0U);
  EXPECT_NEAR(told_s, latest_s + period_s, one.dt_doubt_s + 0.002);
  EXPECT_NEAR(since_event_s, 0.0, one.dt_doubt_s);
  EXPECT_LE(worst_dt_s, 1.01 * period_s + 2e-9 * static_cast<double>(one.tick_ns));
  EXPECT_NEAR(static_cast<double>(counts.missing), missing, 2.0 + one.dt_doubt_s * one.rate_hz);
  EXPECT_EQ(counts.restarts, one.restarts);
  const bool silent = one.event == Event::off_and_on || one.event == Event::unplugged ||
                      one.event == Event::paused || one.event == Event::recounted;
  EXPECT_EQ(event_flagged, silent);
  EXPECT_EQ(flagged, one.event == Event::wall_set ? 1U : 0U);
  EXPECT_EQ(counts.sensor_clock_sets, one.event == Event::clock_set ? 1U : 0U);
  EXPECT_LE(worst_label_s, one.label_doubt_s + one.portion_s + period_s);
  EXPECT_FALSE(chain.mixed());
}

constexpr std::int64_t kHour71_ns = 4'294'967'296'000;
constexpr Case kCases[] = {
    {"InPortionsOf16ms", 128, 1000.0, Event::none, 0.0, 0, 0, 0.016},
    // A gyro that is switched off and on: no counter tells how long, the elapsed time does.
    {"OffFor10s7At100Hz", 128, 100.0, Event::off_and_on, 10.7, 0, 0, 0.0, false, 0.03, 0.03, 1},
    {"OffFor6sAt20Hz", 128, 20.0, Event::off_and_on, 6.0, 0, 0, 0.0, false, 0.1, 0.1, 1},
    {"OffAndOnInAFileOfBytes", 128, 200.0, Event::off_and_on, 0.0, 1000, kHour71_ns, 0.0, false, 0.01, 0.0, 1,
     false},
    {"PausedFor10sWithAClock", 65536, 200.0, Event::paused, 10.0, 1000, kHour71_ns},
    {"OffFor3600sOfALog", 65536, 200.0, Event::off_and_on, 3600.0, 0, 0, 0.0, true, 0.02, 0.02, 1},
    {"OffFor10s7WithAClock", 128, 1000.0, Event::off_and_on, 10.7, 1000, kHour71_ns, 0.0, false, 0.01, 0.01,
     1},
    {"OffFor10s7WithAClockAlone", 0, 200.0, Event::off_and_on, 10.7, 1000, 0, 0.0, false, 0.02, 0.02, 1},
    {"OffFor10s7WithNeither", 0, 100.0, Event::off_and_on, 10.7, 0, 0, 0.0, false, 0.03, 0.03, 0},
    // Signals of 16 bits on a CAN bus: a round of the counter is longer than one of the clock.
    {"OffFor10s7WithAClockThatRunsOn", 65536, 200.0, Event::recounted, 10.7, 1'000'000, 65'536'000'000},
    // A cable that is pulled: the device counts on.
    {"UnpluggedFor0s7", 128, 1000.0, Event::unplugged, 0.7},
    {"UnpluggedFor10s", 128, 1000.0, Event::unplugged, 10.0},
    // A round of the counter is not much longer than what a USB adapter collects.
    {"UnpluggedFor10sAt5kHzInPortionsOf16ms", 128, 5000.0, Event::unplugged, 10.001, 0, 0, 0.016},
    {"UnpluggedFor3HoursWithAClock", 128, 200.0, Event::unplugged, 10800.0, 1000, kHour71_ns},
    // Deliveries that stall lose nothing.
    {"HeldUpFor3s", 128, 1000.0, Event::held_up, 3.0},
    {"HeldUpFor1sWithNeither", 0, 100.0, Event::held_up, 1.0, 0, 0, 0.0, false, 0.01},
    {"HeldUpFor3sWithAClock", 128, 1000.0, Event::held_up, 3.0, 1000, kHour71_ns},
    // One stamp moves its own label alone.
    {"OneStamp6sEarly", 65536, 200.0, Event::early_stamp, 6.0, 0, 0, 0.0, true},
    {"OneStamp6sLate", 65536, 200.0, Event::late_stamp, 6.0, 0, 0, 0.0, true},
    {"OneStampInSevenLate", 65536, 200.0, Event::late_stamps, 0.3, 0, 0, 0.0, true},
    {"TheClockOfALogIsSet", 65536, 200.0, Event::wall_set, 3600.0, 0, 0, 0.0, true},
    {"TheWallClockIsSetBackWithNeither", 0, 1000.0, Event::wall_set, -5.0},
    {"TheDevicesClockIsSet", 128, 200.0, Event::clock_set, 36000.0, 1000},
    {"TheDevicesClockIsSetBy40msInPortions", 65536, 200.0, Event::clock_set, 0.04, 1000, 0, 0.016},
    {"TheDevicesClockIsSetBack", 65536, 200.0, Event::clock_set, -5.0, 1000},
    {"FramesComeTwice", 128, 1000.0, Event::twice},
    {"FramesAreExchanged", 16, 200.0, Event::exchanged},
    {"FramesAreLost", 16, 200.0, Event::lost, 0.0, 0, 0, 0.0, false, 0.002},
    {"OneCounterIsDamaged", 65536, 200.0, Event::stray_count},
    {"TwoDevices", 128, 200.0, Event::second_device},
};
static_assert(std::size(kCases) <= 30);

INSTANTIATE_TEST_SUITE_P(Cases, TimelineTruth, testing::ValuesIn(kCases),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace ifog
