// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/report.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/diagnosis/record/compensated_error.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/series/finite_sum.h"
#include "filters/units/told_time.h"

namespace ifog {

void write_before_and_after(const std::vector<EvenError>& errors, double sample_s, bool with_bias,
                            Diagnosis& diagnosis) {
  std::vector<std::map<std::string, double>> before, written, held_out;
  std::vector<double> weight;
  for (const EvenError& error : errors) {
    before.push_back(error_figures(*error.before, sample_s));
    const auto figures_of = [&](const SharedSamples& after) {
      return after == error.before ? before.back() : error_figures(*after, sample_s);
    };
    written.push_back(figures_of(error.written));
    held_out.push_back(figures_of(error.held_out));
    weight.push_back(static_cast<double>(error.before->size()));
  }
  const auto add_mean = [&](SharedSamples EvenError::*of, std::map<std::string, double>& figures) {
    double sum = 0.0, count = 0.0;
    for (const EvenError& error : errors) {
      const FiniteSum mine = finite_sum(*(error.*of));
      sum += mine.sum, count += mine.count;
    }
    if (count > 0.0) figures["bias_radps"] = sum / count;
  };
  diagnosis.before = pooled(before, weight);
  diagnosis.after = pooled(written, weight);
  for (const auto& [name, value] : pooled(held_out, weight)) {
    double& figure = diagnosis.after[name];
    if (std::abs(value) > std::abs(figure)) figure = value;
  }
  if (!with_bias) return;
  add_mean(&EvenError::before, diagnosis.before);
  add_mean(&EvenError::written, diagnosis.after);
}

void balance_shares(std::size_t jointly, Diagnosis& diagnosis) {
  const std::size_t count = std::min(jointly, diagnosis.effects.size());
  const double left = std::clamp(1.0 - diagnosis.unexplained.fraction, 0.0, 1.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += diagnosis.effects[i].variance_explained;
  if (sum <= left) return;
  for (std::size_t i = 0; i < count; ++i) diagnosis.effects[i].variance_explained *= left / sum;
}

namespace {

constexpr double kGrown = 1.02;
constexpr double kMany = 100.0;  // an RMS of so many values is accurate to 7 %
// With fewer means: standard errors by which an RMS may increase by chance.
constexpr double kByChance = 1.5;

struct Growth {
  double means_s, times, count;  // means_s: 0 for samples
};

// RMS figures that have increased. samples: number of samples.
std::vector<Growth> growths_of(const Diagnosis& diagnosis, double samples) {
  std::vector<Growth> found;
  for (const auto& [key, means_s] : {std::pair{"residual_rms_radps", 0.0},
                                     {"rms_0.1s_radps", 0.1},
                                     {"rms_1s_radps", 1.0},
                                     {"rms_10s_radps", 10.0},
                                     {"rms_100s_radps", 100.0}}) {
    const auto before = diagnosis.before.find(key), after = diagnosis.after.find(key);
    if (before == diagnosis.before.end() || after == diagnosis.after.end() || !(before->second > 0.0))
      continue;
    const double times = after->second / before->second;
    const double count = means_s > 0.0 ? samples / (diagnosis.sample_rate_hz * means_s) : samples;
    if (times > kGrown) found.push_back({means_s, times, count});
  }
  return found;
}

}  // namespace

double samples_of(const std::vector<EvenError>& errors) {
  double samples = 0.0;
  for (const EvenError& error : errors) samples += static_cast<double>(error.before->size());
  return samples;
}

bool grows_over_many(const Diagnosis& diagnosis, const std::vector<EvenError>& errors) {
  return std::ranges::any_of(growths_of(diagnosis, samples_of(errors)), [](const Growth& growth) {
    return growth.count >= kMany ||
           growth.times > 1.0 + kByChance / std::sqrt(2.0 * std::max(growth.count, 1.0));
  });
}

std::string grown_in_words(const Diagnosis& diagnosis, double samples) {
  if (diagnosis.effects.empty()) return "";
  std::string sentence;
  bool by_chance = true;
  for (const auto& [means_s, times, count] : growths_of(diagnosis, samples)) {
    sentence += (sentence.empty() ? "" : "; ") +
                (means_s > 0.0 ? formatted("%.3g s means grow %.3g times", means_s, times)
                               : formatted("single samples grow %.3g times", times));
    by_chance &= count < kMany;
    if (count < kMany) sentence += formatted(", but there are %.0f of them", count);
  }
  if (sentence.empty()) return "";
  return sentence +
         (by_chance
              ? ": within chance for so few means"
              : ": that is no chance, the model does harm there; take another capture before it is used");
}

void judge(const std::vector<Record>& records, const TimeShare& fitted, Diagnosis& diagnosis) {
  Model model;
  add_to_model(diagnosis, "", model);
  const double sample_s = 1.0 / diagnosis.sample_rate_hz;
  std::vector<EvenError> judged;
  for (const Record& record : records) {
    const Stretch part = samples_in(record, fitted);
    const Samples raw = error_of(record);
    const Samples left = compensated_error(record, model);
    // The two parts outside the fitted one, separately.
    for (const Stretch range : {Stretch{0, part.begin}, Stretch{part.end, record.time_s.size()}}) {
      if (range.size() < 32) continue;
      const Record piece = part_of(record, range);
      const auto of = [&](std::span<const double> all) {
        return std::make_shared<const Samples>(on_even_grid(piece, sample_s, range.of(all)));
      };
      EvenError& error = judged.emplace_back();
      error.before = of(raw);
      error.written = error.held_out = of(left);
    }
  }
  if (judged.empty()) return;
  write_before_and_after(judged, sample_s, !records.front().reference_radps.empty(), diagnosis);
  if (const std::string words = grown_in_words(diagnosis, samples_of(judged)); !words.empty())
    diagnosis.remarks.push_back("on what was kept back to judge " + words);
}

}  // namespace ifog
