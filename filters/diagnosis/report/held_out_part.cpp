// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/held_out_part.h"

#include <cmath>

#include "filters/diagnosis/record/compensated_error.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/diagnosis/report/before_and_after.h"

namespace ifog {

void judge(const std::vector<Record>& records, const TimeShare& fitted, Diagnosis& diagnosis) {
  Model model;
  add_to_model(diagnosis, "", model);
  const double sample_s = 1.0 / diagnosis.sample_rate_hz;
  std::vector<std::map<std::string, double>> before;
  std::vector<std::map<std::string, double>> after;
  std::vector<double> weight;
  double samples = 0.0, bias_before = 0.0, bias_after = 0.0, count = 0.0;
  for (const Record& record : records) {
    const SampleRange part = samples_in(record, fitted);
    const Samples raw = error_of(record);
    const Samples left = compensated_error(record, model);
    // Each judged piece on its own: what lies between them was fitted.
    for (const SampleRange judged : {SampleRange{0, part.from}, SampleRange{part.to, record.time_s.size()}}) {
      if (judged.size() < 32) continue;
      const Record piece = part_of(record, judged);
      const auto of = [&](std::span<const double> all) {
        return error_figures(on_even_grid(piece, sample_s, all.subspan(judged.from, judged.size())),
                             sample_s);
      };
      before.push_back(of(raw));
      after.push_back(of(left));
      weight.push_back(static_cast<double>(judged.size()));
      samples += static_cast<double>(judged.size());
      for (std::size_t i = judged.from; i < judged.to; ++i) {
        if (!std::isfinite(raw[i]) || !std::isfinite(left[i])) continue;
        bias_before += raw[i];
        bias_after += left[i];
        count += 1.0;
      }
    }
  }
  if (before.empty()) return;
  diagnosis.before = pooled(before, weight);
  diagnosis.after = pooled(after, weight);
  if (!records.front().reference_radps.empty() && count > 0.0) {
    diagnosis.before["bias_radps"] = bias_before / count;
    diagnosis.after["bias_radps"] = bias_after / count;
  }
  if (const std::string words = grown_in_words(diagnosis, samples); !words.empty())
    diagnosis.remarks.push_back("on what was kept back to judge " + words);
}

}  // namespace ifog
