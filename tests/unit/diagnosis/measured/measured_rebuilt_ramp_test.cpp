// SPDX-License-Identifier: Apache-2.0
// The measured ramp without its channel: blueseis_bs1_ramp as if nobody had logged ramp_counts. Fitted on the
// first half of the record; judged on the second as the daemon would meet it, its phase unknown. The counts
// are the oracle for k. Skipped, with the reason, where the capture is not there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "filters/diagnosis/diagnose.h"
#include "filters/effects/compensator.h"
#include "filters/effects/form.h"
#include "filters/units/field_units.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/diagnosis/measured/blueseis.h"

namespace ifog {
namespace {

using MeasuredRebuiltRamp = MeasuredHalf<false>;

const Measured* measured() { return measured_half<false>(); }

struct SecondHalf {
  std::vector<double> left;  // rad/s
  std::size_t unknown = 0;   // samples that were flagged
};

// From the middle on, by a compensator that begins there, with `rotation` (rad/s by sample) added to the
// rate.
SecondHalf compensated(const std::vector<double>* rotation) {
  const Capture& capture = measured()->capture;
  Compensator compensator(measured()->model, {""});
  SecondHalf out;
  CompensatorInput in;
  CompensatorOutput corrected;
  for (std::size_t i = capture.size() / 2; i < capture.size(); ++i) {
    in.dt_s = capture.time_s[i] - capture.time_s[i - 1];
    in.rate_radps[0] = capture.rate_radps[0][i] + (rotation ? (*rotation)[out.left.size()] : 0.0);
    compensator.step(in, corrected);
    out.left.push_back(corrected.compensated_radps[0]);
    if ((corrected.flags & kRampUnknown) == 0) continue;
    ++out.unknown;
    EXPECT_EQ(corrected.correction_radps[0], 0.0);
  }
  return out;
}

TEST_F(MeasuredRebuiltRamp, IsFoundAlone) {
  int rebuilt = 0;
  for (const FoundEffect& found : measured()->diagnosis.effects) {
    const std::optional<Form> form = form_named(found.effect.form);
    rebuilt += form == Form::kRebuiltRamp;
    EXPECT_TRUE(form == Form::kRebuiltRamp || !form || !carries_over(*form)) << found.effect.form;
  }
  EXPECT_EQ(rebuilt, 1);
}

// The counter's cycles over the angle of the rate, of the half that was fitted.
TEST_F(MeasuredRebuiltRamp, KIsThatOfTheCounter) {
  const Capture& capture = measured()->capture;
  const CaptureColumn& ramp = capture.channels.front();
  ASSERT_EQ(ramp.name, "ramp_counts");
  double cycles = 0.0;
  double angle = 0.0;
  for (std::size_t i = 1; i < capture.size() / 2; ++i) {
    const double step = ramp.values[i] - ramp.values[i - 1];
    cycles += (step - kRampPeriod * std::round(step / kRampPeriod)) / kRampPeriod;
    angle += capture.rate_radps[0][i] * (capture.time_s[i] - capture.time_s[i - 1]);
  }
  for (const FoundEffect& found : measured()->diagnosis.effects) {
    if (found.effect.form != "rebuilt_ramp") continue;
    EXPECT_NEAR(parameter(found.effect, "cycles_per_rad") / std::abs(cycles / angle), 1.0, 5e-6);
  }
}

TEST_F(MeasuredRebuiltRamp, LeavesWhatIsPromisedOnTheSecondHalf) {
  const SecondHalf second = compensated(nullptr);
  EXPECT_LE(deviation(second.left), 445e-9);
  EXPECT_LE(allan(second.left, 20), 0.0115 * kDegreePerHour);
  EXPECT_LE(allan(second.left, 200), 0.0036 * kDegreePerHour);
  EXPECT_GT(second.unknown, 0U);
  EXPECT_LE(second.unknown, 200U);  // one second
  std::printf("%.2f nrad/s, Allan %.5f and %.5f °/h at 0.1 and 1 s, %zu samples before the phase is known\n",
              1e9 * deviation(second.left), allan(second.left, 20) / kDegreePerHour,
              allan(second.left, 200) / kDegreePerHour, second.unknown);
}

TEST_F(MeasuredRebuiltRamp, IsTransparentToRotation) {
  const double earth = 5.4e-5;  // rad/s
  expect_transparent([](const std::vector<double>* rotation) { return compensated(rotation).left; }, kStep_s,
                     {0.0, -earth, -2.0 * earth, 20.0 * earth, 8.6e-3});
}

// The measured rate table: a FOG on a heated table with its reference rate (fog_rate_table), nothing told but
// the columns. Skipped, with the reason, where the capture is not there.

constexpr const char* kPath = IFOG_SHARED_DATA "/fog_rate_table.csv.gz";

// The owners' own fit leaves 5.7e-4 rad/s RMS on the data it was fitted to; here ten contiguous blocks take
// turns at being held out.
TEST(MeasuredRateTable, ScaleFactorItsNonlinearityAndTemperature) {
  if (!std::filesystem::exists(kPath))
    GTEST_SKIP() << "no " << kPath << ": the measured captures belong beside the project, in ../shared/data";
  const Capture capture = read_capture(kPath);
  Record record;
  record.name = kPath;
  record.time_s = capture.time_s;
  record.rate_radps = capture.rate_radps[0];
  record.reference_radps = capture.reference_rate_radps[0];
  for (const CaptureColumn& column : capture.channels)
    record.channels.push_back({column.name, column.values});
  const Diagnosis d = diagnose({record}, {});
  EXPECT_LT(d.after.at("residual_rms_radps"), 3.5e-4);
  EXPECT_GT(d.before.at("residual_rms_radps"), 1e-2);
  const auto found = [&](const std::string& form, const std::string& channel, const std::string& with) {
    return std::any_of(d.effects.begin(), d.effects.end(), [&](const FoundEffect& each) {
      const Effect& effect = each.effect;
      return effect.form == form && effect.channel.starts_with(channel) &&
             effect.with_channel.starts_with(with);
    });
  };
  EXPECT_TRUE(found("linear", "reference_rate", ""));
  EXPECT_TRUE(found("cubic", "reference_rate", ""));
  EXPECT_TRUE(found("product", "temperature", "reference_rate"));
}

}  // namespace
}  // namespace ifog
