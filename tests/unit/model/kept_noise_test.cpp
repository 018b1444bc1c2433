// SPDX-License-Identifier: Apache-2.0
// Learned noise as a file: what is written reads back to the bit, and what is none is refused by line.
#include "filters/model_file/kept_noise.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

KeptNoise some() {
  KeptNoise kept;
  kept.sensor = "nose";
  kept.driver = "kvh\"1750\\";
  kept.axes = 2;
  kept.sample_rate_hz = 1000.0 / 3.0;
  kept.learned = "2026-01-31T13:05:09Z";
  kept.noise.process_noise = 1.2e-15 / 7.0;
  kept.noise.measurement_noise = 3e-10 / 7.0;
  kept.noise.noise = {1e-10 / 3.0, 2e-10 / 3.0, 0.0};
  kept.noise.samples = 8192.0;
  kept.noise.set_model("3f9c21a0b7de");
  return kept;
}

std::string noise_complaint(const std::string& text) {
  return test::refusal([&] { (void)parse_kept_noise(text, "f.toml"); }, "");
}

std::string noise_with(const std::string& from, const std::string& to) {
  std::string text = kept_noise_text(some());
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(KeptNoise, ReadsBackToTheBit) {
  const auto all = [](const KeptNoise& k) {
    return std::tie(k.sensor, k.driver, k.axes, k.sample_rate_hz, k.learned, k.noise.process_noise,
                    k.noise.measurement_noise, k.noise.noise, k.noise.samples, k.noise.model);
  };
  const KeptNoise kept = some(), read = parse_kept_noise(kept_noise_text(kept), "f.toml");
  EXPECT_EQ(all(read), all(kept));
}

// As written before the model was said.
TEST(KeptNoise, OfNoModelThatIsSaidItIsOfAnother) {
  const KeptNoise read = parse_kept_noise(noise_with("model = \"3f9c21a0b7de\"", ""), "f.toml");
  EXPECT_FALSE(read.noise.is_of(""));
  EXPECT_FALSE(read.noise.is_of("3f9c21a0b7de"));
}

TEST(KeptNoise, RefusesByLineWhatIsNone) {
  EXPECT_EQ(noise_complaint(noise_with("ifog.noise/2", "ifog.noise/3")),
            "f.toml:2: schema: expected \"ifog.noise/2\"");
  EXPECT_EQ(noise_complaint(noise_with("axes = 2", "axes = 4")), "f.toml:5: axes: expected 1 to 3");
  EXPECT_TRUE(test::has(noise_complaint(noise_with("axes = 2", "axes = 3")), "expected a list of 3"));
  for (const char* wrong : {"nan", "inf", "-1", "0", "\"1\"", "[1]"})
    EXPECT_TRUE(test::has(noise_complaint(noise_with("samples = 8192", std::string("samples = ") + wrong)),
                          "samples: expected a number"))
        << wrong;
  EXPECT_EQ(noise_complaint(noise_with("sensor = \"nose\"\n", "")), "f.toml: sensor: expected a string");
  // Cut off before its last line it is no shorter record of noise.
  const std::string whole = kept_noise_text(some());
  for (std::size_t length = 0; length < whole.rfind('\n', whole.size() - 2); length += 7)
    EXPECT_NE(noise_complaint(whole.substr(0, length)), "") << length;
}

}  // namespace
}  // namespace ifog
