// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/step_means.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "filters/series/mapped_file.h"
#include "filters/series/series_view.h"

namespace ifog {
namespace {

StepStarts starts_of(const Record& record, double fine_s, std::size_t steps) {
  StepStarts first;
  first.reserve(steps + 1);
  for_each_piece(record.time_s, 0, record.time_s.size(), [&](std::span<const double> some, std::size_t from) {
    for (std::size_t i = from; i < from + some.size(); ++i) {
      const std::size_t k = std::min(fine_index(record, i, fine_s), steps - 1);
      while (first.size() <= k) first.push_back(i);
    }
  });
  first.resize(steps + 1, record.time_s.size());
  return first;
}

// Where the record has no rows the channel went on: linear between the steps beside such a hole. Held there
// and then jumping, its derivative would be that of no temperature.
void bridge_holes(const StepStarts& first, std::span<double> means) {
  std::size_t last = 0;
  for (std::size_t k = 0; k < means.size(); ++k) {
    if (first[k] == first[k + 1]) continue;
    for (std::size_t j = last + 1; j < k; ++j)
      means[j] = means[last] +
                 (means[k] - means[last]) * static_cast<double>(j - last) / static_cast<double>(k - last);
    last = k;
  }
}

}  // namespace

std::size_t fine_index(const Record& record, std::size_t i, double fine_s) {
  return static_cast<std::size_t>(std::floor((record.time_s[i] - record.time_s[0]) / fine_s + 0.5));
}

std::shared_ptr<const StepStarts> step_starts(const Record& record, double fine_s, std::size_t steps) {
  return known_or(record.known.get(), {"step starts", record.time_s, fine_s, steps},
                  [&] { return starts_of(record, fine_s, steps); });
}

std::shared_ptr<const StepMeans> StepMeansOf::column(std::span<const double> values) const {
  return known_or(known_.get(), asked(values), [&] { return worked_out(values); });
}

void StepMeansOf::prepare(std::span<const RecordChannel> channels) const {
  if (!known_) return;
  for (const RecordChannel& channel : channels)
    known_->prepare(asked(channel.values), [&] { return worked_out(channel.values); });
}

StepMeans StepMeansOf::worked_out(std::span<const double> values) const {
  StepMeans out;
  auto& [means, power] = out;
  const std::size_t steps = starts_.size() - 1;
  bool known = false;  // steps before the first value hold that
  double held = 0.0;
  constexpr std::size_t kLookedUp = std::size_t{1} << 17U;
  for (std::size_t k = 0, looked_up = 0; k < steps; ++k) {
    if (starts_[k] >= looked_up) {
      looked_up = std::min(starts_[k] + kLookedUp, values.size());
      expect_reading(values.data() + starts_[k], (looked_up - starts_[k]) * sizeof(double));
    }
    double sum = 0.0, square = 0.0;
    std::uint32_t count = 0;
    for (std::size_t i = starts_[k]; i < starts_[k + 1]; ++i) {
      if (!std::isfinite(values[i])) continue;
      sum += values[i];
      square += values[i] * values[i];
      ++count;
    }
    if (count && !known) {
      held = sum / count;
      std::fill(means.begin(), means.end(), held);
    }
    if (count) held = sum / count, known = true;
    means.push_back(held);
    if (with_power_) power.push_back(count ? std::max(0.0, square / count - held * held) : 0.0);
  }
  bridge_holes(starts_, means);
  return out;
}

}  // namespace ifog
