// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace ifog {
namespace {

// a + b exactly, as a rounded sum and what the rounding left (Knuth, TAOCP vol. 2, 4.2.2 theorem B).
inline void two_sum(double a, double b, double& sum, double& rest) {
  sum = a + b;
  const double t = sum - a;
  rest = (a - (sum - t)) + (b - t);
}

// Places handled at a time: their angles stay in the second-level cache while every m passes over them, so
// that of the three streams of a long τ only two come from memory.
constexpr std::size_t kBlock = std::size_t{1} << 14U;

// Eight independent sums let the compiler use vector registers without changing the order of any addition.
template <typename Difference>
double sum_of_squares(std::size_t n, Difference difference) {
  constexpr std::size_t kLanes = 8;
  std::array<double, kLanes> lane{};
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const double z = difference(i + k);
      lane[k] += z * z;
    }
  for (; i < n; ++i) {
    const double z = difference(i);
    lane[0] += z * z;
  }
  return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
}

double allan_block(const double* x, std::size_t m, std::size_t n) {
  const double* x1 = x + m;
  const double* x2 = x1 + m;
  return sum_of_squares(n, [=](std::size_t i) { return (x2[i] - x1[i]) - (x1[i] - x[i]); });
}

double hadamard_block(const double* x, std::size_t m, std::size_t n) {
  const double* x1 = x + m;
  const double* x2 = x1 + m;
  const double* x3 = x2 + m;
  return sum_of_squares(n, [=](std::size_t i) { return (x3[i] - x[i]) - 3.0 * (x2[i] - x1[i]); });
}

// The sum over m neighbouring second differences starts anew in every block, so that rounding cannot pile up
// along the record. x needs n + 3m − 1 angles.
double modified_block(const double* x, std::size_t m, std::size_t n) {
  const auto z = [=](std::size_t i) { return (x[i + 2 * m] - x[i + m]) - (x[i + m] - x[i]); };
  double high = 0.0, low = 0.0;
  const auto add = [&](double value) {
    double rest = 0.0;
    two_sum(high, value, high, rest);
    low += rest;
  };
  for (std::size_t i = 0; i < m; ++i) add(z(i));
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double mean = (high + low) / static_cast<double>(m);
    squares += mean * mean;
    if (i + 1 < n) {
      add(-z(i));
      add(z(i + m));
    }
  }
  return squares;
}

struct Kind {
  std::size_t span;  // angles a difference reaches over, in m
  std::size_t less;  // subtracted from the number of places: the modified one reaches one angle less
  double norm;       // variance = mean square / (norm·m²)
  double (*block)(const double*, std::size_t, std::size_t);
  std::size_t block_m;  // places a block in units of m, for the running sum of the modified one
};

Kind kind_of(Deviation kind) {
  switch (kind) {
    case Deviation::kModified:
      return {3, 1, 2.0, modified_block, 4};
    case Deviation::kHadamard:
      return {3, 0, 6.0, hadamard_block, 0};
    case Deviation::kAllan:
      break;
  }
  return {2, 0, 2.0, allan_block, 0};
}

std::size_t places(const Kind& kind, std::size_t angles, std::size_t m) {
  const std::size_t reach = kind.span * m - kind.less;
  return angles > reach ? angles - reach : 0;
}

// A block of places of one part, with all m that have places there.
struct Task {
  std::size_t part, begin, size;
};

}  // namespace

AngleSum::AngleSum(std::span<const double> rate_radps, std::span<const Stretch> stretches) {
  find_mean(rate_radps, stretches);
  sum_up(rate_radps, stretches);
}

AngleSum::AngleSum(std::vector<double>&& rate_radps, std::span<const Stretch> stretches) {
  find_mean(rate_radps, stretches);
  const std::size_t n = rate_radps.size();
  if (stretches.size() != 1 || stretches[0].size() != n || rate_radps.capacity() == n) {
    sum_up(rate_radps, stretches);
    rate_radps = {};
    return;
  }
  angle_ = std::move(rate_radps);
  parts_.push_back({0, n + 1});
  angle_.push_back(0.0);
  double high = 0.0, low = 0.0, error = 0.0, rate = angle_[0];
  angle_[0] = 0.0;
  for (std::size_t i = 1; i <= n; ++i) {
    two_sum(high, rate - mean_, high, error);
    low += error;
    rate = std::exchange(angle_[i], high + low);
  }
}

void AngleSum::find_mean(std::span<const double> rate_radps, std::span<const Stretch> stretches) {
  std::size_t total = 0;
  double sum = 0.0, rest = 0.0, error = 0.0;
  for (const Stretch& s : stretches) {
    total += s.size();
    for (std::size_t i = s.begin; i < s.end; ++i) {
      two_sum(sum, rate_radps[i], sum, error);
      rest += error;
    }
  }
  mean_ = total > 0 ? (sum + rest) / static_cast<double>(total) : 0.0;
}

void AngleSum::sum_up(std::span<const double> rate_radps, std::span<const Stretch> stretches) {
  std::size_t total = stretches.size();
  for (const Stretch& s : stretches) total += s.size();
  angle_.reserve(total);
  for (const Stretch& s : stretches) {
    parts_.push_back({angle_.size(), s.size() + 1});
    double high = 0.0, low = 0.0, error = 0.0;
    angle_.push_back(0.0);
    for (std::size_t i = s.begin; i < s.end; ++i) {
      // The mean is rounded; what it is off by is a constant, which no second difference sees.
      two_sum(high, rate_radps[i] - mean_, high, error);
      low += error;
      angle_.push_back(high + low);
    }
  }
}

std::size_t AngleSum::longest() const {
  std::size_t n = 0;
  for (const Part& part : parts_) n = std::max(n, part.angles - 1);
  return n;
}

std::vector<DeviationPoint> deviation(const AngleSum& sum, std::span<const std::size_t> m, Deviation which) {
  const Kind kind = kind_of(which);
  // The modified deviation starts each block with m additions, so its blocks grow with m.
  const std::size_t longest_m = m.empty() ? 1 : *std::max_element(m.begin(), m.end());
  const std::size_t block = std::max(kBlock, kind.block_m * longest_m);
  std::vector<Task> tasks;
  for (std::size_t p = 0; p < sum.parts().size(); ++p)
    for (std::size_t begin = 0; begin < sum.parts()[p].angles; begin += block)
      tasks.push_back({p, begin, std::min(block, sum.parts()[p].angles - begin)});

  std::vector<double> partial(tasks.size() * m.size());
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const Task& task = tasks[t];
    const AngleSum::Part& part = sum.parts()[task.part];
    const double* x = sum.angle().data() + part.first + task.begin;
    for (std::size_t k = 0; k < m.size(); ++k) {
      const std::size_t all = places(kind, part.angles, m[k]);
      if (all <= task.begin) continue;
      partial[t * m.size() + k] = kind.block(x, m[k], std::min(task.size, all - task.begin));
    }
  }

  std::vector<DeviationPoint> points(m.size());
  for (std::size_t k = 0; k < m.size(); ++k) {
    DeviationPoint& point = points[k];
    point.m = m[k];
    for (const AngleSum::Part& part : sum.parts()) point.terms += places(kind, part.angles, m[k]);
    double squares = 0.0, rest = 0.0, error = 0.0;
    for (std::size_t t = 0; t < tasks.size(); ++t) {
      two_sum(squares, partial[t * m.size() + k], squares, error);
      rest += error;
    }
    const double samples = static_cast<double>(m[k]);
    point.variance = point.terms == 0 ? std::numeric_limits<double>::quiet_NaN()
                                      : (squares + rest) / static_cast<double>(point.terms) /
                                            (kind.norm * samples * samples);
  }
  return points;
}

std::size_t longest_average(Deviation which, std::size_t samples) {
  const Kind kind = kind_of(which);
  // places() > 0: span·m − less < samples + 1.
  return (samples + kind.less) / kind.span;
}

std::vector<std::size_t> log_spaced(std::size_t longest, int per_decade) {
  std::vector<std::size_t> m;
  for (int k = 0;; ++k) {
    const double value = std::pow(10.0, static_cast<double>(k) / per_decade);
    if (value > static_cast<double>(longest) + 0.5) break;
    const auto whole = static_cast<std::size_t>(std::llround(value));
    if (whole <= longest && (m.empty() || whole > m.back())) m.push_back(whole);
  }
  return m;
}

}  // namespace ifog
