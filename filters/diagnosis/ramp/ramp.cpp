// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramp.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "filters/distributions/chi_squared.h"
#include "filters/effects/meaning.h"
#include "filters/linear/symmetric.h"
#include "filters/series/mapped_file.h"

namespace ifog {
namespace {

constexpr int kParts = 4;          // held out in turn
constexpr std::size_t kTurns = 4;  // pieces a part is made of

struct Sums {
  Eigen::MatrixXd gram;
  Eigen::VectorXd moment;
  double square = 0.0;
  double samples = 0.0;

  explicit Sums(Eigen::Index knots)
      : gram(Eigen::MatrixXd::Zero(knots, knots)), moment(Eigen::VectorXd::Zero(knots)) {}
  Sums& operator+=(const Sums& other) {
    gram += other.gram;
    moment += other.moment;
    square += other.square;
    samples += other.samples;
    return *this;
  }
};

// Weights of the two knots a position lies between; the first knot is the table's zero and has no column.
struct Hats {
  std::array<std::pair<Eigen::Index, double>, 4> entry{};
  std::size_t count = 0;
  void add(double position, Eigen::Index knots, double sign) {
    const auto low = static_cast<Eigen::Index>(std::floor(position));
    const double share = position - std::floor(position);
    if (low > 0) entry[count++] = {low - 1, sign * (1.0 - share)};
    if (low < knots) entry[count++] = {low, sign * share};
  }
};

double unwrapped_position(double value, double period, Eigen::Index knots) {
  value -= period * std::floor(value / period);
  return value / period * static_cast<double>(knots);
}

// Calls use(part, hats over dt, error less its slow part) for every sample that has a predecessor.
template <class Use>
void each_sample(const Record& record, std::span<const double> ramp, double period, Eigen::Index knots,
                 Use&& use) {
  const std::size_t n = record.time_s.size();
  // Slow drift would only add noise; a mean over a few hundred samples takes it out and leaves the ramp's
  // harmonics.
  constexpr double kForget = 1.0 / 512.0;
  double slow = 0.0;
  bool started = false;
  for (std::size_t i = 1; i < n; ++i) {
    double error = record.rate_radps[i];
    if (!record.reference_radps.empty()) error -= record.reference_radps[i];
    if (!std::isfinite(error) || !std::isfinite(ramp[i]) || !std::isfinite(ramp[i - 1])) continue;
    if (!started) {
      const std::size_t few = std::min<std::size_t>(n, 512);
      double sum = 0.0;
      double count = 0.0;
      for (std::size_t k = 0; k < few; ++k) {
        double e = record.rate_radps[k];
        if (!record.reference_radps.empty()) e -= record.reference_radps[k];
        if (!std::isfinite(e)) continue;
        sum += e;
        count += 1.0;
      }
      slow = sum / std::max(count, 1.0);
      started = true;
    }
    Hats hats;
    hats.add(unwrapped_position(ramp[i], period, knots), knots, 1.0);
    hats.add(unwrapped_position(ramp[i - 1], period, knots), knots, -1.0);
    const double dt = record.time_s[i] - record.time_s[i - 1];
    for (std::size_t k = 0; k < hats.count; ++k) hats.entry[k].second /= dt;
    const auto part = static_cast<int>(i * kTurns * kParts / n) % kParts;
    use(i, part, hats, error - slow);
    slow += kForget * (error - slow);
  }
}

Eigen::VectorXd solved(const Sums& sums) {
  const double ridge = 1e-9 * sums.gram.trace() / static_cast<double>(sums.gram.rows());
  Eigen::MatrixXd gram = sums.gram;
  gram.diagonal().array() += ridge;
  return SymmetricSolver(gram).solve(sums.moment);
}

double explained(const Sums& sums, const Eigen::VectorXd& table) {
  return 2.0 * table.dot(sums.moment) - table.dot(sums.gram * table);
}

using PartSums = std::vector<Sums>;  // kParts

Sums all_of(const PartSums& parts) {
  Sums all(parts.front().gram.rows());
  for (const Sums& sums : parts) all += sums;
  return all;
}

PartSums sums_by_part(const std::vector<Record>& records, const std::string& channel, double period,
                      Eigen::Index knots) {
  PartSums parts(kParts, Sums(knots));
  for (const Record& record : records) {
    each_sample(record, values_of(record, channel), period, knots,
                [&](std::size_t, int part, const Hats& hats, double e) {
                  Sums& sums = parts[static_cast<std::size_t>(part)];
                  for (std::size_t a = 0; a < hats.count; ++a) {
                    sums.moment[hats.entry[a].first] += hats.entry[a].second * e;
                    for (std::size_t b = 0; b < hats.count; ++b) {
                      sums.gram(hats.entry[a].first, hats.entry[b].first) +=
                          hats.entry[a].second * hats.entry[b].second;
                    }
                  }
                  sums.square += e * e;
                  sums.samples += 1.0;
                });
  }
  return parts;
}

// With enough knots for the table's shape and no more, by the Bayesian information criterion; empty when the
// records are too short for any.
PartSums with_best_knots(const std::vector<Record>& records, const std::string& channel, double period) {
  PartSums best;
  double best_score = -1e300;
  for (const Eigen::Index knots : {Eigen::Index{8}, Eigen::Index{16}, Eigen::Index{32}, Eigen::Index{64}}) {
    PartSums parts = sums_by_part(records, channel, period, knots);
    const Sums all = all_of(parts);
    if (all.samples < 20.0 * static_cast<double>(knots)) break;
    const double left = all.square - explained(all, solved(all));
    const double score =
        -all.samples * std::log(left / all.square) - static_cast<double>(knots) * std::log(all.samples);
    if (score <= best_score) continue;
    best_score = score;
    best = std::move(parts);
  }
  return best;
}

// Of each part the table that the other parts make, and what it explains of its own part, all together.
struct CrossFit {
  std::array<Eigen::VectorXd, kParts> without;
  double gain = 0.0;
};

CrossFit cross_fit(const PartSums& parts) {
  CrossFit fit;
  for (std::size_t part = 0; part < kParts; ++part) {
    Sums others(parts.front().gram.rows());
    for (std::size_t k = 0; k < kParts; ++k) {
      if (k != part) others += parts[k];
    }
    fit.without[part] = solved(others);
    fit.gain += explained(parts[part], fit.without[part]);
  }
  return fit;
}

Effect table_effect(const std::string& channel, double period, const Sums& all,
                    const Eigen::VectorXd& table) {
  const Eigen::Index knots = table.size();
  Effect effect;
  effect.form = "lookup";
  effect.channel = channel;
  effect.period = period;
  effect.angle = true;
  double square = 0.0;
  for (Eigen::Index k = 0; k <= knots; ++k) {
    effect.table_x.push_back(period * static_cast<double>(k) / static_cast<double>(knots));
    effect.table_y.push_back(k == 0 ? 0.0 : table[k - 1]);
  }
  // A constant angle has no rate: the table is stored about its mean, which keeps a reload's jump small.
  double mean = 0.0;
  for (const double y : effect.table_y) mean += y / static_cast<double>(knots + 1);
  for (double& y : effect.table_y) {
    y -= mean;
    square += y * y / static_cast<double>(knots + 1);
  }
  const double variance = (all.square - explained(all, table)) / all.samples;
  const Eigen::MatrixXd covariance = variance * SymmetricSolver(all.gram).inverse();
  const double rms = std::sqrt(square);
  effect.parameters = {{"angle_rms", rms, std::sqrt(covariance.diagonal().mean()), "rad"}};
  effect.meaning = meaning_of(effect);
  return effect;
}

}  // namespace

double wrap_period(std::span<const double> values) {
  constexpr std::size_t kLookedUp = std::size_t{1} << 17U;
  constexpr std::size_t kPiece = 4096;  // looked at without a branch; a ramp's counter is never below zero
  double low = 1e300;
  double high = -1e300;
  for (std::size_t at = 0; at < values.size(); at += kPiece) {
    if (at % kLookedUp == 0)
      expect_reading(values.data() + at, std::min(kLookedUp, values.size() - at) * sizeof(double));
    for (const double v : values.subspan(at, std::min(kPiece, values.size() - at))) {
      const bool finite = std::abs(v) < std::numeric_limits<double>::infinity();
      low = finite && v < low ? v : low;
      high = finite && v > high ? v : high;
    }
    if (low < 0.0) return 0.0;
  }
  if (!(high > 16.0)) return 0.0;
  const double period = std::exp2(std::ceil(std::log2(high + 0.5)));
  if (high < 0.9 * period || low > 0.1 * period) return 0.0;
  std::size_t jumps = 0;
  double raw = 0.0;
  double wrapped = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double d = values[i] - values[i - 1];
    if (!std::isfinite(d)) continue;
    const double w = d - period * std::round(d / period);
    jumps += std::abs(d) > 0.5 * period;
    raw += d * d;
    wrapped += w * w;
  }
  return jumps >= 3 && wrapped < 0.9 * raw ? period : 0.0;
}

std::optional<RampFit> fit_ramp(const std::vector<Record>& records, const std::string& channel,
                                double significance) {
  double period = 0.0;
  for (const Record& record : records) period = std::max(period, wrap_period(values_of(record, channel)));
  if (!(period > 0.0)) return std::nullopt;
  const PartSums parts = with_best_knots(records, channel, period);
  if (parts.empty()) return std::nullopt;

  const Sums all = all_of(parts);
  const Eigen::VectorXd table = solved(all);
  const CrossFit crossed = cross_fit(parts);
  RampFit fit;
  fit.ratio = -all.samples * std::log(std::max(1e-12, 1.0 - explained(all, table) / all.square));
  fit.p_value = chi_squared_above(std::max(0.0, fit.ratio), static_cast<double>(table.size()));
  if (fit.p_value > significance || crossed.gain <= 0.0) return std::nullopt;
  fit.effect = table_effect(channel, period, all, table);

  for (const Record& record : records) {
    Samples correction(record.time_s.size(), 0.0);
    Samples held_out = correction;
    each_sample(record, values_of(record, channel), period, table.size(),
                [&](std::size_t i, int part, const Hats& hats, double) {
                  const Eigen::VectorXd& without = crossed.without[static_cast<std::size_t>(part)];
                  for (std::size_t a = 0; a < hats.count; ++a) {
                    correction[i] += hats.entry[a].second * table[hats.entry[a].first];
                    held_out[i] += hats.entry[a].second * without[hats.entry[a].first];
                  }
                });
    fit.correction.push_back(std::move(correction));
    fit.held_out.push_back(std::move(held_out));
  }
  return fit;
}

}  // namespace ifog
