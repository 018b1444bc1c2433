// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "filters/allan/two_sum.h"
#include "filters/threads/share_out.h"

namespace ifog {
namespace {

// Places per block: their angles stay in the second-level cache for all m, so only two of a long τ's three
// streams come from memory.
constexpr std::size_t kBlock = std::size_t{1} << 14U;
// Longest block of the modified deviation with its differences, in angles: with a few longer ones the processors
// would be idle.
constexpr std::size_t kLongestReach = std::size_t{1} << 24U;
constexpr std::size_t kWorthThreads = std::size_t{1} << 22U;  // squares

// Uses registers of four doubles where available. The order of additions and so the bits are the same: AVX2
// has no fused multiply-add. Not with ThreadSanitizer, whose runtime does not exist yet when the ifunc
// resolver runs.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define IFOG_WIDE_REGISTERS [[gnu::target_clones("avx2", "default"), gnu::flatten]]
#else
#define IFOG_WIDE_REGISTERS
#endif

// Eight independent sums allow vectorisation without a change in the order of any addition.
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

// Angles of a block's places, and those one, two and three m later.
using Streams = std::array<const double*, 4>;

IFOG_WIDE_REGISTERS double allan_block(const Streams& x, std::size_t n) {
  const double *x0 = x[0], *x1 = x[1], *x2 = x[2];
  return sum_of_squares(n, [=](std::size_t i) { return (x2[i] - x1[i]) - (x1[i] - x0[i]); });
}

IFOG_WIDE_REGISTERS double hadamard_block(const Streams& x, std::size_t n) {
  const double *x0 = x[0], *x1 = x[1], *x2 = x[2], *x3 = x[3];
  return sum_of_squares(n, [=](std::size_t i) { return (x3[i] - x0[i]) - 3.0 * (x2[i] - x1[i]); });
}

// Moving mean of m neighbouring second differences; its sum is carried in two doubles.
class MovingMean {
 public:
  explicit MovingMean(std::size_t m) : m_(static_cast<double>(m)) {}
  void add(double value) {
    double rest = 0.0;
    two_sum(high_, value, high_, rest);
    low_ += rest;
  }
  [[nodiscard]] double mean() const { return (high_ + low_) / m_; }

 private:
  double high_ = 0.0, low_ = 0.0, m_;
};

double second_difference(const Streams& x, std::size_t i, std::size_t from) {
  return (x[from + 2][i] - x[from + 1][i]) - (x[from + 1][i] - x[from][i]);
}

// The sum restarts in every block to limit rounding errors. x needs n + 3m − 1 angles.
double modified_block(const double* x, std::size_t m, std::size_t n) {
  const Streams at{x, x + m, x + 2 * m, x + 3 * m};
  MovingMean mean(m);
  for (std::size_t i = 0; i < m; ++i) mean.add(second_difference(at, i, 0));
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    squares += mean.mean() * mean.mean();
    if (i + 1 < n) {
      mean.add(-second_difference(at, i, 0));
      mean.add(second_difference(at, i, 1));
    }
  }
  return squares;
}

struct Kind {
  Deviation which;
  std::size_t span;  // reach of a difference, in units of m
  std::size_t less;  // subtracted from the number of places: the modified one reaches one angle less
  double norm;
  std::size_t block_m;  // block size in units of m, for the modified deviation's running sum

  [[nodiscard]] double block(const double* x, std::size_t m, std::size_t n) const {
    const Streams at{x, x + m, x + 2 * m, x + (span > 2 ? 3 : 2) * m};
    return which == Deviation::kModified   ? modified_block(x, m, n)
           : which == Deviation::kHadamard ? hadamard_block(at, n)
                                           : allan_block(at, n);
  }
};

Kind kind_of(Deviation kind) {
  switch (kind) {
    case Deviation::kModified:
      return {kind, 3, 1, 2.0, 4};
    case Deviation::kHadamard:
      return {kind, 3, 0, 6.0, 0};
    case Deviation::kAllan:
      break;
  }
  return {kind, 2, 0, 2.0, 0};
}

std::size_t places(const Kind& kind, std::size_t angles, std::size_t m) {
  const std::size_t reach = kind.span * m - kind.less;
  return angles > reach ? angles - reach : 0;
}

// Sum of many squares, rounded once.
class ExactSum {
 public:
  void add(double value) {
    double error = 0.0;
    two_sum(sum_, value, sum_, error);
    rest_ += error;
  }
  [[nodiscard]] double value() const { return sum_ + rest_; }

 private:
  double sum_ = 0.0, rest_ = 0.0;
};

// Computes the differences of several m in one pass, block by block. squares: by entry of m.
void add_blocks(const AngleSum& sum, const Kind& kind, std::span<const std::size_t> m,
                std::vector<ExactSum>& squares) {
  if (m.empty()) return;
  // The modified deviation starts each block with m additions, so blocks grow with m.
  const std::size_t block = std::max(kBlock, kind.block_m * *std::ranges::max_element(m));
  for (const AngleSum::Part& part : sum.parts()) {
    const double* const x = sum.angle().data() + part.first;
    const std::size_t blocks = (part.angles + block - 1) / block;
    std::vector<double> partial(blocks * m.size());
    share_out(blocks, part.angles * m.size() > kWorthThreads ? 0 : 1, [&](std::size_t b) {
      for (std::size_t k = 0; k < m.size(); ++k) {
        const std::size_t all = places(kind, part.angles, m[k]), at = b * block;
        if (all > at) partial[b * m.size() + k] = kind.block(x + at, m[k], std::min(block, all - at));
      }
    });
    for (std::size_t b = 0; b < blocks; ++b)
      for (std::size_t k = 0; k < m.size(); ++k) squares[k].add(partial[b * m.size() + k]);
  }
}

// Squares of the modified deviation, whose running sum goes through the whole part.
ExactSum modified_squares(const AngleSum& sum, const Kind& kind, std::size_t m) {
  ExactSum squares;
  for (const AngleSum::Part& part : sum.parts()) {
    const double* const x = sum.angle().data() + part.first;
    const Streams at{x, x + m, x + 2 * m, x + 3 * m};
    const std::size_t all = places(kind, part.angles, m);
    MovingMean mean(m);
    for (std::size_t i = 0; i < m && all > 0; ++i) mean.add(second_difference(at, i, 0));
    for (std::size_t begin = 0; begin < all; begin += kBlock) {
      double block = 0.0;
      for (std::size_t i = begin; i < std::min(begin + kBlock, all); ++i) {
        block += mean.mean() * mean.mean();
        if (i + 1 == all) break;
        mean.add(-second_difference(at, i, 0));
        mean.add(second_difference(at, i, 1));
      }
      squares.add(block);
    }
  }
  return squares;
}

}  // namespace

std::vector<DeviationPoint> deviation(const AngleSum& sum, std::span<const std::size_t> m, Deviation which) {
  const Kind kind = kind_of(which);
  std::vector<std::size_t> together, apart,
      in_blocks;  // places in m; and those of the first as averaging times
  for (std::size_t k = 0; k < m.size(); ++k) {
    const bool blocks = which != Deviation::kModified || (kind.span + kind.block_m) * m[k] <= kLongestReach;
    (blocks ? together : apart).push_back(k);
    if (blocks) in_blocks.push_back(m[k]);
  }
  std::vector<ExactSum> sums(together.size()), squares(m.size());
  add_blocks(sum, kind, in_blocks, sums);
  for (std::size_t i = 0; i < together.size(); ++i) squares[together[i]] = sums[i];
  share_out(apart.size(), 0,
            [&](std::size_t i) { squares[apart[i]] = modified_squares(sum, kind, m[apart[i]]); });

  std::vector<DeviationPoint> points(m.size());
  for (std::size_t k = 0; k < m.size(); ++k) {
    DeviationPoint& point = points[k];
    point.m = m[k];
    for (const AngleSum::Part& part : sum.parts()) point.terms += places(kind, part.angles, m[k]);
    const double samples = static_cast<double>(m[k]);
    point.variance = point.terms == 0 ? std::numeric_limits<double>::quiet_NaN()
                                      : squares[k].value() / static_cast<double>(point.terms) /
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
