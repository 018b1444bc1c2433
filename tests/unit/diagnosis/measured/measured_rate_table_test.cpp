// SPDX-License-Identifier: Apache-2.0
// The measured rate table: a FOG on a heated table with its reference rate (fog_rate_table), nothing told but
// the columns. Skipped, with the reason, where the capture is not there.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "filters/diagnosis/diagnose.h"
#include "tests/unit/capture/read_capture.h"

namespace ifog {
namespace {

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
