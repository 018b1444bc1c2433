// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "filters/linear/exact_sum.h"
#include "filters/threads/share_out.h"

namespace ifog {
namespace {

// Places per block: their angles stay in the second-level cache for all m, so only two of a long τ's three
// streams come from memory.
constexpr std::size_t kBlock = std::size_t{1} << 14U;
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

double second_difference(const Streams& x, std::size_t i, std::size_t from) {
  return (x[from + 2][i] - x[from + 1][i]) - (x[from + 1][i] - x[from][i]);
}

struct Kind {
  Deviation which;
  std::size_t span;  // reach of a difference, in units of m
  std::size_t less;  // subtracted from the number of places: the modified one reaches one angle less
  double norm;
};

Kind kind_of(Deviation kind) {
  switch (kind) {
    case Deviation::kModified:
      return {kind, 3, 1, 2.0};
    case Deviation::kHadamard:
      return {kind, 3, 0, 6.0};
    case Deviation::kAllan:
      break;
  }
  return {kind, 2, 0, 2.0};
}

// Squares for each m, in one pass over the angles, block by block.
std::vector<ExactSum> squares_in_blocks(const AngleSum& sum, const Kind& kind,
                                        std::span<const std::size_t> m) {
  std::vector<ExactSum> squares(m.size());
  const auto block_at = [&](const double* x, std::size_t each, std::size_t n) {
    const Streams at{x, x + each, x + 2 * each, x + kind.span * each};
    return kind.which == Deviation::kHadamard ? hadamard_block(at, n) : allan_block(at, n);
  };
  for (const AngleSum::Part& part : sum.parts()) {
    const double* const x = sum.angle().data() + part.first;
    const std::size_t blocks = (part.angles + kBlock - 1) / kBlock;
    std::vector<double> partial(blocks * m.size());
    share_out(blocks, part.angles * m.size() > kWorthThreads ? 0 : 1, [&](std::size_t b) {
      for (std::size_t k = 0; k < m.size(); ++k) {
        const std::size_t all = differences_of(kind.which, m[k], part.angles - 1), at = b * kBlock;
        if (all > at) partial[b * m.size() + k] = block_at(x + at, m[k], std::min(kBlock, all - at));
      }
    });
    for (std::size_t b = 0; b < blocks; ++b)
      for (std::size_t k = 0; k < m.size(); ++k) squares[k].add(partial[b * m.size() + k]);
  }
  return squares;
}

// Of the modified deviation: squares of the moving mean of m neighbouring second differences, one m after the other.
ExactSum modified_squares(const AngleSum& sum, const Kind& kind, std::size_t m) {
  ExactSum squares;
  for (const AngleSum::Part& part : sum.parts()) {
    const double* const x = sum.angle().data() + part.first;
    const Streams at{x, x + m, x + 2 * m, x + 3 * m};
    const std::size_t all = differences_of(kind.which, m, part.angles - 1);
    ExactSum neighbours;
    for (std::size_t i = 0; i < m && all > 0; ++i) neighbours.add(second_difference(at, i, 0));
    for (std::size_t i = 0; i < all; ++i) {
      const double mean = neighbours.value() / static_cast<double>(m);
      squares.add(mean * mean);
      if (i + 1 == all) break;
      neighbours.add(-second_difference(at, i, 0));
      neighbours.add(second_difference(at, i, 1));
    }
  }
  return squares;
}

}  // namespace

std::vector<DeviationPoint> deviation(const AngleSum& sum, std::span<const std::size_t> m, Deviation which) {
  const Kind kind = kind_of(which);
  std::vector<ExactSum> squares(m.size());
  if (which == Deviation::kModified)
    share_out(m.size(), 0, [&](std::size_t k) { squares[k] = modified_squares(sum, kind, m[k]); });
  else
    squares = squares_in_blocks(sum, kind, m);

  std::vector<DeviationPoint> points(m.size());
  for (std::size_t k = 0; k < m.size(); ++k) {
    DeviationPoint& point = points[k];
    point.m = m[k];
    for (const AngleSum::Part& part : sum.parts())
      point.terms += differences_of(kind.which, m[k], part.angles - 1);
    const double samples = static_cast<double>(m[k]);
    point.variance = point.terms == 0 ? std::numeric_limits<double>::quiet_NaN()
                                      : squares[k].value() / static_cast<double>(point.terms) /
                                            (kind.norm * samples * samples);
  }
  return points;
}

std::size_t longest_average(Deviation which, std::size_t samples) {
  const Kind kind = kind_of(which);
  // A difference fits: span·m − less < samples + 1.
  return (samples + kind.less) / kind.span;
}

std::size_t differences_of(Deviation which, std::size_t m, std::size_t samples) {
  const Kind kind = kind_of(which);
  const std::size_t reach = kind.span * m - kind.less;
  return samples + 1 > reach ? samples + 1 - reach : 0;
}

ReportedDeviations reported_deviations(std::span<const double> rate_radps, std::span<const Stretch> parts,
                                       double period_s) {
  ReportedDeviations found;
  if (parts.empty()) return found;
  const AngleSum sum(rate_radps, parts);
  for (std::size_t t = 0; t < kReportedTaus.size(); ++t) {
    const double samples = std::round(kReportedTaus[t] / period_s);
    if (samples < 1.0 || std::abs(samples * period_s / kReportedTaus[t] - 1.0) > 0.1) continue;
    const std::array<std::size_t, 1> m{static_cast<std::size_t>(samples)};
    const DeviationPoint point = deviation(sum, m).front();
    if (point.terms > 0) found[t] = std::sqrt(point.variance);
  }
  return found;
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
