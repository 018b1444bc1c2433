// SPDX-License-Identifier: Apache-2.0
#include "filters/model_file/kept_noise.h"

#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>

#include "filters/model_file/toml_file.h"
#include "filters/model_file/toml_text.h"

namespace ifog {
namespace {

constexpr const char* kSchema = "ifog.noise/2";
// Largest variance in (rad/s)^2, square or count.
constexpr double kMostKept = 1e18;

class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : name_(name), table_(parse_toml(text, name)) {}

  [[nodiscard]] std::string words(const char* key) const {
    const auto value = table_[key].value_exact<std::string>();
    if (!value) fail(key, "expected a string");
    return *value;
  }
  [[nodiscard]] std::string words_or(const char* key, const char* otherwise) const {
    return table_.contains(key) ? words(key) : otherwise;
  }
  [[nodiscard]] double at_least(const char* key, double least) const {
    return plausible(key, table_[key].value<double>(), least);
  }
  void numbers(const char* key, double least, std::span<double> out) const {
    const toml::array* const array = table_[key].as_array();
    if (array == nullptr || array->size() != out.size())
      fail(key, "expected a list of " + std::to_string(out.size()) + " numbers");
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = plausible(key, (*array)[i].value<double>(), least);
  }
  [[noreturn]] void fail(const char* key, const std::string& complaint) const {
    const toml::node* const node = table_.get(key);
    const std::string line = node != nullptr ? ":" + std::to_string(node->source().begin.line) : "";
    throw std::runtime_error(name_ + line + ": " + key + ": " + complaint);
  }

 private:
  [[nodiscard]] double plausible(const char* key, std::optional<double> value, double least) const {
    // NaN fails this comparison.
    if (!value || !(*value >= least && *value <= kMostKept))
      fail(key, "expected a number from " + toml_number(least) + " to " + toml_number(kMostKept));
    return *value;
  }

  std::string name_;
  toml::table table_;
};

}  // namespace

std::string kept_noise_text(const KeptNoise& kept) {
  const LearnedNoise& noise = kept.noise;
  std::string text =
      "# What ifogd has learned of this sensor's noise at rest. Delete it, and it is learned again.\n";
  const auto line = [&text](const char* key, const std::string& value, const char* meaning = "") {
    text += std::string(key) + " = " + value + meaning + "\n";
  };
  line("schema", toml_quoted(kSchema));
  line("sensor", toml_quoted(kept.sensor));
  line("driver", toml_quoted(kept.driver));
  line("axes", std::to_string(kept.axes));
  line("sample_rate_hz", toml_number(kept.sample_rate_hz));
  line("learned", toml_quoted(kept.learned), "  # UTC, the last rest that is in it");
  line("model", toml_quoted(noise.model.data()), "  # that corrected it, \"\": none");
  line("process_noise", toml_number(noise.process_noise), "  # of a random walk, (rad/s)^2/s");
  line("measurement_noise", toml_number(noise.measurement_noise), "  # per sample, (rad/s)^2");
  line("noise", toml_list(std::span(noise.noise).first(static_cast<std::size_t>(kept.axes))),
       "  # the same by axis");
  line("samples", toml_number(noise.samples), "  # at rest");
  return text;
}

KeptNoise parse_kept_noise(std::string_view text, const std::string& name) {
  const Reader in(text, name);
  if (in.words("schema") != kSchema) in.fail("schema", "expected \"" + std::string(kSchema) + "\"");
  KeptNoise kept;
  kept.sensor = in.words("sensor");
  kept.driver = in.words("driver");
  const double axes = in.at_least("axes", 1.0);
  if (axes != std::floor(axes) || axes > kMaxAxes)
    in.fail("axes", "expected 1 to " + std::to_string(kMaxAxes));
  kept.axes = static_cast<int>(axes);
  // A file that does not name its model counts as another model's.
  kept.noise.set_model(in.words_or("model", "?"));
  // Smallest normal number, so that quotients are finite.
  constexpr double kPositive = 1e-300;
  kept.sample_rate_hz = in.at_least("sample_rate_hz", kPositive);
  kept.learned = in.words("learned");
  kept.noise.process_noise = in.at_least("process_noise", kPositive);
  kept.noise.measurement_noise = in.at_least("measurement_noise", kPositive);
  in.numbers("noise", kPositive, std::span(kept.noise.noise).first(static_cast<std::size_t>(kept.axes)));
  kept.noise.samples = in.at_least("samples", 1.0);
  return kept;
}

KeptNoise read_kept_noise(const std::string& path) { return parse_kept_noise(read_toml_text(path), path); }

}  // namespace ifog
