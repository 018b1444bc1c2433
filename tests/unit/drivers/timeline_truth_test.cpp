// SPDX-License-Identifier: Apache-2.0
// Counters of every width, with a clock and without, values that repeat and that do not, in every pattern of
// arrival, undisturbed and disturbed: each frame is judged as the making of the stream knows it, by the
// daemon's chain and by a reader of recordings alike.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "daemon/sensor/facts.h"
#include "drivers/capture/capture_builder.h"
#include "filters/chain/incrementer.h"

namespace ifog {
namespace {

enum class Comes { one_by_one, in_twos, in_fours, in_eights, untimed, every_16_ms };
enum class Trouble { none, lost, twice, exchanged, held_up, clock_set };

struct Stream {
  int bits = 8;  // of the counter; 0: it has none
  double rate_hz = 200.0;
  std::int64_t wrap_ns = 0, tick_ns = 0;  // of the clock; tick 0: it has none
  double noise_lsb = 0.0;                 // of the values; 0: none of them is another's
  Comes comes = Comes::one_by_one;
  Trouble trouble = Trouble::none;
};

std::ostream& operator<<(std::ostream& out, const Stream& s) {
  return out << s.bits << " bits, " << s.rate_hz << " Hz, wrap " << s.wrap_ns << " ns, tick " << s.tick_ns
             << " ns, noise " << s.noise_lsb << " LSB, comes " << static_cast<int>(s.comes) << ", trouble "
             << static_cast<int>(s.trouble);
}

struct Sent {
  std::uint64_t number = 0;
  ifog_sample sample{};
  bool taken = true;
  std::uint64_t missing = 0;
};

constexpr std::uint64_t kSamples = 3000;
constexpr std::int64_t kArrive_ns = 1'700'000'000'000'000'000;

// Their numbers as they come. Short of what no count tells: half a round lost, or a quarter of one back.
std::vector<std::uint64_t> order(const Stream& stream, std::mt19937& random) {
  const auto any = [&](std::uint64_t least, std::uint64_t most) {
    return std::uniform_int_distribution<std::uint64_t>(least, most)(random);
  };
  const std::uint64_t half = stream.bits > 0 ? std::uint64_t{1} << (stream.bits - 1) : 10;  // 0: no counter
  const std::uint64_t most_lost = std::min<std::uint64_t>(9, half - 1);
  std::vector<std::uint64_t> out;
  for (std::uint64_t n = 0; n < kSamples; ++n) {
    const bool now = n > 100 && n % 40 == 7;
    if (now && stream.trouble == Trouble::lost) n += any(1, most_lost);
    out.push_back(n);
    if (now && stream.trouble == Trouble::twice) out.push_back(out[out.size() - any(1, 3)]);
    if (now && stream.trouble == Trouble::exchanged) out.insert(out.end() - 1, ++n);
  }
  return out;
}

// When what is measured at that time comes, the `n`th.
double comes_s(const Stream& stream, std::uint64_t n, std::mt19937& random) {
  const auto in_portions = [&](std::uint64_t of) {
    return static_cast<double>(n / of * of + of - 1) / stream.rate_hz + 1e-4 * static_cast<double>(n % of);
  };
  switch (stream.comes) {
    case Comes::in_twos:
      return in_portions(2);
    case Comes::in_fours:
      return in_portions(4);
    case Comes::in_eights:
      return in_portions(8);
    case Comes::every_16_ms:
      return std::ceil(static_cast<double>(n) / stream.rate_hz / 0.016) * 0.016;
    default:
      return static_cast<double>(n) / stream.rate_hz +
             std::uniform_real_distribution<double>(0.0, 4e-4)(random);
  }
}

std::vector<double> values(const Stream& stream, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, stream.noise_lsb > 0.0 ? stream.noise_lsb : 10.0);
  std::vector<double> out(kSamples + 16);
  for (double& value : out)
    value = 0.05 + 1e-4 * (stream.noise_lsb > 0.0 ? std::round(noise(random)) : noise(random));
  return out;
}

std::vector<Sent> make(const Stream& stream, double set_s, std::uint32_t seed) {
  std::mt19937 random(seed);
  const std::vector<double> value = values(stream, random);
  std::vector<Sent> out;
  std::uint64_t highest = 0;
  double latest_s = 0.0;
  for (const std::uint64_t n : order(stream, random)) {
    Sent sent;
    sent.number = n;
    sent.taken = out.empty() || n > highest;
    sent.missing = sent.taken && !out.empty() ? n - highest - 1 : 0;
    highest = std::max(highest, n);
    const bool held = stream.trouble == Trouble::held_up && highest % 900 >= 700 &&
                      static_cast<double>(highest % 900 - 700) < 0.5 * stream.rate_hz;
    const double at_s = comes_s(stream, highest, random);
    const double held_until_s = static_cast<double>(highest / 900 * 900 + 700) / stream.rate_hz + 0.5;
    latest_s = std::max(latest_s, held ? held_until_s : at_s);
    sent.sample.arrival_ns = stream.comes == Comes::untimed ? 0 : kArrive_ns + std::llround(latest_s * 1e9);
    if (stream.bits > 0) {
      sent.sample.sequence = static_cast<std::uint32_t>(n % (std::uint64_t{1} << stream.bits));
      sent.sample.flags = IFOG_SAMPLE_SEQUENCE;
    }
    if (stream.tick_ns > 0) {
      const double own_s = 300.0 + static_cast<double>(n) / stream.rate_hz + (n > kSamples / 2 ? set_s : 0.0);
      std::int64_t stamp_ns = std::llround(own_s * 1e9) / stream.tick_ns * stream.tick_ns;
      if (stream.wrap_ns > 0) stamp_ns = (stamp_ns % stream.wrap_ns + stream.wrap_ns) % stream.wrap_ns;
      sent.sample.flags |= IFOG_SAMPLE_DEVICE_TIME;
      sent.sample.device_time_ns = stamp_ns;
      sent.sample.device_wrap_ns = stream.wrap_ns;
    }
    sent.sample.value[0] = value[n];
    sent.sample.valid_axes = 1;
    out.push_back(sent);
  }
  return out;
}

ifog_description description_of(const Stream& stream) {
  ifog_description out{};
  out.kind = IFOG_RATE;
  out.axes = 1;
  out.sequence_modulus = stream.bits > 0 ? 1U << static_cast<unsigned>(stream.bits) : 0;
  out.has_device_time = stream.tick_ns > 0 ? 1 : 0;
  out.nominal_rate_hz = stream.rate_hz;
  return out;
}

void expect_truth(const Stream& stream, double set_s = 0.0) {
  const std::vector<Sent> sent = make(stream, set_s, 11);
  const ifog_description description = description_of(stream);
  const SensorFacts facts = sensor_facts(description, 0.0, 0);
  Incrementer chain(facts);
  CaptureBuilder builder(description);
  std::uint64_t wrong_turn = 0, wrong_missing = 0, taken = 0, missing = 0, last = 0;
  double dt_s = 0.0, angle = 0.0, truth = 0.0;
  for (const Sent& one : sent) {
    Reading reading;
    read_sample(one.sample, 0, reading);
    Increment increment;
    const std::uint64_t before = chain.counts().missing;
    const bool took = chain.next(reading, increment);
    wrong_turn += took != one.taken ? 1 : 0;
    wrong_missing += chain.counts().missing - before != one.missing ? 1 : 0;
    dt_s += took ? increment.dt_s : 0.0;
    angle += took ? increment.delta_theta_rad[0] : 0.0;
    builder.add(one.sample);
    if (!one.taken) continue;
    ++taken;
    missing += one.missing;
    truth += one.sample.value[0] / stream.rate_hz;
    last = one.number;
  }
  const double tick_s = 1e-9 * static_cast<double>(stream.tick_ns);
  EXPECT_EQ(wrong_turn, 0U) << "of " << sent.size();
  EXPECT_EQ(wrong_missing, 0U);
  EXPECT_EQ(chain.counts().missing, missing);
  EXPECT_EQ(chain.counts().restarts, 0U);
  EXPECT_NEAR(dt_s, static_cast<double>(last + 1) / stream.rate_hz, 1e-6 + 2.0 * tick_s);
  EXPECT_NEAR(angle, truth, 0.05 * (1e-6 + 6.0 * tick_s));
  EXPECT_EQ(builder.clock_sets(), set_s == 0.0 ? 0U : 1U);
  EXPECT_EQ(chain.counts().sensor_clock_sets, set_s == 0.0 ? 0U : 1U);
  EXPECT_EQ(chain.counts().gaps == 0, missing == 0);
  EXPECT_EQ(builder.missing(), missing);
  if (stream.comes != Comes::untimed) {
    EXPECT_EQ(chain.counts().untold + builder.untold(), 0U);
  }
  EXPECT_EQ(builder.restarts(), 0U);
  EXPECT_EQ(builder.repeated(), sent.size() - taken);
  const Capture made = builder.finish();
  EXPECT_EQ(made.size(), taken);
  EXPECT_NEAR(made.time_s.back() - made.time_s.front(), dt_s - 1.0 / stream.rate_hz, 1e-6 + 2.0 * tick_s);
}

class TimelineTruthOf : public testing::TestWithParam<Trouble> {};

TEST_P(TimelineTruthOf, EachFrameIsJudgedAsItWasMade) {
  constexpr std::int64_t kWrap_ns = 4'294'967'296'000;
  for (const int bits : {4, 7, 8, 16})
    for (const double rate_hz : {200.0, 1000.0})
      for (const std::int64_t tick_ns : {0, 1000, 1'000'000})
        for (const double noise_lsb : {0.0, 0.7, 10.0})
          for (const Comes comes : {Comes::one_by_one, Comes::in_twos, Comes::in_fours, Comes::in_eights,
                                    Comes::untimed, Comes::every_16_ms}) {
            const std::int64_t wrap_ns = tick_ns == 0 ? 0 : tick_ns == 1000 ? kWrap_ns : 65'536'000'000;
            const Stream stream{bits, rate_hz, wrap_ns, tick_ns, noise_lsb, comes, GetParam()};
            SCOPED_TRACE(testing::Message() << stream);
            expect_truth(stream);
          }
}

// A stamp of 16 bits of microseconds, which goes round before ten samples are lost, and hardly after one.
TEST_P(TimelineTruthOf, AStampThatGoesRoundWithinFewSamplesIsFollowedByTheCounter) {
  for (const int bits : {7, 8, 16})
    for (const double rate_hz : {20.0, 100.0, 200.0})
      for (const Comes comes : {Comes::one_by_one, Comes::in_fours, Comes::untimed, Comes::every_16_ms}) {
        const Stream stream{bits, rate_hz, 65'536'000, 1000, 0.0, comes, GetParam()};
        SCOPED_TRACE(testing::Message() << stream);
        expect_truth(stream);
      }
}

// By a clock that is set, once, while the device counts on, no sample is lost and no angle is made.
TEST(TimelineTruth, AClockThatIsSetMakesNeitherTimeNorAngle) {
  for (const int bits : {4, 7, 8, 16})
    for (const double rate_hz : {200.0, 1000.0})
      for (const std::int64_t tick_ns : {1000, 1'000'000, 10'000'000, 100'000'000})
        for (const std::int64_t wrap_ns : {std::int64_t{0}, std::int64_t{4'294'967'296'000'000}})
          for (const Comes comes : {Comes::one_by_one, Comes::in_fours, Comes::untimed})
            for (const double set_s : {-36000.0, -100.0, -0.5, 0.5, 5.0, 20.0, 1000.0, 36000.0}) {
              // Of short steps forward alone nothing says whether rounds were lost.
              if (comes == Comes::untimed && set_s > 0.0 && set_s < 10.0) continue;
              const Stream stream{bits, rate_hz, wrap_ns, tick_ns, 0.0, comes, Trouble::clock_set};
              SCOPED_TRACE(testing::Message() << stream << ", set by " << set_s);
              expect_truth(stream, set_s);
            }
}

// By less than the arrival times of a read are known to, where counter and clock both go on; and of a device
// whose clock is all that it has.
TEST(TimelineTruth, AClockThatIsSetByLittleOrAloneMakesNeitherTimeNorAngle) {
  for (const int bits : {0, 7, 16})
    for (const double rate_hz : {200.0, 500.0, 1000.0})
      for (const std::int64_t wrap_ns : {std::int64_t{0}, std::int64_t{4'294'967'296'000}})
        for (const Comes comes : {Comes::one_by_one, Comes::in_twos, Comes::in_fours, Comes::every_16_ms})
          for (const double set_s : {-3.0, -0.5, 0.025, 0.04, 0.1, 0.5, 3.0, 20.0}) {
            // Short of a portion's length nothing but a counter tells it from samples that are missing.
            if (bits == 0 && std::abs(set_s) < 0.1) continue;
            const Stream stream{bits, rate_hz, wrap_ns, 1000, 0.0, comes, Trouble::clock_set};
            SCOPED_TRACE(testing::Message() << stream << ", set by " << set_s);
            expect_truth(stream, set_s);
          }
}

// Of a recording without times of arrival, and of one that is read at another pace than it was made, a clock
// alone that leaps forward is samples that are missing or a clock that was set: no angle is made, what is
// missing is told with that doubt, and where arrivals tell there is none.
TEST(TimelineTruth, WhereNothingTellsAClockThatWasSetFromALossThatIsSaid) {
  for (const bool at_once : {false, true})
    for (const bool lost : {false, true}) {
      const Comes comes = at_once ? Comes::one_by_one : Comes::untimed;
      const Stream stream{
          0, 200.0, 4'294'967'296'000, 1000, 0.0, comes, lost ? Trouble::lost : Trouble::none};
      std::vector<Sent> sent = make(stream, lost ? 0.0 : 3.0, 11);
      std::uint64_t missing = lost ? 0 : 600;
      double truth = 0.0, turned = 0.0;
      Incrementer chain(sensor_facts(description_of(stream), 0.0, 0));
      CaptureBuilder builder(description_of(stream));
      for (std::size_t i = 0; i < sent.size(); ++i) {
        if (at_once) sent[i].sample.arrival_ns = kArrive_ns + static_cast<std::int64_t>(i) * 1000;
        missing += sent[i].missing;
        truth += sent[i].sample.value[0] / stream.rate_hz;
        Reading reading;
        read_sample(sent[i].sample, 0, reading);
        Increment increment;
        if (chain.next(reading, increment)) turned += increment.delta_theta_rad[0];
        builder.add(sent[i].sample);
      }
      SCOPED_TRACE(testing::Message() << (at_once ? "at once" : "untimed") << (lost ? ", lost" : ", set"));
      EXPECT_EQ(chain.counts().missing, missing);
      EXPECT_EQ(chain.counts().untold, missing);
      EXPECT_EQ(builder.missing(), missing);
      EXPECT_EQ(builder.untold(), missing);
      EXPECT_NEAR(turned, truth, 1e-6);
    }
}

constexpr const char* kName[] = {"None", "Lost", "Twice", "Exchanged", "HeldUp", "ClockSet"};
INSTANTIATE_TEST_SUITE_P(Troubles, TimelineTruthOf,
                         testing::Values(Trouble::none, Trouble::lost, Trouble::twice, Trouble::exchanged,
                                         Trouble::held_up),
                         [](const testing::TestParamInfo<Trouble>& of) {
                           return std::string(kName[static_cast<std::size_t>(of.param)]);
                         });

}  // namespace
}  // namespace ifog
