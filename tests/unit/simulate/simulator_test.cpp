// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "tests/unit/test.h"
#include "tools/simulate/draw.h"
#include "tools/simulate/noise.h"
#include "tools/simulate/simulator.h"

namespace {

namespace fs = std::filesystem;
using ifog::simulate::Scenario;
using ifog::simulate::Simulation;

class ScenarioFile : public testing::Test, protected ifog::test::OwnFolder {
 protected:
  Scenario read(const std::string& text) const {
    write("scenario.toml", text);
    return ifog::simulate::read_scenario(path("scenario.toml"));
  }
  Simulation simulate(const std::string& text) const { return ifog::simulate::simulate(read(text)); }
  std::string refusal(const std::string& text) const {
    const std::string line = ifog::test::refusal([&] { (void)simulate(text); }), file = path("scenario.toml");
    return line.starts_with(file) ? line.substr(file.size()) : line;
  }
};

const std::string kTemperature =
    "sample_rate_hz = 10\nduration_s = 100\n[[channel]]\nname = \"temperature_degC\"\nshape = \"ramp\"\nfrom "
    "= 20\nto = 30\n";

TEST_F(ScenarioFile, EffectIsTheFormOfItsChannel) {
  const Simulation s = simulate(kTemperature +
                                "[[effect]]\nform = \"quadratic\"\nchannel = "
                                "\"temperature_degC\"\ncoefficient = 2e-6\nreference = 25\n");
  const auto& t = s.capture.channels[0].values;
  for (std::size_t i = 0; i < s.capture.size(); ++i)
    EXPECT_NEAR(s.capture.rate_radps[0][i], 2e-6 * (t[i] - 25.0) * (t[i] - 25.0), 1e-18);
  EXPECT_EQ(s.truth.true_rate_radps[0], std::vector<double>(1000, 0.0));
}

TEST_F(ScenarioFile, LagOfARampIsItsSlopeTimesTheTimeConstant) {
  const Simulation s = simulate(kTemperature +
                                "[[effect]]\nform = \"lagged\"\nchannel = \"temperature_degC\"\ncoefficient "
                                "= 1\ntime_constant_s = 5\n");
  const auto& t = s.capture.channels[0].values;
  EXPECT_NEAR(t.back() - s.capture.rate_radps[0].back(), 0.1 * 5.0,
              0.1 * 5.0 * 0.02);  // first order in the step
}

TEST_F(ScenarioFile, BacklashHasTwoBranches) {
  const Simulation s = simulate(
      "sample_rate_hz = 10\nduration_s = 200\n[[channel]]\nname = \"t_degC\"\nshape = \"cycle\"\namplitude = "
      "5\nperiod_s = 100\n"
      "[[effect]]\nform = \"backlash\"\nchannel = \"t_degC\"\ncoefficient = 1\nwidth = 2\n");
  const auto& r = s.capture.rate_radps[0];
  const auto at = [&](double time) { return r[static_cast<std::size_t>(time * 10)]; };
  EXPECT_NEAR(at(100), -0.0 - 1.0, 0.02);  // rising through zero: half the width behind
  EXPECT_NEAR(at(150), 0.0 + 1.0, 0.02);   // falling through zero
}

TEST_F(ScenarioFile, RateTableGivesScaleFactorAndItsReference) {
  const Simulation s = simulate(
      "sample_rate_hz = 10\nduration_s = 100\nreference = true\naxes = [\"x\", \"y\"]\n"
      "[[motion]]\naxis = \"x\"\nkind = \"rate_table\"\nrates_radps = [0.0, 1.0, -1.0]\ndwell_s = 20\n"
      "[[effect]]\nform = \"linear\"\nchannel = \"rate\"\naxis = \"x\"\ncoefficient = 1e-3\n");
  EXPECT_EQ(s.capture.axes, (std::vector<std::string>{"x", "y"}));
  EXPECT_DOUBLE_EQ(s.capture.rate_radps[0][300], 1.001);
  EXPECT_DOUBLE_EQ(s.capture.reference_rate_radps[0][300], 1.0);
  EXPECT_DOUBLE_EQ(s.capture.rate_radps[0][500], -1.001);
  EXPECT_EQ(s.capture.rate_radps[1][300], 0.0);
}

TEST_F(ScenarioFile, FeedbackRampFollowsTheRotationAndWraps) {
  const Simulation s = simulate(
      "sample_rate_hz = 100\nduration_s = 10\n[[motion]]\nkind = \"rest\"\nrate_radps = 0.5\n"
      "[[channel]]\nname = \"ramp_counts\"\nshape = \"feedback_ramp\"\nmodulus = 1000\ncounts_per_rad = "
      "20000\n");
  const auto& ramp = s.capture.channels[0].values;
  for (std::size_t i = 0; i < ramp.size(); ++i) {
    EXPECT_EQ(ramp[i], std::floor(ramp[i]));
    EXPECT_GE(ramp[i], 0.0);
    EXPECT_LT(ramp[i], 1000.0);
  }
  EXPECT_NEAR(std::remainder(ramp[500] - ramp[400], 1000.0), std::remainder(0.5 * 20000, 1000.0), 1.0);
}

TEST_F(ScenarioFile, AnotherAxisADifferenceAndATurnAreChannelsOfEffects) {
  const Simulation s = simulate(
      "sample_rate_hz = 10\nduration_s = 100\naxes = [\"x\", \"y\"]\n"
      "[[motion]]\nkind = \"sine\"\naxis = \"y\"\namplitude_radps = 0.5\nperiod_s = 40\n"
      "[[channel]]\nname = \"table_deg\"\nshape = \"angle\"\naxis = \"y\"\nturn = 360\n"
      "[[channel]]\nname = \"inner_degC\"\nshape = \"ramp\"\nfrom = 20\nto = 30\n"
      "[[channel]]\nname = \"outer_degC\"\nshape = \"constant\"\nlevel = 18\n"
      "[[effect]]\nform = \"linear\"\naxis = \"x\"\nchannel = \"rate_y\"\ncoefficient = 1e-3\n"
      "[[effect]]\nform = \"absolute\"\naxis = \"y\"\nchannel = \"rate\"\ncoefficient = 1e-4\n"
      "[[effect]]\nform = \"linear\"\naxis = \"x\"\nchannel = \"inner_degC\"\nminus_channel = "
      "\"outer_degC\"\n"
      "coefficient = 1e-6\n"
      "[[effect]]\nform = \"cosine\"\naxis = \"x\"\nchannel = \"table_deg\"\nperiod = 360\ncoefficient = "
      "2e-6\n");
  const auto& y = s.truth.true_rate_radps[1];
  double angle = 0.0;
  for (std::size_t i = 0; i < s.capture.size(); ++i) {
    angle += y[i] * 0.1;
    EXPECT_NEAR(s.capture.rate_radps[0][i],
                1e-3 * y[i] + 1e-6 * (s.capture.channels[1].values[i] - 18.0) + 2e-6 * std::cos(angle),
                1e-14);
    EXPECT_NEAR(s.capture.rate_radps[1][i], y[i] + 1e-4 * std::abs(y[i]), 1e-15);
    EXPECT_GE(s.capture.channels[0].values[i], 0.0);
    EXPECT_LT(s.capture.channels[0].values[i], 360.0);
  }
}

// Level and pointing north it sees the horizontal part, standing on end the vertical one.
TEST_F(ScenarioFile, TheEarthsRateTurnsIntoAnAxisThatTilts) {
  const Simulation s = simulate(
      "sample_rate_hz = 10\nduration_s = 100\n"
      "[[channel]]\nname = \"accel_x_mps2\"\nshape = \"steps\"\ndwell_s = 50\nlevels = [0.0, 9.80665]\n"
      "[[effect]]\nform = \"earth_rate\"\nchannel = \"accel_x_mps2\"\nlatitude_deg = 30\nheading_deg = 60\n");
  EXPECT_NEAR(s.capture.rate_radps[0][10], 7.292115e-5 * std::sqrt(0.75) * 0.5, 1e-15);
  EXPECT_NEAR(s.capture.rate_radps[0][900], 7.292115e-5 * 0.5, 1e-15);
}

TEST_F(ScenarioFile, SameSeedSameBitsAndPartsDoNotDisturbEachOther) {
  const std::string noisy = "seed = 5\n" + kTemperature + "noise = 0.1\n[noise]\nN = 1e-6\nB = 1e-7\n";
  const Simulation a = simulate(noisy), b = simulate(noisy);
  EXPECT_EQ(a.capture.rate_radps, b.capture.rate_radps);
  EXPECT_EQ(a.capture.channels[0].values, b.capture.channels[0].values);
  const Simulation other = simulate("seed = 6\n" + noisy.substr(9));
  EXPECT_NE(a.capture.rate_radps, other.capture.rate_radps);
  const Simulation more = simulate(noisy + "[[effect]]\nform = \"outliers\"\nfraction = 0\nsize_radps = 1\n");
  EXPECT_EQ(a.capture.rate_radps, more.capture.rate_radps);
}

TEST_F(ScenarioFile, DrawnValuesStandInTheTruth) {
  const std::string text = kTemperature +
                           "[[effect]]\nform = \"linear\"\nchannel = \"temperature_degC\"\n"
                           "coefficient = { between = [1e-8, 1e-6], log = true, either_sign = true }\n";
  const Simulation s = simulate(text);
  const auto truth = nlohmann::json::parse(ifog::simulate::truth_json(s.truth));
  const double drawn = truth["effects"][0]["coefficient"];
  EXPECT_GE(std::abs(drawn), 1e-8);
  EXPECT_LE(std::abs(drawn), 1e-6);
  EXPECT_NEAR(s.capture.rate_radps[0][500], drawn * s.capture.channels[0].values[500], 1e-20);
  EXPECT_NE(simulate("seed = 2\n" + text).capture.rate_radps[0][500], s.capture.rate_radps[0][500]);
}

TEST_F(ScenarioFile, GapsAndMissingRowsLeaveTheOthersAlone) {
  const std::string plain = "seed = 5\nsample_rate_hz = 10\nduration_s = 100\n";
  const Simulation whole = simulate(plain + "[noise]\nN = 1e-6\n");
  const Simulation holed = simulate(plain + "gaps = [[20.0, 30.0]]\nmissing_rows = 0.1\n[noise]\nN = 1e-6\n");
  EXPECT_LT(holed.capture.size(), 850U);
  for (std::size_t i = 0; i < holed.capture.size(); ++i) {
    const double t = holed.capture.time_s[i];
    EXPECT_TRUE(t < 20.0 || t >= 30.0);
    EXPECT_EQ(holed.capture.rate_radps[0][i],
              whole.capture.rate_radps[0][static_cast<std::size_t>(std::lround(t * 10))]);
  }
}

TEST_F(ScenarioFile, RefusesInOneLine) {
  EXPECT_EQ(refusal("duration_s = 1\nspeed = 3\n").substr(0, 44),
            ":2: speed is unknown, did you mean 'seed'? K");
  EXPECT_EQ(refusal("duration_s = 1\nvelocity = 3\n").substr(0, 45),
            ":2: velocity is unknown, expected one of: nam");
  EXPECT_EQ(refusal("sample_rate_hz = 3\n"), ":1: duration_s is missing, expected seconds");
  EXPECT_EQ(refusal("duration_s = \"long\"\n"), ":1: duration_s is a string, expected a number");
  EXPECT_EQ(refusal("duration_s = 10\n[noise]\nN = -1\n"), ":3: noise.N is -1.000000, expected at least 0");
  EXPECT_EQ(refusal("duration_s = 10\n[noise]\nM = 1\n"), ":3: noise.M is unknown, expected Q, N, B, K or R");
  EXPECT_EQ(refusal("duration_s = 10\n[[effect]]\nform = \"linear\"\ncoefficient = 1\n"),
            ":2: [[effect]]: key 'channel' is missing for linear, expected a channel's name, or 'rate'");
  EXPECT_EQ(
      refusal("duration_s = 10\n[[effect]]\nform = \"linear\"\ncoefficient = 1\nchannel = \"t_degC\"\n"),
      "effect linear: channel 't_degC' is not in the scenario, expected one of its channels, 'rate' or "
      "'rate_AXIS'");
  EXPECT_EQ(
      refusal(
          "duration_s = 10\n[[channel]]\nname = \"t_degC\"\nshape = \"constant\"\nlevel = 1\nlevle = 2\n"),
      ":2: [[channel]]: key 'levle' is unknown for constant, did you mean 'level'? Known here: level, noise, "
      "resolution, every_s, missing");
  EXPECT_EQ(refusal("duration_s = 10\n[[effect]]\nform = \"magic\"\n").substr(0, 40),
            ":2: [[effect]]: 'magic' is unknown, expe");
  EXPECT_EQ(refusal("duration_s = = 3\n").substr(0, 3), ":1:");
}

TEST(Scenarios, TheExamplesRun) {
  int found = 0;
  for (const auto& entry : fs::directory_iterator(IFOG_SOURCE_DIR "/tools/simulate/scenarios")) {
    Scenario s = ifog::simulate::read_scenario(entry.path().string());
    s.duration_s = 20.0;
    s.gaps.clear();
    EXPECT_GT(ifog::simulate::simulate(s).capture.size(), 10U) << entry.path();
    ++found;
  }
  EXPECT_GE(found, 3);
}

using ifog::simulate::Draw;

TEST(Draw, LogarithmAgreesWithTheLibrarys) {
  for (double x = 1e-16; x < 1.0; x *= 1.37)
    EXPECT_NEAR(ifog::simulate::plain_log(x) / std::log(x), 1.0, 4e-16) << x;
}

TEST(Draw, QuantileInvertsTheErrorFunction) {
  for (double p = 1e-15; p < 0.5; p *= 1.9) {
    const double z = ifog::simulate::normal_quantile(p);
    EXPECT_NEAR(0.5 * std::erfc(-z / std::numbers::sqrt2) / p, 1.0, 5e-14) << p;
    if (p > 1e-6) {  // 1 − p is rounded
      EXPECT_NEAR(ifog::simulate::normal_quantile(1.0 - p), -z, 1e-9) << p;
    }
  }
  EXPECT_EQ(ifog::simulate::normal_quantile(0.5), 0.0);
}

TEST(Draw, MomentsAreTheNormalDistributions) {
  Draw draw(7, 3);
  constexpr int kDraws = 2'000'000;
  double m1 = 0, m2 = 0, m4 = 0, lag = 0, before = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = draw.normal();
    m1 += x;
    m2 += x * x;
    m4 += x * x * x * x;
    lag += x * before;
    before = x;
  }
  const double root = std::sqrt(static_cast<double>(kDraws));  // 4.5 standard errors each
  EXPECT_LT(std::abs(m1 / kDraws), 4.5 / root);
  EXPECT_LT(std::abs(m2 / kDraws - 1.0), 4.5 * std::sqrt(2.0) / root);
  EXPECT_LT(std::abs(m4 / kDraws - 3.0), 4.5 * std::sqrt(96.0) / root);
  EXPECT_LT(std::abs(lag / kDraws), 4.5 / root);
}

TEST(Draw, SeedAndStreamNameTheSequence) {
  Draw a(5, 1), same(5, 1), stream(5, 2), seed(6, 1);
  int equal = 0;
  for (int i = 0; i < 100; ++i) {
    const double x = a.uniform();
    EXPECT_EQ(x, same.uniform());
    equal += x == stream.uniform();
    equal += x == seed.uniform();
  }
  EXPECT_EQ(equal, 0);
}

// The bits themselves, so that a change of the generator cannot pass unseen: captures are quoted by their
// seed.
TEST(Draw, FirstValuesStayWhatTheyAre) {
  Draw draw(1, 0);
  EXPECT_EQ(draw.uniform(), 0x1.ee7244f7a31f7p-1);
  EXPECT_EQ(draw.normal(), -0x1.a823b96801e7cp+0);
}

TEST(Draw, WholeNumbersAreEquallyLikely) {
  Draw draw(1, 0);
  std::array<int, 6> counts{};
  for (int i = 0; i < 6000; ++i) ++counts[draw.below(6)];
  for (const int count : counts) EXPECT_NEAR(count, 1000, 4.5 * std::sqrt(6000.0 * 5 / 36));
}

// Each noise term against the closed form of its Allan variance (IEEE Std 952), with the variance estimated
// here by the definition, not by our own Allan code.

using ifog::simulate::NoiseLevels;

// Mean of (ȳ₂ − ȳ₁)²/2 over non-overlapping pairs of m samples.
double allan_variance(const std::vector<double>& rate, std::size_t m) {
  double sum = 0.0;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i + 2 * m <= rate.size(); i += 2 * m, ++pairs) {
    double a = 0.0, b = 0.0;
    for (std::size_t k = 0; k < m; ++k) {
      a += rate[i + k];
      b += rate[i + m + k];
    }
    const double d = (b - a) / static_cast<double>(m);
    sum += 0.5 * d * d;
  }
  return sum / static_cast<double>(pairs);
}

// Mean over records of the ratio to the closed form at each m, with its standard error from the scatter.
void expect_form(const NoiseLevels& levels, double rate_hz, double (*form)(const NoiseLevels&, double)) {
  constexpr std::size_t kSamples = 1U << 15U;
  constexpr int kRecords = 40;
  struct Sums {
    double ratio = 0.0, square = 0.0;
  };
  std::map<std::size_t, Sums> of{{1, {}}, {2, {}}, {8, {}}, {64, {}}, {512, {}}, {4096, {}}};
  for (int record = 0; record < kRecords; ++record) {
    const auto rate =
        ifog::simulate::noise(levels, rate_hz, kSamples, 100 + static_cast<std::uint64_t>(record));
    for (auto& [m, sums] : of) {
      const double ratio = allan_variance(rate, m) / form(levels, static_cast<double>(m) / rate_hz);
      sums.ratio += ratio;
      sums.square += ratio * ratio;
    }
  }
  for (const auto& [m, sums] : of) {
    const double mean = sums.ratio / kRecords;
    const double error = std::sqrt((sums.square / kRecords - mean * mean) / (kRecords - 1));
    EXPECT_LT(std::abs(mean - 1.0), 4.0 * error + 0.004)
        << "m = " << m << ", mean " << mean << " ± " << error;
  }
}

TEST(Noise, AngleRandomWalk) {
  expect_form({.N = 1e-6}, 200.0, [](const NoiseLevels& c, double tau) { return c.N * c.N / tau; });
}

TEST(Noise, BiasInstability) {
  expect_form({.B = 3e-8}, 200.0, [](const NoiseLevels& c, double) {
    return 2.0 * std::numbers::ln2 / std::numbers::pi * c.B * c.B;
  });
}

TEST(Noise, RateRandomWalk) {
  expect_form({.K = 1e-9}, 50.0, [](const NoiseLevels& c, double tau) { return c.K * c.K * tau / 3.0; });
}

TEST(Noise, QuantisationOfADitheredAngle) {
  // Angle noise of four steps a sample makes the rounding error uniform and independent.
  const double rate_hz = 100.0, q = 1e-7;
  expect_form(
      {.Q = q, .N = 4.0 * std::sqrt(12.0) * q * std::sqrt(rate_hz)}, rate_hz,
      [](const NoiseLevels& c, double tau) { return 3.0 * c.Q * c.Q / (tau * tau) + c.N * c.N / tau; });
}

TEST(Noise, QuantisedRateIsWholeStepsAndKeepsTheAngle) {
  std::vector<double> rate = ifog::simulate::noise({.N = 1e-5}, 100.0, 10000, 3);
  double before = 0.0, after = 0.0;
  for (const double r : rate) before += r * 0.01;
  const double lsb = 4.8481368e-7;
  ifog::simulate::quantise_angle(rate, 0.01, lsb);
  for (const double r : rate) {
    after += r * 0.01;
    EXPECT_NEAR(std::remainder(r * 0.01 / lsb, 1.0), 0.0, 1e-9);
  }
  EXPECT_LE(std::abs(after - before), 0.5 * lsb * (1.0 + 1e-6));
}

TEST(Noise, RampIsTheMeanRateOfEachStep) {
  const auto rate = ifog::simulate::noise({.R = 2e-6}, 10.0, 100, 1);
  for (std::size_t i = 0; i < rate.size(); ++i)
    EXPECT_DOUBLE_EQ(rate[i], 2e-6 * 0.1 * (static_cast<double>(i) + 0.5));
}

TEST(Noise, GaussMarkovHasTheVarianceOfItsMeans) {
  // Var of the mean over h correlation times: 2(h − 1 + e⁻ʰ)/h², lag-1 covariance (1 − e⁻ʰ)²/h².
  for (const double h : {1e-4, 0.5, 3.0}) {
    double variance = 0.0, lag = 0.0;
    constexpr int kRuns = 400, kSteps = 500;
    for (int run = 0; run < kRuns; ++run) {
      ifog::simulate::GaussMarkov source(2.0, 1.0 / h, 1.0,
                                         ifog::simulate::Draw(9, static_cast<std::uint32_t>(run)));
      double before = source.next();
      for (int i = 0; i < kSteps; ++i) {
        const double x = source.next();
        variance += x * x;
        lag += x * before;
        before = x;
      }
    }
    constexpr double kAll = double{kRuns} * kSteps;
    const double expected = 2.0 * (h + std::expm1(-h)) / (h * h);
    const double independent = std::max(double{kRuns}, kAll * std::min(1.0, h / 2));
    EXPECT_NEAR(variance / kAll / 4.0, expected, 4.5 * std::sqrt(2.0 / independent) * expected) << h;
    EXPECT_NEAR(lag / kAll / 4.0, std::pow(std::expm1(-h) / h, 2),
                4.5 * std::sqrt(2.0 / independent) * expected)
        << h;
  }
}

TEST(Noise, RefusesImpossibleLevels) {
  EXPECT_THROW((void)ifog::simulate::noise({.N = -1.0}, 1.0, 1, 1), std::invalid_argument);
  EXPECT_THROW((void)ifog::simulate::noise({.K = std::nan("")}, 1.0, 1, 1), std::invalid_argument);
}

}  // namespace
