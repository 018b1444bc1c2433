// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/channel_delay.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/regression/design.h"
#include "filters/linear/least_squares.h"
#include "filters/linear/projection.h"
#include "filters/model_file/channel_names.h"

namespace ifog {
namespace {

constexpr double kLongest_s = 60.0;
constexpr double kGridFactor = 1.5;     // between delays, from a block on
constexpr double kEnoughRounds = 12.0;  // of the golden section: to a three-hundredth of the bracket

std::vector<double> delays_to_try(const BlockGrid& grid) {
  const double longest = std::min(kLongest_s, 0.1 * static_cast<double>(grid.longest()) * grid.block_s);
  std::vector<double> delays{0.0};
  for (double delay = std::max(grid.block_s, grid.fine_s); delay <= longest; delay *= kGridFactor)
    delays.push_back(delay);
  return delays;
}

bool uses(const Candidate& candidate, std::size_t channel) {
  return candidate.channel == channel || candidate.with_channel == channel;
}

// The likelihood of the rate with a channel's effects in it, as a function of that channel's delay.
class Profile {
 public:
  Profile(const BlockData& data, const std::vector<Candidate>& model, const NoiseShape& shape,
          std::size_t channel)
      : trial_(data), channel_(channel), as_logged_(data.channels[channel]), whitening_(trial_.grid, shape) {
    std::vector<Candidate> others;
    for (const Candidate& each : model) (uses(each, channel) ? mine_ : others).push_back(each);
    if (mine_.empty()) {
      Candidate linear;
      linear.channel = channel;
      mine_.push_back(linear);
    }
    Columns white = design(data, others);
    whitening_.apply(white);
    projection_.emplace(white.rightCols(white.cols() - 1));
    measured_ = white.col(0);
    projection_->take_out_of(measured_);
  }

  // Twice the log-likelihood.
  double at(double delay_s) {
    trial_.channels[channel_] = as_logged_;
    undo_delay(trial_.grid, delay_s, trial_.channels[channel_]);
    Columns columns(measured_.size(), 0);
    for (const Candidate& each : mine_) {
      const Columns more = regressors(trial_, each);
      Columns all(columns.rows(), columns.cols() + more.cols());
      all << columns, more;
      columns = std::move(all);
    }
    whitening_.apply(columns);
    projection_->take_out_of(columns);
    const Eigen::VectorXd left = left_by(columns, measured_);
    const auto n = static_cast<double>(trial_.grid.used());
    return -n * std::log(std::max(left.squaredNorm(), 1e-300) / n);
  }

 private:
  BlockData trial_;
  std::size_t channel_;
  FineChannel as_logged_;
  Whitening whitening_;
  std::vector<Candidate> mine_;
  std::optional<Projection> projection_;
  Eigen::VectorXd measured_;
};

// Golden section between two delays that enclose a maximum.
double best_between(Profile& profile, double low, double high) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double a = high - ratio * (high - low), b = low + ratio * (high - low);
  double at_a = profile.at(a), at_b = profile.at(b);
  for (int round = 0; round < static_cast<int>(kEnoughRounds); ++round) {
    if (at_a > at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - ratio * (high - low);
      at_a = profile.at(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + ratio * (high - low);
      at_b = profile.at(b);
    }
  }
  return 0.5 * (low + high);
}

// How far to go before twice the log-likelihood has fallen by one: the standard deviation of a parabola.
double width_at(Profile& profile, double delay_s, double top, double step_s) {
  double width = step_s;
  while (width < kLongest_s && top - std::min(profile.at(delay_s + width), profile.at(delay_s - width)) < 1.0)
    width *= kGridFactor;
  return width;
}

}  // namespace

void undo_delay(const BlockGrid& grid, double delay_s, FineChannel& channel) {
  const double steps = delay_s / grid.fine_s;
  if (steps == 0.0) return;
  const double whole = std::floor(steps);
  const double share = steps - whole;
  const auto moved = [&](std::vector<double>& values) {
    if (values.empty()) return;
    const std::vector<double> before = values;
    for (const BlockRange& record : grid.records) {
      const BlockRange fine = grid.fine_steps(record);
      const auto last = static_cast<std::ptrdiff_t>(fine.end) - 1;
      const auto at = [&](std::ptrdiff_t k) {
        return before[static_cast<std::size_t>(std::clamp(k, static_cast<std::ptrdiff_t>(fine.first), last))];
      };
      for (std::size_t k = fine.first; k < fine.end; ++k) {
        const auto from = static_cast<std::ptrdiff_t>(k) + static_cast<std::ptrdiff_t>(whole);
        values[k] = (1.0 - share) * at(from) + share * at(from + 1);
      }
    }
  };
  moved(channel.values);
  moved(channel.power);
}

std::optional<DelayOfChannel> most_delayed_channel(const BlockData& data, const std::vector<Candidate>& model,
                                                   const NoiseShape& shape) {
  const std::vector<double> delays = delays_to_try(data.grid);
  std::optional<DelayOfChannel> best;
  std::size_t place = 0;
  for (std::size_t c = 0; c < data.channels.size(); ++c) {
    const FineChannel& channel = data.channels[c];
    if (!names_in(channel.name).less.empty()) continue;  // follows the two it is made of
    if (static_cast<std::ptrdiff_t>(c) == data.reference || !channel.varies || channel.rotates ||
        channel.still)
      continue;
    Profile profile(data, model, shape, c);
    const double none = profile.at(0.0);
    for (std::size_t i = 1; i < delays.size(); ++i) {
      const double gain = profile.at(delays[i]) - none;
      if (gain <= 0.0 || (best && gain <= best->gain)) continue;
      best = DelayOfChannel{c, delays[i], 0.0, gain};
      place = i;
    }
  }
  if (!best) return best;
  Profile profile(data, model, shape, best->channel);
  const double none = profile.at(0.0);
  best->delay_s = best_between(profile, delays[place - 1], delays[std::min(place + 1, delays.size() - 1)]);
  const double top = profile.at(best->delay_s);
  best->gain = top - none;
  best->std_error_s = width_at(profile, best->delay_s, top, 0.1 * data.grid.fine_s);
  return best;
}

}  // namespace ifog
