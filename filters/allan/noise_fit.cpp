#include "filters/allan/noise_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "filters/allan/confidence.h"

namespace ifog {
namespace {

constexpr std::size_t kShortest = 64;
// What a term must gain in −2 ln(likelihood) to be kept; 9 is three standard deviations.
constexpr double kPrice = 9.0;
constexpr double kDoubt = 1.0;  // score from which a term left out keeps its say in the others' error bars
constexpr double kTolerated = 0.1;  // relative departure of the deviation that the error bars may take up

constexpr double kRampNeeded = 3.0;

using Subset = std::array<bool, kTerms>;

Subset subset(unsigned bits) {
  Subset s{};
  for (std::size_t t = 0; t < kTerms; ++t) s[t] = ((bits >> t) & 1U) != 0;
  return s;
}

// The measured variances, and everything the fit needs of the terms.
class Problem {
 public:
  // `use`: which of the points take part, ascending.
  Problem(const std::vector<DeviationPoint>& points, const DifferenceCovariance& covariance,
          std::vector<std::size_t> use)
      : covariance_(covariance),
        use_(std::move(use)),
        size_(static_cast<Eigen::Index>(use_.size())),
        measured_(size_),
        form_(size_, kTerms) {
    for (Eigen::Index i = 0; i < size_; ++i) {
      const DeviationPoint& p = points[use_[static_cast<std::size_t>(i)]];
      measured_[i] = p.variance;
      for (std::size_t t = 0; t < kTerms; ++t)
        form_(i, static_cast<Eigen::Index>(t)) =
            expected_variance(Deviation::kHadamard, static_cast<Term>(t), p.m);
    }
    // No term can be larger than what makes it fill one of the points alone; in these units all numbers are
    // about one.
    for (std::size_t t = 0; t < kTerms; ++t) {
      const auto column = static_cast<Eigen::Index>(t);
      unit_[t] = (measured_.array() / form_.col(column).array()).minCoeff();
    }
  }

  struct Solution {
    Subset used{};
    TermVariances value{};
    double chi_squared = 0.0;
  };

  // Fixed point of generalised least squares with values >= 0: at it the expected and the measured variances
  // agree in the weights that the values themselves imply, which is the maximum-likelihood equation of the
  // points' distribution.
  [[nodiscard]] Solution solve(const Subset& allowed) const {
    Eigen::VectorXd model = measured_;
    Solution s;
    TermVariances before{};
    for (int round = 0; round < 60; ++round) {
      s = best(allowed, model, round == 0 ? rough() : relative_covariance(before, model));
      double change = 0.0;
      for (std::size_t t = 0; t < kTerms; ++t) {
        change = std::max(change, std::abs(s.value[t] - before[t]) / unit_[t]);
        // Half steps stop a swing between two sets of weights.
        before[t] = round < 8 ? s.value[t] : 0.5 * (before[t] + s.value[t]);
      }
      model = expected(before);
      if (change < 1e-7) break;
    }
    return s;
  }

  // −2 ln(likelihood) of the points, taken as Gaussian with the solution's mean and covariance.
  [[nodiscard]] double deviance(const Solution& s) const {
    const Eigen::VectorXd model = expected(s.value);
    if (!(model.minCoeff() > 0.0)) return std::numeric_limits<double>::infinity();
    const Eigen::LDLT<Eigen::MatrixXd> c(relative_covariance(s.value, model));
    const Eigen::VectorXd residual = (measured_.array() / model.array() - 1.0).matrix();
    return residual.dot(c.solve(residual)) + c.vectorD().array().log().sum() +
           2.0 * model.array().log().sum();
  }

  // How many standard deviations the data ask for `term` beyond a solution without it.
  [[nodiscard]] double score(const Solution& without, std::size_t term) const {
    const Eigen::VectorXd model = expected(without.value);
    if (!(model.minCoeff() > 0.0)) return std::numeric_limits<double>::infinity();
    const Eigen::LDLT<Eigen::MatrixXd> c(relative_covariance(without.value, model));
    const Eigen::MatrixXd a = columns(without.used, model);
    const Eigen::VectorXd extra =
        (unit_[term] * form_.col(static_cast<Eigen::Index>(term)).array() / model.array()).matrix();
    const Eigen::VectorXd residual = (measured_.array() / model.array() - 1.0).matrix();
    // The part of the extra column that the solution's own terms cannot imitate.
    const Eigen::MatrixXd ca = c.solve(a);
    const Eigen::VectorXd own = (a.transpose() * ca).ldlt().solve(ca.transpose() * extra);
    const Eigen::VectorXd direction = c.solve(extra - a * own);
    return direction.dot(residual) / std::sqrt(direction.dot(extra - a * own));
  }

  // Relative error of every point beyond chance, so large that χ² is what it should be; 0 where it already
  // is.
  [[nodiscard]] double misfit_of(const Solution& s) {
    const auto used = static_cast<std::size_t>(std::count(s.used.begin(), s.used.end(), true));
    const double degrees = static_cast<double>(size_) - static_cast<double>(used);
    if (degrees < 1.0) return 0.0;
    const Eigen::VectorXd model = expected(s.value);
    const Eigen::VectorXd residual = (measured_.array() / model.array() - 1.0).matrix();
    const Eigen::MatrixXd chance =
        relative_covariance(s.value, model) - misfit_ * misfit_ * Eigen::MatrixXd::Identity(size_, size_);
    const auto chi = [&](double extra) {
      return residual.dot(
          (chance + extra * extra * Eigen::MatrixXd::Identity(size_, size_)).ldlt().solve(residual));
    };
    if (chi(0.0) <= chi_squared_quantile(0.995, degrees)) return 0.0;
    double low = 0.0, high = 10.0;
    for (int i = 0; i < 60; ++i) (chi(0.5 * (low + high)) > degrees ? low : high) = 0.5 * (low + high);
    return high;
  }

  void set_misfit(double relative) { misfit_ = relative; }

  // Standard deviation of a term's variance when the terms of the solution and those of `beside` are all
  // open.
  [[nodiscard]] double error(const Solution& s, const Subset& beside, std::size_t term) const {
    Subset open = s.used;
    for (std::size_t t = 0; t < kTerms; ++t) open[t] = open[t] || beside[t] || t == term;
    const Eigen::VectorXd model = expected(s.value);
    const Eigen::MatrixXd a = columns(open, model);
    const Eigen::MatrixXd covariance =
        (a.transpose() * relative_covariance(s.value, model).ldlt().solve(a)).inverse();
    Eigen::Index place = 0;
    for (std::size_t t = 0; t < term; ++t) place += open[t] ? 1 : 0;
    return std::sqrt(std::max(0.0, covariance(place, place))) * unit_[term];
  }

 private:
  [[nodiscard]] Eigen::VectorXd expected(const TermVariances& v) const {
    Eigen::VectorXd model = Eigen::VectorXd::Zero(size_);
    for (std::size_t t = 0; t < kTerms; ++t) model += v[t] * form_.col(static_cast<Eigen::Index>(t));
    return model;
  }

  // Of the measured over the modelled variances.
  [[nodiscard]] Eigen::MatrixXd relative_covariance(const TermVariances& v,
                                                    const Eigen::VectorXd& model) const {
    const std::vector<double> c = covariance_.at(v);
    Eigen::MatrixXd matrix(size_, size_);
    for (Eigen::Index i = 0; i < size_; ++i)
      for (Eigen::Index j = 0; j < size_; ++j)
        matrix(i, j) =
            c[use_[static_cast<std::size_t>(i)] * covariance_.size() + use_[static_cast<std::size_t>(j)]];
    Eigen::MatrixXd relative = model.cwiseInverse().asDiagonal() * matrix * model.cwiseInverse().asDiagonal();
    relative.diagonal().array() += misfit_ * misfit_;
    return relative;
  }

  // To begin with: errors grow with the root of the averaging time.
  [[nodiscard]] Eigen::MatrixXd rough() const {
    Eigen::VectorXd d(size_);
    for (Eigen::Index i = 0; i < size_; ++i) d[i] = std::exp2(static_cast<double>(i - size_));
    return d.asDiagonal();
  }

  [[nodiscard]] Eigen::MatrixXd columns(const Subset& used, const Eigen::VectorXd& model) const {
    Eigen::MatrixXd a(size_, std::count(used.begin(), used.end(), true));
    Eigen::Index column = 0;
    for (std::size_t t = 0; t < kTerms; ++t)
      if (used[t])
        a.col(column++) = unit_[t] * form_.col(static_cast<Eigen::Index>(t)).array() / model.array();
    return a;
  }

  // Non-negative least squares by trying every set of terms: there are fifteen.
  [[nodiscard]] Solution best(const Subset& allowed, const Eigen::VectorXd& model,
                              const Eigen::MatrixXd& covariance) const {
    const Eigen::LDLT<Eigen::MatrixXd> c(covariance);
    const Eigen::VectorXd target = (measured_.array() / model.array()).matrix();
    Solution found;
    found.chi_squared = std::numeric_limits<double>::infinity();
    for (unsigned bits = (1U << kTerms) - 1; bits > 0; --bits) {
      const Subset used = subset(bits);
      bool fits = true;
      for (std::size_t t = 0; t < kTerms; ++t) fits = fits && (!used[t] || allowed[t]);
      if (!fits) continue;
      const Eigen::MatrixXd a = columns(used, model);
      const Eigen::MatrixXd ca = c.solve(a);
      const Eigen::VectorXd x = (a.transpose() * ca).ldlt().solve(ca.transpose() * target);
      if (!(x.minCoeff() >= 0.0)) continue;
      const Eigen::VectorXd residual = target - a * x;
      const double chi = residual.dot(c.solve(residual));
      if (chi >= found.chi_squared) continue;
      found.used = used;
      found.chi_squared = chi;
      found.value = {};
      Eigen::Index column = 0;
      for (std::size_t t = 0; t < kTerms; ++t)
        if (used[t]) found.value[t] = x[column++] * unit_[t];
      if (used == allowed) break;  // positive without being held: nothing smaller fits better
    }
    return found;
  }

  const DifferenceCovariance& covariance_;
  std::vector<std::size_t> use_;
  Eigen::Index size_;
  Eigen::VectorXd measured_;
  Eigen::MatrixXd form_;
  std::array<double, kTerms> unit_{};
  double misfit_ = 0.0;
};

struct Chosen {
  Problem::Solution solution;
  std::array<double, kTerms>
      score{};  // of a term kept: over the fit without it; of one left out: over the fit
};

// Makes room in the weights for what all four terms together cannot follow; returns it, relative to the
// variance.
double settle_misfit(Problem& problem) {
  Subset all;
  all.fill(true);
  double misfit = 0.0;
  for (int round = 0; round < 3; ++round) {
    misfit = problem.misfit_of(problem.solve(all));
    problem.set_misfit(misfit);
    if (misfit == 0.0) break;
  }
  return misfit;
}

// A line or a vibration lifts the curve at some τ far above any sum of terms. Those points are left out one
// by one, the one whose absence helps most first, until the rest is described to kTolerated; never more than
// half of them.
std::vector<std::size_t> described(const std::vector<DeviationPoint>& points,
                                   const DifferenceCovariance& covariance) {
  std::vector<std::size_t> use(points.size());
  for (std::size_t i = 0; i < use.size(); ++i) use[i] = i;
  const auto misfit_with = [&](const std::vector<std::size_t>& some) {
    Problem problem(points, covariance, some);
    return settle_misfit(problem);
  };
  double misfit = misfit_with(use);
  const std::size_t fewest = std::max<std::size_t>(6, (points.size() + 1) / 2);
  while (misfit > 2.0 * kTolerated && use.size() > fewest) {
    std::vector<std::size_t> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < use.size(); ++i) {
      std::vector<std::size_t> fewer = use;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
      const double found = misfit_with(fewer);
      if (found >= least) continue;
      least = found;
      best = std::move(fewer);
    }
    use = std::move(best);
    misfit = least;
  }
  return use;
}

// Of all sets of terms the one with the best likelihood, each term costing kPrice. Leaving out one term after
// the other is not enough: where a flicker floor and a random walk can stand for each other, the first to go
// decides.
Chosen choose(Problem& problem) {
  Subset all;
  all.fill(true);
  Chosen chosen;
  settle_misfit(problem);
  double lowest = std::numeric_limits<double>::infinity();
  for (unsigned bits = 1; bits < (1U << kTerms); ++bits) {
    const Subset allowed = subset(bits);
    const Problem::Solution s = problem.solve(allowed);
    if (s.used != allowed) continue;  // a term fell to zero; the set without it is tried by itself
    const double cost = problem.deviance(s) + kPrice * static_cast<double>(std::popcount(bits));
    if (cost >= lowest) continue;
    lowest = cost;
    chosen.solution = s;
  }
  for (std::size_t t = 0; t < kTerms; ++t) {
    Subset rest = chosen.solution.used;
    if (!rest[t]) {
      chosen.score[t] = problem.score(chosen.solution, t);
      continue;
    }
    rest[t] = false;
    chosen.score[t] = std::count(rest.begin(), rest.end(), true) == 0
                          ? std::numeric_limits<double>::infinity()
                          : problem.score(problem.solve(rest), t);
  }
  return chosen;
}

// The coefficient of a term whose variance is known as value ± error: square root, and its error to first
// order.
NoiseCoefficient coefficient(double variance, double error, double scale, double score, bool present) {
  NoiseCoefficient c;
  c.present = present;
  c.score = score;
  c.value = present ? std::sqrt(variance) * scale : 0.0;
  c.std_error = present ? 0.5 * error / std::sqrt(variance) * scale : std::sqrt(error) * scale;
  return c;
}

}  // namespace

NoiseFit fit_noise(const AngleSum& sum, double period_s, unsigned threads) {
  const std::size_t longest = sum.longest();
  if (longest < kShortest)
    throw std::invalid_argument("the longest stretch without gaps has " + std::to_string(longest) +
                                " samples, expected at least " + std::to_string(kShortest) +
                                " for a noise fit");
  std::vector<std::size_t> m;
  for (std::size_t k = 1; 4 * k <= longest; k *= 2) m.push_back(k);
  std::vector<std::size_t> lengths;
  for (const AngleSum::Part& part : sum.parts()) lengths.push_back(part.angles - 1);
  const std::vector<DeviationPoint> points = deviation(sum, m, Deviation::kHadamard, threads);
  for (const DeviationPoint& p : points)
    if (!(p.variance > 0.0)) throw std::invalid_argument("the rate never changes; there is no noise to fit");

  const DifferenceCovariance covariance(Deviation::kHadamard, m, lengths);
  const std::vector<std::size_t> use = described(points, covariance);
  Problem problem(points, covariance, use);
  const Chosen chosen = choose(problem);
  const Problem::Solution& s = chosen.solution;

  NoiseFit fit;
  fit.longest_tau_s = static_cast<double>(m[use.back()]) * period_s;
  for (std::size_t i = 0; i < m.size(); ++i)
    if (!std::binary_search(use.begin(), use.end(), i))
      fit.left_out_tau_s.push_back(static_cast<double>(m[i]) * period_s);
  const std::array<double, kTerms> scale{period_s, std::sqrt(period_s), 1.0, 1.0 / std::sqrt(period_s)};
  const std::array<NoiseCoefficient*, kTerms> target{&fit.Q, &fit.N, &fit.B, &fit.K};
  std::array<double, kTerms> error{};
  // A term left out though the data lean towards it may be there all the same: the others' error bars leave
  // room for it.
  Subset doubtful{};
  for (std::size_t t = 0; t < kTerms; ++t) doubtful[t] = !s.used[t] && chosen.score[t] > kDoubt;
  for (std::size_t t = 0; t < kTerms; ++t) {
    error[t] = problem.error(s, doubtful, t);
    *target[t] = coefficient(s.value[t], error[t], scale[t], chosen.score[t], s.used[t]);
  }
  fit.misfit = 0.5 * problem.misfit_of(s);

  // The ramp: mean of the second half less that of the first, over half the longest stretch.
  const auto part = std::max_element(sum.parts().begin(), sum.parts().end(),
                                     [](const auto& a, const auto& b) { return a.angles < b.angles; });
  const double* x = sum.angle().data() + part->first;
  const std::size_t half = (part->angles - 1) / 2;
  const double h = static_cast<double>(half);
  fit.ramp_radps2 = ((x[2 * half] - x[half]) - (x[half] - x[0])) / (h * h * period_s);
  const auto ramp_error = [&](double walk) {
    double variance = 0.0;
    for (std::size_t t = 0; t < kTerms; ++t)
      variance +=
          (t == kK ? walk : s.value[t]) * expected_variance(Deviation::kAllan, static_cast<Term>(t), half);
    return std::sqrt(2.0 * variance) / (h * period_s);
  };
  // A random walk too weak to be seen, or stronger than estimated, must not pass for a ramp.
  fit.R.score = std::abs(fit.ramp_radps2) / ramp_error(s.value[kK] + 2.0 * error[kK]);
  fit.R.present = fit.R.score >= kRampNeeded;
  fit.R.std_error = ramp_error(s.value[kK] + (doubtful[kK] ? error[kK] : 0.0));
  fit.R.value = fit.R.present ? std::abs(fit.ramp_radps2) : 0.0;
  return fit;
}

double modelled_deviation(const NoiseFit& fit, double tau_s) {
  const double q = fit.Q.value, n = fit.N.value, b = fit.B.value, k = fit.K.value, r = fit.R.value;
  return std::sqrt(3.0 * q * q / (tau_s * tau_s) + n * n / tau_s +
                   2.0 * std::numbers::ln2 / std::numbers::pi * b * b + k * k * tau_s / 3.0 +
                   r * r * tau_s * tau_s / 2.0);
}

}  // namespace ifog
