#include "filters/allan/power_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace ifog {
namespace {

// Coefficients of the difference over multiples of m, and the norm: variance = mean square / (norm·m²).
struct Difference {
  std::vector<double> weight;
  double norm;
};

Difference difference_of(Deviation kind) {
  if (kind == Deviation::kAllan) return {{1.0, -2.0, 1.0}, 2.0};
  if (kind == Deviation::kHadamard) return {{-1.0, 3.0, -3.0, 1.0}, 6.0};
  throw std::invalid_argument("covariances are known for the Allan and the Hadamard variance only");
}

// Generalised covariance of the angle at lag t for one unit of N, B, K: up to the polynomials a difference
// does not see.
std::array<double, 3> covariance_of_angle(double t) {
  const double a = std::abs(t);
  return {-0.5 * a, a > 0.0 ? a * a * std::log(a) / (2.0 * std::numbers::pi) : 0.0, a * a * a / 12.0};
}

// Eight-point Gauss–Legendre, positive half (Abramowitz and Stegun, table 25.4).
constexpr std::array<double, 4> kNode{0.183434642495649805, 0.525532409916328986, 0.796666477413626740,
                                      0.960289856497536232};
constexpr std::array<double, 4> kWeight{0.362683783378361983, 0.313706645877887287, 0.222381034453374471,
                                        0.101228536290376259};

constexpr long long kSummedExactly =
    24;  // lags summed one by one on either side of a bend, and the shortest panel

// Two averaging times of one record (or of several stretches): covariance of the differences by lag, and its
// use.
class Pair {
 public:
  Pair(const Difference& difference, std::size_t m1, std::size_t m2, std::span<const std::size_t> samples)
      : difference_(difference), m1_(static_cast<double>(m1)), m2_(static_cast<double>(m2)) {
    const std::size_t order = difference.weight.size() - 1;
    for (const std::size_t n : samples) {
      const auto places1 = static_cast<double>(n + 1) - static_cast<double>(order * m1);
      const auto places2 = static_cast<double>(n + 1) - static_cast<double>(order * m2);
      if (places1 <= 0.0 || places2 <= 0.0) continue;
      places_.push_back({places1, places2});
      first_ = std::min(first_, -static_cast<long long>(places2) + 1);
      last_ = std::max(last_, static_cast<long long>(places1) - 1);
    }
    // Beyond a few spans only flicker is left, falling with the fourth power of the lag or faster.
    const auto reach = 8 * static_cast<long long>(order * m2);
    first_ = std::max(first_, -reach - static_cast<long long>(order * m1));
    last_ = std::min(last_, reach);
  }

  // Σ over lags of (pairs of places at that lag)·γⱼ·γₗ, for all pairs of terms j <= l.
  std::array<double, kTerms*(kTerms + 1) / 2> sums() {
    if (places_.empty()) return sums_;
    std::vector<long long> bends{first_, last_ + 1, 0};
    std::vector<std::pair<long long, double>> spikes;  // of the quantisation's covariance
    for (std::size_t a = 0; a < difference_.weight.size(); ++a)
      for (std::size_t b = 0; b < difference_.weight.size(); ++b) {
        const auto lag = static_cast<long long>(static_cast<double>(b) * m2_ - static_cast<double>(a) * m1_);
        bends.push_back(lag);
        spikes.emplace_back(lag, difference_.weight[a] * difference_.weight[b]);
      }
    for (const Places& p : places_) bends.push_back(static_cast<long long>(p.first - p.second));
    std::sort(bends.begin(), bends.end());
    bends.erase(std::unique(bends.begin(), bends.end()), bends.end());
    for (std::size_t i = 0; i + 1 < bends.size(); ++i)
      if (bends[i] >= first_ && bends[i + 1] <= last_ + 1) between(bends[i], bends[i + 1]);
    add_spikes(spikes);
    return sums_;
  }

 private:
  struct Places {
    double first, second;
  };

  // Pairs (i, j) of places with i − j = lag.
  [[nodiscard]] double pairs(double lag) const {
    double count = 0.0;
    for (const Places& p : places_)
      count += std::max(0.0, std::min(p.first, p.second + lag) - std::max(0.0, lag));
    return count;
  }

  [[nodiscard]] std::array<double, 3> smooth(double lag) const {
    std::array<double, 3> gamma{};
    for (std::size_t a = 0; a < difference_.weight.size(); ++a)
      for (std::size_t b = 0; b < difference_.weight.size(); ++b) {
        const auto g = covariance_of_angle(lag + static_cast<double>(a) * m1_ - static_cast<double>(b) * m2_);
        for (std::size_t k = 0; k < 3; ++k) gamma[k] += difference_.weight[a] * difference_.weight[b] * g[k];
      }
    return gamma;
  }

  void add(double lag, double times) {
    const auto g = smooth(lag);
    const double w = times * pairs(lag);
    sums_[index(kN, kN)] += w * g[0] * g[0];
    sums_[index(kN, kB)] += w * g[0] * g[1];
    sums_[index(kN, kK)] += w * g[0] * g[2];
    sums_[index(kB, kB)] += w * g[1] * g[1];
    sums_[index(kB, kK)] += w * g[1] * g[2];
    sums_[index(kK, kK)] += w * g[2] * g[2];
  }

  void exactly(long long begin, long long end) {
    for (long long s = begin; s < end; ++s) add(static_cast<double>(s), 1.0);
  }

  void panel(long long begin, long long end) {
    if (end - begin <= kSummedExactly) return exactly(begin, end);
    const double half = 0.5 * static_cast<double>(end - begin);
    const double middle = static_cast<double>(begin) - 0.5 + half;
    for (std::size_t k = 0; k < kNode.size(); ++k) {
      add(middle - half * kNode[k], half * kWeight[k]);
      add(middle + half * kNode[k], half * kWeight[k]);
    }
  }

  // Lags begin … end − 1, with bends at both ends: panels double in length towards the middle.
  void between(long long begin, long long end) {
    long long low = begin, high = end, length = kSummedExactly;
    while (high - low > 4 * length) {
      panel(low, low + length);
      panel(high - length, high);
      low += length;
      high -= length;
      length = low - begin;
    }
    const long long middle = low + (high - low) / 2;
    panel(low, middle);
    panel(middle, high);
  }

  void add_spikes(std::vector<std::pair<long long, double>>& spikes) {
    std::sort(spikes.begin(), spikes.end());
    for (std::size_t i = 0; i < spikes.size();) {
      const long long lag = spikes[i].first;
      double height = 0.0;
      for (; i < spikes.size() && spikes[i].first == lag; ++i) height += spikes[i].second;
      if (lag < first_ || lag > last_) continue;
      const double w = pairs(static_cast<double>(lag));
      const auto g = smooth(static_cast<double>(lag));
      sums_[index(kQ, kQ)] += w * height * height;
      sums_[index(kQ, kN)] += w * height * g[0];
      sums_[index(kQ, kB)] += w * height * g[1];
      sums_[index(kQ, kK)] += w * height * g[2];
    }
  }

 public:
  // Position of (j, l), j <= l, in the packed upper triangle.
  static constexpr std::size_t index(std::size_t j, std::size_t l) {
    return j * kTerms - j * (j + 1) / 2 + l;
  }

 private:
  const Difference& difference_;
  double m1_, m2_;
  std::vector<Places> places_;
  long long first_ = 0, last_ = 0;
  std::array<double, kTerms*(kTerms + 1) / 2> sums_{};
};

}  // namespace

double expected_variance(Deviation kind, Term term, std::size_t averaged) {
  const double m = static_cast<double>(averaged);
  const Difference d = difference_of(kind);
  double variance = 0.0;
  for (std::size_t a = 0; a < d.weight.size(); ++a)
    for (std::size_t b = 0; b < d.weight.size(); ++b) {
      const double t = (static_cast<double>(a) - static_cast<double>(b)) * m;
      const double g = term == kQ ? (a == b ? 1.0 : 0.0) : covariance_of_angle(t)[term - 1];
      variance += d.weight[a] * d.weight[b] * g;
    }
  return variance / (d.norm * m * m);
}

DifferenceCovariance::DifferenceCovariance(Deviation kind, std::span<const std::size_t> m,
                                           std::span<const std::size_t> samples)
    : count_(m.size()) {
  const Difference d = difference_of(kind);
  const std::size_t order = d.weight.size() - 1;
  const auto places = [&](std::size_t averaged) {
    double all = 0.0;
    for (const std::size_t n : samples)
      all += std::max(0.0, static_cast<double>(n + 1) - static_cast<double>(order * averaged));
    return all;
  };
  for (std::size_t i = 0; i < m.size(); ++i)
    for (std::size_t j = i; j < m.size(); ++j) {
      auto& sums = sums_.emplace_back();
      // Averaging times this far apart share no noise worth the name: correlation below 1e-4.
      if (m[j] / m[i] > 1024 || places(m[j]) == 0.0) continue;
      sums = Pair(d, m[i], m[j], samples).sums();
      const double mi = static_cast<double>(m[i]), mj = static_cast<double>(m[j]);
      const double scale = 2.0 / (d.norm * mi * mi * places(m[i])) / (d.norm * mj * mj * places(m[j]));
      for (double& s : sums) s *= scale;
    }
}

std::vector<double> DifferenceCovariance::at(const TermVariances& v) const {
  std::vector<double> c(count_ * count_);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count_; ++i)
    for (std::size_t j = i; j < count_; ++j, ++next) {
      double value = 0.0;
      for (std::size_t a = 0; a < kTerms; ++a)
        for (std::size_t b = a; b < kTerms; ++b)
          value += (a == b ? 1.0 : 2.0) * v[a] * v[b] * sums_[next][Pair::index(a, b)];
      c[i * count_ + j] = c[j * count_ + i] = value;
    }
  return c;
}

}  // namespace ifog
