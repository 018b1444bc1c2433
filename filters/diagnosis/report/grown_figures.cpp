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

double count_of(const Figure& figure, const Diagnosis& diagnosis, const std::vector<EvenError>& errors) {
  double samples = 0.0;
  for (const EvenError& error : errors) samples += static_cast<double>(error.before.size());
  return figure.means_s > 0.0 ? samples / (diagnosis.sample_rate_hz * figure.means_s) : samples;
}

}  // namespace

bool grows_over_many(const Diagnosis& diagnosis, const std::vector<EvenError>& errors) {
  for (const Figure& figure : kFigures)
    if (growth_of(diagnosis, figure.key) > kGrown && count_of(figure, diagnosis, errors) >= kMany)
      return true;
  return false;
}

std::string grown_in_words(const Diagnosis& diagnosis, const std::vector<EvenError>& errors) {
  if (diagnosis.effects.empty()) return "";
  std::string sentence;
  for (const Figure& figure : kFigures) {
    const double growth = growth_of(diagnosis, figure.key);
    const double count = count_of(figure, diagnosis, errors);
    if (growth <= kGrown || count >= kMany) continue;
    std::array<char, 120> text{};
    std::snprintf(text.data(), text.size(), "%s%.3g s means grow %.3g times, but there are %.0f of them",
                  sentence.empty() ? "" : "; ", figure.means_s, growth, count);
    sentence += text.data();
  }
  return sentence.empty()
             ? sentence
             : sentence + ": slow noise that happened to run against the effects was hidden by them";
}

std::string faults_in_words(const Diagnosis& diagnosis, const std::vector<EvenError>& errors) {
  constexpr double kMore = 1.05;
  double written = 0.0;
  double logged = 0.0;
  for (const EvenError& error : errors) {
    const auto count = static_cast<std::size_t>(std::max(1.0, std::round(10.0 * diagnosis.sample_rate_hz)));
    written += variance_of(means_over(error.written, count));
    logged += variance_of(means_over(error.logged, count));
  }
  if (!(std::sqrt(logged) > kMore * std::sqrt(written))) return "";
  std::array<char, 300> text{};
  std::snprintf(
      text.data(), text.size(),
      "the daemon has the channels as they are logged: with the faults that were repaired for the fit it "
      "leaves %.2g times as much of 10 s means as without, and the figures after are those",
      std::sqrt(logged / written));
  std::string sentence = text.data();
  for (const Figure& figure : kFigures) {
    const double growth = growth_of(diagnosis, figure.key);
    if (growth <= kGrown || count_of(figure, diagnosis, errors) < kMany) continue;
    if (figure.means_s > 0.0)
      std::snprintf(text.data(), text.size(), "; %.3g s means grow %.3g times by that", figure.means_s,
                    growth);
    else
      std::snprintf(text.data(), text.size(), "; single samples grow %.3g times by that", growth);
    sentence += text.data();
  }
  return sentence;
}

}  // namespace ifog
