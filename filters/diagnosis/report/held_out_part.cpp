#include "filters/diagnosis/report/held_out_part.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/effects/compensator.h"

namespace ifog {
namespace {

struct Part {
  std::size_t from, to;
};

Part part_of(const Record& record, const DiagnoseOptions& options) {
  const double start = record.time_s.front();
  const double span = record.time_s.back() - start;
  const auto at = [&](double share) {
    const auto place = std::lower_bound(record.time_s.begin(), record.time_s.end(), start + share * span);
    return static_cast<std::size_t>(place - record.time_s.begin());
  };
  return {at(options.fit_from), options.fit_to >= 1.0 ? record.time_s.size() : at(options.fit_to)};
}

std::vector<double> compensated(const Record& record, const Model& model) {
  Compensator compensator(model, {""});
  std::vector<std::span<const double>> columns;
  for (const std::string& name : compensator.channels()) {
    for (const RecordChannel& channel : record.channels) {
      if (channel.name == name) columns.push_back(channel.values);
    }
  }
  std::vector<double> rate(record.time_s.size());
  std::vector<double> values(columns.size());
  CompensatorInput in;
  CompensatorOutput out;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    in.dt_s = record.time_s[std::max<std::size_t>(i, 1)] - record.time_s[std::max<std::size_t>(i, 1) - 1];
    for (std::size_t c = 0; c < columns.size(); ++c) values[c] = columns[c][i];
    in.channels = values;
    in.rate_radps[0] = record.rate_radps[i];
    compensator.step(in, out);
    rate[i] = out.compensated_radps[0];
    if (!record.reference_radps.empty()) rate[i] -= record.reference_radps[i];
  }
  return rate;
}

}  // namespace

std::vector<Record> fitted_part(const std::vector<Record>& records, const DiagnoseOptions& options) {
  std::vector<Record> parts = records;
  for (Record& record : parts) {
    const Part part = part_of(record, options);
    const std::size_t n = part.to - part.from;
    record.time_s = record.time_s.subspan(part.from, n);
    record.rate_radps = record.rate_radps.subspan(part.from, n);
    if (!record.reference_radps.empty())
      record.reference_radps = record.reference_radps.subspan(part.from, n);
    for (RecordChannel& channel : record.channels) channel.values = channel.values.subspan(part.from, n);
  }
  return parts;
}

void judge(const std::vector<Record>& records, const DiagnoseOptions& options, Diagnosis& diagnosis) {
  Model model;
  add_to_model(diagnosis, "", model);
  for (Effect& effect : model.effects) effect.axis.clear();
  std::vector<std::map<std::string, double>> before;
  std::vector<std::map<std::string, double>> after;
  std::vector<double> weight;
  for (const Record& record : records) {
    const Part part = part_of(record, options);
    const std::vector<double> raw = error_of(record);
    const std::vector<double> left = compensated(record, model);
    // Each judged piece on its own: what lies between them was fitted.
    for (const Part judged : {Part{0, part.from}, Part{part.to, record.time_s.size()}}) {
      if (judged.to - judged.from < 32) continue;
      Record piece;
      piece.name = record.name;
      piece.time_s = record.time_s.subspan(judged.from, judged.to - judged.from);
      const double sample_s = 1.0 / diagnosis.sample_rate_hz;
      const auto of = [&](const std::vector<double>& all) {
        const std::vector<double> values(all.begin() + static_cast<std::ptrdiff_t>(judged.from),
                                         all.begin() + static_cast<std::ptrdiff_t>(judged.to));
        return error_figures(on_even_grid(piece, sample_s, values), sample_s);
      };
      before.push_back(of(raw));
      after.push_back(of(left));
      weight.push_back(static_cast<double>(judged.to - judged.from));
    }
  }
  if (before.empty()) return;
  diagnosis.before = pooled(before, weight);
  diagnosis.after = pooled(after, weight);
}

}  // namespace ifog
