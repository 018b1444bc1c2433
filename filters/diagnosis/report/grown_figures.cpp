// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/grown_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"

namespace ifog {
namespace {

constexpr double kGrown = 1.02;
constexpr double kMany = 100.0;  // an RMS of so many is known to 7 %
// Of fewer, the standard errors of an RMS that chance may add.
constexpr double kByChance = 1.5;

struct Figure {
  const char* key;
  double means_s;  // 0: single samples
};

constexpr std::array<Figure, 5> kFigures = {{{"residual_rms_radps", 0.0},
                                             {"rms_0.1s_radps", 0.1},
                                             {"rms_1s_radps", 1.0},
                                             {"rms_10s_radps", 10.0},
                                             {"rms_100s_radps", 100.0}}};

// After over before; 0 where the report does not have it.
double growth_of(const Diagnosis& diagnosis, const char* key) {
  const auto before = diagnosis.before.find(key), after = diagnosis.after.find(key);
  if (before == diagnosis.before.end() || after == diagnosis.after.end() || !(before->second > 0.0))
    return 0.0;
  return after->second / before->second;
}

double count_of(const Figure& figure, const Diagnosis& diagnosis, double samples) {
  return figure.means_s > 0.0 ? samples / (diagnosis.sample_rate_hz * figure.means_s) : samples;
}

double of_10s_means(const std::vector<EvenError>& errors, SharedSamples EvenError::*of, double rate_hz) {
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(10.0 * rate_hz)));
  double variance = 0.0;
  for (const EvenError& error : errors) variance += variance_of(means_over(error.*of, count));
  return std::sqrt(variance);
}

}  // namespace

double samples_of(const std::vector<EvenError>& errors) {
  double samples = 0.0;
  for (const EvenError& error : errors) samples += static_cast<double>(error.before.size());
  return samples;
}

bool grows_over_many(const Diagnosis& diagnosis, const std::vector<EvenError>& errors) {
  return std::any_of(kFigures.begin(), kFigures.end(), [&](const Figure& figure) {
    const double count = count_of(figure, diagnosis, samples_of(errors));
    const double most = count >= kMany ? kGrown : 1.0 + kByChance / std::sqrt(2.0 * std::max(count, 1.0));
    return growth_of(diagnosis, figure.key) > most;
  });
}

std::string grown_in_words(const Diagnosis& diagnosis, double samples) {
  if (diagnosis.effects.empty()) return "";
  std::string sentence;
  bool by_chance = true;
  for (const Figure& figure : kFigures) {
    const double growth = growth_of(diagnosis, figure.key);
    const double count = count_of(figure, diagnosis, samples);
    if (growth <= kGrown) continue;
    std::array<char, 120> text{};
    if (figure.means_s > 0.0)
      std::snprintf(text.data(), text.size(), "%.3g s means grow %.3g times", figure.means_s, growth);
    else
      std::snprintf(text.data(), text.size(), "single samples grow %.3g times", growth);
    sentence += (sentence.empty() ? "" : "; ") + std::string(text.data());
    by_chance &= count < kMany;
    if (count >= kMany) continue;
    std::snprintf(text.data(), text.size(), ", but there are %.0f of them", count);
    sentence += text.data();
  }
  if (sentence.empty()) return "";
  return sentence +
         (by_chance
              ? ": slow noise that happened to run against the effects was hidden by them"
              : ": that is no chance, the model does harm there; take another capture before it is used");
}

std::string faults_in_words(const Diagnosis& diagnosis, const std::vector<EvenError>& errors) {
  constexpr double kMore = 1.05;
  if (diagnosis.effects.empty()) return "";
  const double written = of_10s_means(errors, &EvenError::written, diagnosis.sample_rate_hz);
  const double logged = of_10s_means(errors, &EvenError::logged, diagnosis.sample_rate_hz);
  if (!(logged > kMore * written)) return "";
  std::array<char, 300> text{};
  std::snprintf(
      text.data(), text.size(),
      "the daemon has the channels as they are logged: with the faults that were repaired for the fit it "
      "leaves %.2g times as much of 10 s means as without, and the figures after are those",
      logged / written);
  return text.data();
}

}  // namespace ifog
