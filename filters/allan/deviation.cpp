// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include "filters/allan/two_sum.h"
#include "filters/threads/share_out.h"

namespace ifog {
namespace {

// Places per block: their angles stay in the second-level cache for all m, so only two of a long τ's three
// streams come from memory.
constexpr std::size_t kBlock = kSeriesPiece;
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

// Contiguous angles of a part; the window moves along it.
class Window {
 public:
  // reach: angles needed beyond a place. ahead: angles read in advance, so that data are moved rarely.
  Window(const SeriesView& angle, const AngleSum::Part& part, std::size_t reach)
      : angle_(angle), part_(part), room_(angle.in_memory().empty() ? reach + ahead(reach) : part.angles) {}
  static std::size_t ahead(std::size_t reach) { return std::max(64 * kBlock, reach / 2); }

  // Angles from `begin`, as many as fit or to the part's end; begin must not decrease.
  std::span<const double> from(std::size_t begin) {
    const std::size_t count = std::min(room_, part_.angles - begin);
    if (!angle_.in_memory().empty()) return angle_.in_memory().subspan(part_.first + begin, count);
    // A vector would be zeroed first.
    if (!held_) held_ = std::make_unique_for_overwrite<double[]>(count);
    double* const held = held_.get();
    const std::size_t kept = end_ > begin ? end_ - begin : 0;
    if (kept > 0) std::copy(held + (begin - begin_), held + (end_ - begin_), held);
    angle_.read(part_.first + begin + kept, {held + kept, count - kept});
    begin_ = begin;
    end_ = begin + count;
    return {held, count};
  }

 private:
  SeriesView angle_;
  AngleSum::Part part_;
  std::size_t room_, begin_ = 0, end_ = 0;
  std::unique_ptr<double[]> held_;  // size of the first request; later ones are not larger
};

// Computes all m whose differences fit into the window, part by part. squares: by entry of m.
void add_together(const AngleSum& sum, const Kind& kind, std::span<const std::size_t> m,
                  std::vector<ExactSum>& squares) {
  if (m.empty()) return;
  const std::size_t longest_m = *std::ranges::max_element(m);
  // The modified deviation starts each block with m additions, so blocks grow with m.
  const std::size_t block = std::max(kBlock, kind.block_m * longest_m);
  const std::size_t reach = kind.span * longest_m + block;
  for (const AngleSum::Part& part : sum.parts()) {
    Window window(sum.angle(), part, reach);
    for (std::size_t begin = 0; begin < part.angles;) {
      const std::span<const double> x = window.from(begin);
      const bool last = begin + x.size() == part.angles;
      // Only whole blocks, except at the end.
      const std::size_t blocks = last ? (x.size() + block - 1) / block : (x.size() - reach) / block + 1;
      std::vector<double> partial(blocks * m.size());
      share_out(blocks, x.size() * m.size() > kWorthThreads ? 0 : 1, [&](std::size_t b) {
        for (std::size_t k = 0; k < m.size(); ++k) {
          const std::size_t all = places(kind, part.angles, m[k]), at = begin + b * block;
          if (all > at)
            partial[b * m.size() + k] = kind.block(x.data() + b * block, m[k], std::min(block, all - at));
        }
      });
      for (std::size_t b = 0; b < blocks; ++b)
        for (std::size_t k = 0; k < m.size(); ++k) squares[k].add(partial[b * m.size() + k]);
      begin += blocks * block;
    }
  }
}

// Computes one m; its angles are streams m apart.
double alone(const AngleSum& sum, const Kind& kind, std::size_t m) {
  ExactSum squares;
  std::array<std::vector<double>, 4> room;
  for (const AngleSum::Part& part : sum.parts()) {
    const SeriesView angle = sum.angle();
    const std::size_t all = places(kind, part.angles, m);
    const auto streams = [&](std::size_t begin, std::size_t count, std::size_t ms) {
      Streams x{};
      for (std::size_t s = 0; s <= ms; ++s)
        x[s] = angle.piece(part.first + begin + s * m, count, room[s]).data();
      return x;
    };
    MovingMean mean(m);
    if (kind.which == Deviation::kModified && all > 0)
      for (std::size_t begin = 0; begin < m; begin += kBlock) {
        const std::size_t count = std::min(kBlock, m - begin);
        const Streams x = streams(begin, count, 2);
        for (std::size_t i = 0; i < count; ++i) mean.add(second_difference(x, i, 0));
      }
    for (std::size_t begin = 0; begin < all; begin += kBlock) {
      const std::size_t count = std::min(kBlock, all - begin);
      if (kind.which != Deviation::kModified) {
        const Streams x = streams(begin, count, kind.span);
        squares.add(kind.which == Deviation::kHadamard ? hadamard_block(x, count) : allan_block(x, count));
        continue;
      }
      // After the last place the mean does not move.
      const std::size_t moves = begin + count < all ? count : count - 1;
      const Streams x = streams(begin, moves, 3);
      double block = 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        block += mean.mean() * mean.mean();
        if (i == moves) break;
        mean.add(-second_difference(x, i, 0));
        mean.add(second_difference(x, i, 1));
      }
      squares.add(block);
    }
  }
  return squares.value();
}

}  // namespace

std::vector<DeviationPoint> deviation(const AngleSum& sum, std::span<const std::size_t> m, Deviation which,
                                      std::size_t angles_at_once) {
  const Kind kind = kind_of(which);
  std::vector<std::size_t> together, apart,
      in_window;  // places in m; and those of the first as averaging times
  for (std::size_t k = 0; k < m.size(); ++k) {
    const bool fits = !sum.angle().in_memory().empty() || (kind.span + kind.block_m) * m[k] <= angles_at_once;
    (fits ? together : apart).push_back(k);
    if (fits) in_window.push_back(m[k]);
  }
  std::vector<ExactSum> sums(together.size());
  add_together(sum, kind, in_window, sums);
  std::vector<double> squares(m.size());
  for (std::size_t i = 0; i < together.size(); ++i) squares[together[i]] = sums[i].value();
  share_out(apart.size(), 0, [&](std::size_t i) { squares[apart[i]] = alone(sum, kind, m[apart[i]]); });

  std::vector<DeviationPoint> points(m.size());
  for (std::size_t k = 0; k < m.size(); ++k) {
    DeviationPoint& point = points[k];
    point.m = m[k];
    for (const AngleSum::Part& part : sum.parts()) point.terms += places(kind, part.angles, m[k]);
    const double samples = static_cast<double>(m[k]);
    point.variance = point.terms == 0
                         ? std::numeric_limits<double>::quiet_NaN()
                         : squares[k] / static_cast<double>(point.terms) / (kind.norm * samples * samples);
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
