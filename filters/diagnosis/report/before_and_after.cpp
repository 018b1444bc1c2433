#include "filters/diagnosis/report/before_and_after.h"

#include "filters/diagnosis/record/figures.h"

namespace ifog {

void write_before_and_after(const std::vector<EvenError>& errors, double sample_s, Diagnosis& diagnosis) {
  std::vector<std::map<std::string, double>> before;
  std::vector<std::map<std::string, double>> after;
  std::vector<double> weight;
  for (const EvenError& error : errors) {
    before.push_back(error_figures(error.before, sample_s));
    after.push_back(error_figures(error.held_out, sample_s));
    weight.push_back(static_cast<double>(error.before.size()));
  }
  diagnosis.before = pooled(before, weight);
  diagnosis.after = pooled(after, weight);
}

}  // namespace ifog
