// SPDX-License-Identifier: Apache-2.0
// The room `residual`: what effects leave, as lines, as lines that move, and in words.
#include "filters/diagnosis/residual/residual.h"
#include "filters/diagnosis/cleaning/steps.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/residual/lines.h"
#include "filters/diagnosis/residual/periodogram.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kPeriod = 0.01;
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::vector<double> white(std::size_t n, std::uint64_t seed) {
  test::Noise normal(seed);
  std::vector<double> values(n);
  for (double& value : values) value = normal();
  return values;
}

// Amplitudes of a tone by least squares scatter by sqrt(2/n) sigma; its frequency by the Cramer-Rao bound
// sqrt(6/n) sigma / (pi a T).
TEST(Lines, AToneIsFoundToItsBounds) {
  std::vector<double> error = white(20000, 1);
  const double start = 3.0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double phase = 2.0 * M_PI * 7.3137 * (start + kPeriod * static_cast<double>(i));
    error[i] += 0.3 * std::cos(phase) + 0.4 * std::sin(phase);
  }
  const std::vector<SpectralLine> lines = find_lines(error, start, kPeriod, 0.01);
  ASSERT_EQ(lines.size(), 1U);
  const double bound = std::sqrt(6.0 / 20000.0) / (M_PI * 0.5 * 200.0);
  EXPECT_NEAR(lines[0].frequency_hz, 7.3137, 5.0 * bound);
  EXPECT_GT(lines[0].frequency_std_hz, bound);  // on the safe side of it
  EXPECT_LT(lines[0].frequency_std_hz, 2.0 * bound);
  EXPECT_NEAR(std::hypot(lines[0].cosine, lines[0].sine), 0.5, 5.0 * std::sqrt(2.0 / 20000.0));
  EXPECT_GT(lines[0].coherence, 0.95);
  // A tone that the effects left and the error itself does not have is none of the sensor.
  EvenError own, left;
  own.start_s = left.start_s = start;
  own.before = own.rest = own.after = left.rest = left.after = std::make_shared<const Samples>(error);
  left.before = std::make_shared<const Samples>(error.size(), 0.0);
  const auto lines_in = [](const EvenError& record) {
    BlockGrid grid = grid_of({200});
    grid.sample_s = kPeriod;
    std::vector<EvenError> errors{record};
    return take_out_lines(0.01, grid, errors).size();
  };
  EXPECT_EQ(lines_in(own), 1U);
  EXPECT_EQ(lines_in(left), 0U);
  // Missing values make it uncertain, not small.
  const std::vector<double> coins = white(error.size(), 2);
  for (std::size_t i = 0; i < error.size(); ++i)
    if (coins[i] > 0.25) error[i] = std::nan("");
  const std::vector<SpectralLine> rest = find_lines(error, start, kPeriod, 0.01);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_NEAR(std::hypot(rest[0].cosine, rest[0].sine), 0.5, 5.0 * std::sqrt(2.0 / 12000.0));
  EXPECT_NEAR(rest[0].std_error, std::sqrt(2.0 / 12000.0), 0.3 * std::sqrt(2.0 / 12000.0));
}

TEST(Lines, WhiteNoiseHasNoneAndItsSpectrumIsFlat) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    found += static_cast<int>(find_lines(white(4096, seed), 0.0, kPeriod, 0.01).size());
  EXPECT_LE(found, 2);  // 0.2 expected
  const Spectrum spectrum = averaged(periodogram(white(65536, 5)), kPeriod, 40);
  // One-sided: 2 sigma^2 dt. The last bands hold thousands of bins.
  EXPECT_NEAR(spectrum.density.back(), 2.0 * kPeriod, 0.05 * 2.0 * kPeriod);
}

Unexplained of(const std::vector<double>& left, const std::vector<NoiseChangeIn>& changes = {}) {
  BlockGrid grid;
  grid.block_s = 1.0;
  grid.sample_s = kPeriod;
  EvenError error;
  error.before = error.after = std::make_shared<const ifog::Samples>(left);
  NoiseFit noise;
  noise.white_variance = kPeriod;  // of a mean of one second of unit noise
  return describe_rest({Record{}}, {error}, {}, noise, grid, 0.01, changes);
}

// A piece with a hole has few differences left, and they scatter more than all would.
TEST(Unexplained, WhatIsLeftOfAPieceBesideAHoleIsNoBurst) {
  int bursts = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    std::vector<double> holed = white(4000, 500 + seed);
    for (std::size_t i = 0; i < holed.size(); ++i)
      if (i % 25 > 1 && (i / 25) % 2 == 1) holed[i] = kMissing;
    bursts += of(holed).kind == "bursts";
  }
  EXPECT_LE(bursts, 5);  // 1 expected
}

TEST(Unexplained, SaysWhatTheRestLooksLike) {
  const std::vector<double> noise = white(60000, 21);
  EXPECT_EQ(of(noise).kind, "nothing");

  std::vector<double> knocked = noise;
  for (const std::size_t at : {10000U, 30000U, 45000U}) {
    for (std::size_t i = at; i < at + 30; ++i) knocked[i] += i % 2 ? 15.0 : -15.0;
  }
  const Unexplained bursts = of(knocked);
  EXPECT_EQ(bursts.kind, "bursts");
  ASSERT_EQ(bursts.times_s.size(), 3U);
  EXPECT_NEAR(bursts.times_s[0], 100.0, 0.5);
  EXPECT_NEAR(bursts.times_s[2], 450.0, 0.5);

  EXPECT_EQ(of(noise, {NoiseChangeIn{"", {300.0, 600.0, 3.0, {}}}}).kind, "changing_variance");

  std::vector<double> drifting = noise;
  double walk = 0.0;
  const std::vector<double> steps = white(60000, 22);
  for (std::size_t i = 0; i < drifting.size(); ++i) drifting[i] += walk += 0.01 * steps[i];
  const Unexplained slow = of(drifting);
  EXPECT_EQ(slow.kind, "slow");
  EXPECT_GT(slow.fraction, 0.5);

  std::vector<double> humming = noise;
  for (std::size_t i = 0; i < humming.size(); ++i)
    humming[i] += 0.2 * std::sin(2.0 * M_PI * 3.3 * kPeriod * static_cast<double>(i));
  EXPECT_EQ(of(humming).kind, "line");
  EXPECT_NEAR(of(humming).frequency_hz, 3.3, 1e-4);
  // An MPU6050 at rest (sunsided/sensor-fusion): the means drift, and a line that they average out is no cause.
  for (std::size_t i = 0; i < humming.size(); ++i) humming[i] += drifting[i] - noise[i];
  const Unexplained both = of(humming);
  EXPECT_EQ(both.kind, "line");
  EXPECT_EQ(both.means_s, kPeriod);
  EXPECT_TRUE(test::has(both.hint, "Besides, slow drift"));
}

// Stamps that scatter about an even clock are set even; steps that are of different lengths stay.

constexpr std::size_t kSamples = 20000;

Record stamped(const std::vector<double>& time_s, const std::vector<double>& rate) {
  return made_record("sensor", time_s, rate);
}

// 100 Hz with an hour's hole, every stamp off by up to 4 ms either way.
std::vector<double> scattering() {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> off(-4e-3, 4e-3);
  std::vector<double> time_s;
  for (std::size_t i = 0; i < kSamples; ++i)
    time_s.push_back(0.01 * static_cast<double>(i) + (i > 12000 ? 3600.0 : 0.0) + off(engine));
  return time_s;
}

TEST(EvenStamps, NoSampleOfAJitteringLogIsLostOnTheGrid) {
  const std::vector<double> time_s = scattering();
  const std::vector<double> rate(kSamples, 1.0);
  const auto on_grid = [](const Record& record) {
    std::size_t count = 0;
    for (const double value : on_even_grid(record, 0.01, record.rate_radps))
      count += std::isfinite(value) ? 1 : 0;
    return count;
  };
  const std::vector<Record> records{stamped(time_s, rate)};
  EXPECT_LT(on_grid(records[0]), kSamples - kSamples / 20) << "samples share steps by their stamps";
  const OwnedRecords timed = with_even_stamps(records);
  EXPECT_EQ(on_grid(timed.records[0]), kSamples);
  ASSERT_EQ(timed.remarks.size(), 1U);
  EXPECT_TRUE(test::has(timed.remarks[0], "sensor: the time stamps are up to"));
  for (std::size_t i = 0; i < kSamples; ++i) EXPECT_NEAR(timed.records[0].time_s[i], time_s[i], 0.025) << i;
}

TEST(EvenStamps, StepsOfDifferentLengthsAndAnEvenClockStay) {
  std::mt19937_64 engine(8);
  std::uniform_real_distribution<double> length(0.007, 0.013);
  std::vector<double> uneven, even;
  double t = 0.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    uneven.push_back(t += length(engine));
    even.push_back(0.01 * static_cast<double>(i));
  }
  const std::vector<double> rate(kSamples, 1.0);
  for (const std::vector<double>& time_s : {uneven, even}) {
    const OwnedRecords timed = with_even_stamps(std::vector{stamped(time_s, rate)});
    EXPECT_EQ(timed.records[0].time_s.data(), time_s.data());
    EXPECT_TRUE(timed.remarks.empty());
  }
}

}  // namespace
}  // namespace ifog
