// SPDX-License-Identifier: Apache-2.0
#include "tools/report/coefficients.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "filters/units/field_units.h"
#include "tools/report/text.h"

namespace ifog::report {
namespace {

std::string value_and_error(double value, double error) {
  // Digits up to the second digit of the error.
  const int digits =
      error > 0.0 && value > 0.0
          ? std::clamp(static_cast<int>(std::floor(std::log10(value)) - std::floor(std::log10(error))) + 2, 2,
                       8)
          : 3;
  return fmt::format("{:.{}g} ± {:.2g}", value, digits, error);
}

}  // namespace

const std::vector<NamedCoefficient>& named_coefficients() {
  static const std::vector<NamedCoefficient> kNamed{
      {"Q", "quantisation", "rad", "arcsec", 1.0 / kArcsecond, &NoiseCoefficients::Q, &NoiseTerms::Q},
      {"N", "angle random walk", "rad/s/√Hz", "°/√h", 1.0 / kDegreePerRootHour, &NoiseCoefficients::N,
       &NoiseTerms::N},
      {"B", "bias instability", "rad/s", "°/h", 1.0 / kDegreePerHour, &NoiseCoefficients::B, &NoiseTerms::B},
      {"K", "rate random walk", "rad/s²/√Hz", "°/h/√h", 1.0 / kDegreePerHourPerRootHour,
       &NoiseCoefficients::K, &NoiseTerms::K},
      {"R", "rate ramp", "rad/s²", "°/h/h", 1.0 / kDegreePerHourPerHour, &NoiseCoefficients::R,
       &NoiseTerms::R}};
  return kNamed;
}

std::string bound_text(double upper) {
  // Rounds with the library and adds one in the last place if the result is too small.
  std::string text = fmt::format("{:.2g}", upper);
  const double shown = std::strtod(text.c_str(), nullptr);
  if (!(upper > 0.0) || shown >= upper) return text;
  return fmt::format("{:.2g}", shown + std::pow(10.0, std::floor(std::log10(upper)) - 1.0));
}

std::string coefficient_lines(const NoiseCoefficients& found) {
  std::string lines;
  for (const NamedCoefficient& named : named_coefficients()) {
    const NoiseCoefficient& c = found.*named.member;
    lines += fmt::format("  {}  {:<18} ", named.letter, named.meaning);
    lines += c.present ? fmt::format("{:<24} {:<7}  ({:.4g} ± {:.2g} {})",
                                     value_and_error(c.value * named.factor, c.std_error * named.factor),
                                     named.unit, c.value, c.std_error, named.si_unit)
                       : fmt::format("not seen; below {} {}", bound_text(c.upper * named.factor), named.unit);
    if (c.present && c.from_s > 0.0)
      lines += fmt::format("  from {:.3g} s on; below, a filter holds the curve down", c.from_s);
    lines += '\n';
  }
  return lines;
}

nlohmann::ordered_json coefficients_json(const NoiseCoefficients& found) {
  auto out = nlohmann::ordered_json::object();
  for (const NamedCoefficient& named : named_coefficients()) {
    const NoiseCoefficient& c = found.*named.member;
    out[named.letter] = {{"value", c.value},      {"std_error", c.std_error}, {"upper", c.upper},
                         {"unit", named.si_unit}, {"present", c.present},     {"from_tau_s", c.from_s}};
  }
  return out;
}

nlohmann::ordered_json markov_json(const std::optional<MarkovNoise>& found) {
  if (!found || !found->present) return nullptr;
  const MarkovNoise& markov = *found;
  return {{"sigma_radps", markov.sigma_radps},
          {"correlation_s", markov.correlation_s},
          {"lower_s", markov.lower_s},
          {"upper_s", markov.upper_s},
          {"K", markov.walk},
          {"K_until_s", markov.walk_until_s}};
}

nlohmann::ordered_json noise_changes_json(std::span<const NoiseChange> changes) {
  auto out = nlohmann::ordered_json::array();
  for (const NoiseChange& change : changes)
    out.push_back({{"from_s", change.from_s},
                   {"to_s", change.to_s},
                   {"times", change.times},
                   {"low_hz", change.range_hz.low},
                   {"high_hz", change.range_hz.high}});
  return out;
}

}  // namespace ifog::report
