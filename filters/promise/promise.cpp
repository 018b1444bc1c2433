// SPDX-License-Identifier: Apache-2.0
#include "filters/promise/promise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace ifog {
namespace {

constexpr double kSurely = 3.0;  // standard errors
constexpr std::size_t kChapters = 40;
constexpr std::size_t kFewest = 100;  // samples
constexpr std::size_t kFewestMeans = 8;
constexpr double kRounding = 1e-9;

// Sums over innovations: x of d, y of e.
struct Sums {
  double xx = 0.0, xy = 0.0, yy = 0.0, log_variance = 0.0, count = 0.0;
};

// A sample of both series, and the steps since the one before; 0 if the level is unknown.
struct Pair {
  double e = 0.0, d = 0.0;
  double steps = 0.0;
};

std::vector<Pair> usable(const CorrectionTrial& trial, double period_s) {
  // longest gap over which the level is predicted
  constexpr double kLongestHole_s = 60.0;
  std::vector<Pair> out;
  for (const Stretch& stretch : trial.at_rest) {
    bool first = true;
    double last_s = 0.0;
    for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
      const double e = trial.before_radps[i], d = e - trial.after_radps[i];
      if (!std::isfinite(d)) continue;
      const double apart_s = trial.time_s[i] - last_s;
      const bool joins = !first && apart_s < kLongestHole_s;
      out.push_back({e, d, joins ? std::max(1.0, std::round(apart_s / period_s)) : 0.0});
      last_s = trial.time_s[i];
      first = false;
    }
  }
  return out;
}

// Innovations of a local level with noise variance 1 and step variance `ratio`, summed by chapter.
std::array<Sums, kChapters> innovations(const std::vector<Pair>& pairs, double ratio) {
  std::array<Sums, kChapters> out{};
  double level_e = 0.0, level_d = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Pair& now = pairs[i];
    if (now.steps == 0.0) {
      level_e = now.e;
      level_d = now.d;
      variance = 1.0;
      continue;
    }
    variance += ratio * now.steps;
    const double total = variance + 1.0, gain = variance / total;
    const double y = now.e - level_e, x = now.d - level_d;
    Sums& sums = out[i * kChapters / pairs.size()];
    sums.xx += x * x / total;
    sums.xy += x * y / total;
    sums.yy += y * y / total;
    sums.log_variance += std::log(total);
    sums.count += 1.0;
    level_e += gain * y;
    level_d += gain * x;
    variance = gain;
  }
  return out;
}

Sums in_all(const std::array<Sums, kChapters>& chapters) {
  Sums out;
  for (const Sums& each : chapters) {
    out.xx += each.xx;
    out.xy += each.xy;
    out.yy += each.yy;
    out.log_variance += each.log_variance;
    out.count += each.count;
  }
  return out;
}

// Log-likelihood at the best share and scale, except for a constant.
double likelihood(const Sums& sums) {
  const double left = sums.yy - (sums.xx > 0.0 ? sums.xy * sums.xy / sums.xx : 0.0);
  if (!(left > 0.0)) return std::numeric_limits<double>::infinity();
  return -0.5 * (sums.count * std::log(left / sums.count) + sums.log_variance);
}

double best_ratio(const std::vector<Pair>& pairs) {
  double best = 0.0, highest = likelihood(in_all(innovations(pairs, 0.0)));
  const auto offer = [&](double ratio) {
    const double here = likelihood(in_all(innovations(pairs, ratio)));
    if (here > highest) {
      highest = here;
      best = ratio;
    }
  };
  for (int decade = -14; decade <= 2; ++decade) offer(std::pow(10.0, decade));
  if (best == 0.0) return best;
  const double coarse = best;
  for (const double factor : {0.2, 0.45, 2.2, 5.0}) offer(coarse * factor);
  return best;
}

ErrorOfMeans error_of_means(const CorrectionTrial& trial, double averaging_s, double period_s) {
  const auto per_mean = static_cast<std::size_t>(std::max(1.0, std::round(averaging_s / period_s)));
  ErrorOfMeans out;
  out.averaging_s = averaging_s;
  double before = 0.0, after = 0.0, before_square = 0.0, after_square = 0.0;
  for (const Stretch& stretch : trial.at_rest) {
    for (std::size_t begin = stretch.begin; begin + per_mean <= stretch.end; begin += per_mean) {
      double b = 0.0, a = 0.0, n = 0.0;
      for (std::size_t i = begin; i < begin + per_mean; ++i) {
        if (!std::isfinite(trial.before_radps[i]) || !std::isfinite(trial.after_radps[i])) continue;
        b += trial.before_radps[i];
        a += trial.after_radps[i];
        n += 1.0;
      }
      if (n < 0.5 * static_cast<double>(per_mean)) continue;
      ++out.means;
      const double count = static_cast<double>(out.means);
      const double b_off = b / n - before, a_off = a / n - after;
      before += b_off / count;
      after += a_off / count;
      before_square += b_off * (b / n - before);
      after_square += a_off * (a / n - after);
    }
  }
  if (out.means > 0) {
    out.before_radps = std::sqrt(before_square / static_cast<double>(out.means));
    out.after_radps = std::sqrt(after_square / static_cast<double>(out.means));
  }
  return out;
}

}  // namespace

PromiseKept weigh_promise(const CorrectionTrial& trial) {
  const std::size_t n = trial.time_s.size();
  if (trial.before_radps.size() != n || trial.after_radps.size() != n)
    throw std::invalid_argument("the series to weigh are not equally long");
  if (n < kFewest) throw std::invalid_argument("fewer than 100 samples to weigh a correction by");
  const double period_s = sample_clock(trial.time_s).period_s;
  const std::vector<Pair> pairs = usable(trial, period_s);
  if (pairs.size() < kFewest)
    throw std::invalid_argument("fewer than 100 samples at rest to weigh a correction by");
  PromiseKept out;
  out.seconds = static_cast<double>(pairs.size()) * period_s;
  out.walk_ratio = best_ratio(pairs);
  const std::array<Sums, kChapters> chapters = innovations(pairs, out.walk_ratio);
  const Sums sums = in_all(chapters);
  out.share_error = std::numeric_limits<double>::infinity();
  // d is constant except for the rounding of e.
  if (sums.xx > kRounding * kRounding * sums.yy) {
    out.share = sums.xy / sums.xx;
    double scatter = 0.0, chapters_used = 0.0;
    for (const Sums& each : chapters) {
      const double score = each.xy - out.share * each.xx;
      scatter += score * score;
      if (each.xx > 0.0) chapters_used += 1.0;
    }
    // Few chapters may agree by chance, so the error is at least that of white innovations.
    const double left = std::max(0.0, sums.yy - sums.xy * out.share);
    const double white = left / sums.count * sums.xx;
    if (chapters_used > 1.0) scatter *= chapters_used / (chapters_used - 1.0);
    out.share_error = std::sqrt(std::max(scatter, white)) / sums.xx;
  }
  for (const double averaging_s : {1.0, 10.0, 100.0}) {
    if (averaging_s < 0.5 * period_s) continue;
    const ErrorOfMeans error = error_of_means(trial, averaging_s, period_s);
    if (error.means >= kFewestMeans) out.errors.push_back(error);
  }
  return out;
}

PromiseVerdict verdict(const PromiseKept& kept) {
  constexpr double kNoGain = 0.5;
  // a share error that leaves 1 % of the corrected variance
  constexpr double kAsGoodAs = 0.1;
  const double sure = kSurely * kept.share_error;
  if (kept.share - sure > kNoGain)
    return std::abs(kept.share - 1.0) <= std::max(sure, kAsGoodAs) ? PromiseVerdict::kept
                                                                   : PromiseVerdict::in_part;
  return kept.share + sure < kNoGain ? PromiseVerdict::broken : PromiseVerdict::open;
}

}  // namespace ifog
