// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/channels/derived_channels.h"
#include "filters/diagnosis/cleaning/steps.h"
#include "filters/diagnosis/diagnose.h"
#include "filters/model_file/channel_names.h"
#include "filters/model_file/form.h"
#include "tests/unit/diagnosis/findings.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kTurn = 2.0 * M_PI;

struct Columns {
  std::vector<double> time, rate, reference, one, other, angle, turned;
};

// A table that turns forwards, stands and turns back over more than a turn; two thermometers.
Columns columns(std::size_t n) {
  Columns c;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = 0.1 * static_cast<double>(i);
    c.time.push_back(t);
    c.rate.push_back(1e-4);
    c.reference.push_back(0.3 * std::sin(t / 50.0));
    c.one.push_back(20.0 + 0.01 * t);
    c.other.push_back(18.0 + 0.02 * t);
    c.angle.push_back(15.0 * (1.0 - std::cos(t / 50.0)));  // the integral of the reference
    c.turned.push_back(0.2 * std::cos(t / 30.0));
  }
  return c;
}

Record record_of(const Columns& c, const std::vector<double>& wrapped) {
  Record record = made_record(
      "", c.time, c.rate,
      {{"inner_degC", c.one}, {"outer_degC", c.other}, {"supply_V", c.one}, {"table_rad", wrapped}},
      c.reference);
  record.other_axes = {{"rate_y_radps", c.turned}};
  return record;
}

std::vector<double> wrapped(const std::vector<double>& angle, double period) {
  std::vector<double> out;
  for (const double a : angle) out.push_back(a - period * std::floor(a / period));
  return out;
}

TEST(DerivedChannels, AnAngleIsToldByItsUnitAndItsWraps) {
  const Columns c = columns(5000);
  const std::vector<double> inside = wrapped(c.angle, kTurn);
  EXPECT_DOUBLE_EQ(angle_period("table_rad", inside), kTurn);
  std::vector<double> degrees;
  for (const double a : inside) degrees.push_back(a * 360.0 / kTurn);
  EXPECT_DOUBLE_EQ(angle_period("heading_deg", degrees), 360.0);
  EXPECT_EQ(angle_period("ramp_counts", inside), 0.0) << "no unit of an angle";
  EXPECT_EQ(angle_period("table_rad", c.angle), 0.0) << "goes on over several turns, and wraps nowhere";
  const std::vector<double> tilt(inside.begin(), inside.begin() + 100);
  EXPECT_EQ(angle_period("tilt_rad", tilt), 0.0) << "a part of a turn";
}

TEST(DerivedChannels, UnwrappedItIsTheAngleTurned) {
  const Columns c = columns(5000);
  std::vector<double> inside = wrapped(c.angle, kTurn);
  inside[2000] = std::nan("");
  const OwnedRecords derived = with_unwrapped_angles(std::vector{record_of(c, inside)});
  const RecordChannel& angle = derived.records[0].channels[3];
  EXPECT_DOUBLE_EQ(angle.period, kTurn);
  for (std::size_t i = 0; i < c.angle.size(); ++i) {
    if (i == 2000)
      EXPECT_TRUE(std::isnan(angle.values[i]));
    else
      ASSERT_NEAR(angle.values[i], c.angle[i], 1e-9) << i;
  }
  EXPECT_EQ(derived.records[0].channels[0].period, 0.0);
}

TEST(DerivedChannels, AGlitchOfTheLoggerIsNoAngle) {
  const Columns c = columns(5000);
  std::vector<double> inside = wrapped(c.angle, kTurn);
  for (const std::size_t i : {700, 701, 3000}) inside[i] = 1e6;
  const OwnedRecords derived = with_unwrapped_angles(std::vector{record_of(c, inside)});
  const RecordChannel& angle = derived.records[0].channels[3];
  EXPECT_DOUBLE_EQ(angle.period, kTurn);
  for (const std::size_t i : {700, 701, 3000}) EXPECT_TRUE(std::isnan(angle.values[i]));
  for (const std::size_t i : {699, 702, 3001, 4999}) EXPECT_NEAR(angle.values[i], c.angle[i], 1e-9) << i;
  ASSERT_EQ(derived.remarks.size(), 1U);
  EXPECT_EQ(derived.remarks[0],
            "table_rad is outside the turn in 3 sample(s), first 1e+06: no angle, dropped");
  for (std::size_t i = 3500; i < 3600; ++i) inside[i] = -127.0;
  EXPECT_DOUBLE_EQ(angle_period("table_rad", inside), kTurn) << "an error code for ten seconds";
}

TEST(DerivedChannels, LikeChannelsAreTakenFromEachOtherAndUnlikeOnesAreNot) {
  const Columns c = columns(100);
  std::vector<double> polled = c.other;
  for (std::size_t i = 0; i < polled.size(); ++i)
    if (i % 2 == 1) polled[i] = std::nan("");
  Record record = record_of(c, c.angle);
  record.channels[1].values = polled;
  const OwnedRecords along = with_other_axes(with_differences(std::vector{record}));
  const auto& channels = along.records[0].channels;
  ASSERT_EQ(channels.size(), 6U) << "one difference and one other axis";
  EXPECT_EQ(channels[4].name, difference_of("inner_degC", "outer_degC"));
  EXPECT_DOUBLE_EQ(channels[4].values[40], c.one[40] - c.other[40]);
  EXPECT_DOUBLE_EQ(channels[4].values[41], c.one[41] - c.other[40]) << "the other one held";
  EXPECT_EQ(channels[5].name, "rate_y_radps");
  EXPECT_EQ(names_in(channels[4].name).of, "inner_degC");
  EXPECT_EQ(names_in(channels[4].name).less, "outer_degC");
}

TEST(DerivedChannels, WithoutAReferenceAnotherAxisIsRotationAndNoChannel) {
  const Columns c = columns(100);
  Record record = record_of(c, c.angle);
  record.reference_radps = {};
  EXPECT_EQ(with_other_axes(std::vector{record}).records[0].channels.size(), 4U);
  const std::vector<double> still(100, 0.0);
  record.reference_radps = still;
  EXPECT_EQ(with_other_axes(std::vector{record}).records[0].channels.size(), 4U)
      << "a table that never turned";
}

// Three gyros on a table, each of which sees thousandths of the others' rotation. Cross-axis terms refer to the
// true rates, as the daemon corrects them (compensator.h), and not to the measured ones, which differ by the
// square of the angles.
TEST(OtherAxes, ComeWithoutTheirOwnMisalignmentWhereTheirReferenceIsLogged) {
  constexpr std::size_t n = 20000;
  test::Noise normal(1);
  std::vector<double> time;
  std::array<std::vector<double>, 3> truth, measured;
  const double seen[3][3] = {{1e-4, 2e-3, 1.8e-3}, {-1.4e-3, 0.0, -1.9e-3}, {1.2e-3, 1.9e-3, -2e-4}};
  for (std::size_t i = 0; i < n; ++i) {
    time.push_back(0.02 * static_cast<double>(i));
    for (std::size_t a = 0; a < 3; ++a)
      truth[a].push_back(0.5 * std::sin(time.back() * (0.3 + 0.17 * static_cast<double>(a))));
    for (std::size_t a = 0; a < 3; ++a) {
      double rate = truth[a][i] + 1e-6 * normal();
      for (std::size_t b = 0; b < 3; ++b) rate += seen[a][b] * truth[b][i];
      measured[a].push_back(rate);
    }
  }
  Record record = made_record("table", time, measured[0], {}, truth[0]);
  record.other_axes = {{"rate_y_radps", measured[1]}, {"rate_z_radps", measured[2]}};
  record.other_references = {truth[1], truth[2]};
  const OwnedRecords along = with_other_axes(std::vector{record});
  const Diagnosis found = diagnose({record}, {});
  for (const std::size_t a : {1U, 2U}) {
    const std::span<const double> rate = along.records[0].channels.at(a - 1).values;
    double worst = 0.0;
    for (std::size_t i = 0; i < n; ++i) worst = std::max(worst, std::abs(rate[i] - truth[a][i]));
    EXPECT_LT(worst, 6e-6) << "a few times the noise; the measured rate is 1e-3 off";
    for (const FoundEffect& each : found.effects)
      if (each.effect.channel == along.records[0].channels[a - 1].name) {
        const ModelParameter& coefficient = each.effect.parameters.at(0);
        EXPECT_NEAR(coefficient.value, seen[0][a], 4.0 * coefficient.std_error);
        EXPECT_LT(coefficient.std_error, 1e-6);
      }
  }
  EXPECT_EQ(found.effects.size(), 3U);
}

// Two axes that swing, all references late by a tenth of a second: neither axis is given a part of the other.
TEST(OtherAxes, ComeAsTheyAreWhereTheirReferencesAreLate) {
  constexpr std::size_t n = 20000;
  test::Noise normal(2);
  const auto x = [](double t) { return 0.4 * std::sin(1.3 * t); };
  const auto y = [](double t) { return 0.4 * std::cos(1.1 * t) + 0.2 * std::sin(0.31 * t); };
  std::vector<double> time, x_rate, y_rate, x_late, y_late;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = 0.02 * static_cast<double>(i);
    time.push_back(t);
    x_rate.push_back(x(t) * (1.0 + 1e-4) + 2e-3 * y(t) + 1e-6 * normal());
    y_rate.push_back(y(t) + 1e-6 * normal());
    x_late.push_back(x(t - 0.1));
    y_late.push_back(y(t - 0.1));
  }
  Record record = made_record("swing", time, x_rate, {}, x_late);
  record.other_axes = {{"rate_y_radps", y_rate}};
  record.other_references = {y_late};
  const Diagnosis found = diagnose({record}, {});
  for (const FoundEffect& each : found.effects) {
    const ModelParameter& coefficient = each.effect.parameters.at(0);
    if (each.effect.channel == "rate_y_radps") {
      EXPECT_NEAR(coefficient.value, 2e-3, 5e-6);
    } else if (each.effect.channel == "reference_rate_radps" && each.effect.form == "linear") {
      EXPECT_NEAR(coefficient.value, 1e-4, 5e-6);
    }
  }
  EXPECT_GE(found.effects.size(), 2U);
}

}  // namespace
}  // namespace ifog
