// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/checks/channel_delay.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/diagnosis/regression/design.h"
#include "filters/linear/least_squares.h"
#include "filters/linear/projection.h"
#include "filters/model_file/channel_names.h"

namespace ifog {
namespace {

constexpr double kLongest_s = 60.0;
constexpr double kGridFactor = 1.5;     // between delays, from a block on
constexpr double kEnoughRounds = 12.0;  // of the golden section: to a three-hundredth of the bracket

// Of two coefficients that are one law's, the second; as the search asks of a natural pair.
constexpr double kSecondOfPair = 6.0;

// Ascending, with 0 among them. early: those as well at which a channel says what will be.
std::vector<double> delays_to_try(const BlockGrid& grid, bool early) {
  const double longest = std::min(kLongest_s, 0.1 * static_cast<double>(grid.longest()) * grid.block_s);
  std::vector<double> delays{0.0};
  for (double delay = std::max(grid.block_s, grid.fine_s); delay <= longest; delay *= kGridFactor) {
    delays.push_back(delay);
    if (early) delays.push_back(-delay);
  }
  std::sort(delays.begin(), delays.end());
  return delays;
}

using Law = std::vector<Candidate>;  // effects that are one hypothesis together

// A lag may have been a delay.
Law in_time(Law law) {
  for (Candidate& each : law) {
    if (each.form == Form::kLagged) each.form = Form::kLinear;
    if (each.form == Form::kProduct && each.with_form == Form::kLagged) each.with_form = Form::kLinear;
    if (each.form == Form::kLinear || each.form == Form::kProduct)
      each.time_constant_s = each.second_time_constant_s = 0.0;
  }
  return law;
}

// What a channel may do that is in no effect yet: act by itself, or through what the grammar multiplies it
// with.
class Offers {
 public:
  explicit Offers(const BlockData& data) : data_(data), pairs_(natural_pairs(data)) {
    for (const Candidate& each : library(data))
      if (is_plain_product(each)) products_.push_back(each);
  }

  [[nodiscard]] std::vector<Law> of(std::size_t channel, const std::vector<Candidate>& model) const {
    Candidate linear;
    linear.channel = channel;
    std::vector<Law> laws{{linear}};
    if (!data_.channels[channel].environment()) return laws;
    for (const Candidate& each : products_)
      if (each.uses(channel)) laws.push_back({each});
    for (const Candidate& each : products_of(data_, channel)) {
      const std::size_t other = each.channel == channel ? each.with_channel : each.channel;
      const bool has_effect =
          std::any_of(model.begin(), model.end(), [&](const Candidate& known) { return known.uses(other); });
      if (has_effect) laws.push_back({each});
    }
    for (const NaturalPair& each : pairs_)
      if (is_plain_product(each.second) && each.second.uses(channel))
        laws.push_back({each.first, each.second});
    return laws;
  }

 private:
  static bool is_plain_product(const Candidate& each) {
    return each.form == Form::kProduct && each.with_form == Form::kLinear && each.time_constant_s == 0.0;
  }

  const BlockData& data_;
  std::vector<NaturalPair> pairs_;
  std::vector<Candidate> products_;
};

// The likelihood of the rate with a channel's effects in it, as a function of that channel's delay.
class Profile {
 public:
  Profile(const BlockData& data, const std::vector<Candidate>& model, const NoiseShape& shape,
          const Offers& offers, std::size_t channel)
      : trial_(data), channel_(channel), as_logged_(data.channels[channel]), whitening_(trial_.grid, shape) {
    std::vector<Candidate> others;
    Law mine;
    for (const Candidate& each : model) (each.uses(channel) ? mine : others).push_back(each);
    if (mine.empty()) {
      laws_ = offers.of(channel, others);
    } else {
      laws_.push_back(mine);
      if (Law plain = in_time(mine); !std::equal(plain.begin(), plain.end(), mine.begin(), same))
        laws_.push_back(std::move(plain));
    }
    for (Law& law : laws_) {
      std::erase_if(law, [&](const Candidate& each) { return is_among(others, each); });
      for (const Candidate& each : law)
        if (!is_among(tried_, each)) tried_.push_back(each);
    }
    Columns white = design(data, others);
    whitening_.apply(white);
    projection_.emplace(white.rightCols(white.cols() - 1));
    measured_ = white.col(0);
    projection_->take_out_of(measured_);
  }

  // Twice the log-likelihood of the best law, less what it costs.
  double at(double delay_s) {
    trial_.channels[channel_] = as_logged_;
    undo_delay(trial_.grid, delay_s, trial_.channels[channel_]);
    Columns columns(measured_.size(), static_cast<Eigen::Index>(tried_.size()));
    for (std::size_t i = 0; i < tried_.size(); ++i)
      columns.col(static_cast<Eigen::Index>(i)) = regressors(trial_, tried_[i]).col(0);
    whitening_.apply(columns);
    projection_->take_out_of(columns);
    double best = -std::numeric_limits<double>::infinity();
    for (const Law& law : laws_) best = std::max(best, worth(law, columns));
    return best;
  }

 private:
  static bool same(const Candidate& one, const Candidate& other) {
    return one.same_shape(other) && one.time_constant_s == other.time_constant_s &&
           one.second_time_constant_s == other.second_time_constant_s;
  }
  static bool is_among(const std::vector<Candidate>& all, const Candidate& candidate) {
    return std::any_of(all.begin(), all.end(),
                       [&](const Candidate& other) { return same(other, candidate); });
  }

  [[nodiscard]] double worth(const Law& law, const Columns& columns) const {
    Columns mine(columns.rows(), static_cast<Eigen::Index>(law.size()));
    double cost = law.empty() ? 0.0 : kSecondOfPair * static_cast<double>(law.size() - 1);
    for (std::size_t i = 0; i < law.size(); ++i) {
      const auto place = std::find_if(tried_.begin(), tried_.end(),
                                      [&](const Candidate& each) { return same(each, law[i]); });
      mine.col(static_cast<Eigen::Index>(i)) = columns.col(static_cast<Eigen::Index>(place - tried_.begin()));
      cost += complexity(law[i]);
    }
    const Eigen::VectorXd left = left_by(mine, measured_);
    const auto n = static_cast<double>(trial_.grid.used());
    return -n * std::log(std::max(left.squaredNorm(), 1e-300) / n) - cost;
  }

  BlockData trial_;
  std::size_t channel_;
  FineChannel as_logged_;
  Whitening whitening_;
  std::vector<Law> laws_;
  std::vector<Candidate> tried_;  // of all laws
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
  const Offers offers(data);
  std::optional<DelayOfChannel> best;
  double low = 0.0, high = 0.0;  // between which the best delay is
  for (std::size_t c = 0; c < data.channels.size(); ++c) {
    const FineChannel& channel = data.channels[c];
    if (!names_in(channel.name).less.empty()) continue;  // follows the two it is made of
    if (static_cast<std::ptrdiff_t>(c) == data.reference || !channel.varies || channel.rotates ||
        channel.still)
      continue;
    Profile profile(data, model, shape, offers, c);
    const double none = profile.at(0.0);
    const std::vector<double> delays = delays_to_try(data.grid, channel.environment());
    for (std::size_t i = 0; i < delays.size(); ++i) {
      if (delays[i] == 0.0) continue;
      const double gain = profile.at(delays[i]) - none;
      if (gain <= 0.0 || (best && gain <= best->gain)) continue;
      best = DelayOfChannel{c, delays[i], 0.0, gain};
      low = delays[i == 0 ? 0 : i - 1];
      high = delays[std::min(i + 1, delays.size() - 1)];
    }
  }
  if (!best) return best;
  Profile profile(data, model, shape, offers, best->channel);
  const double none = profile.at(0.0);
  best->delay_s = best_between(profile, low, high);
  const double top = profile.at(best->delay_s);
  best->gain = top - none;
  best->std_error_s = width_at(profile, best->delay_s, top, 0.1 * data.grid.fine_s);
  return best;
}

}  // namespace ifog
