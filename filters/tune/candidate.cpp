#include "filters/tune/candidate.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <iterator>
#include <stdexcept>

#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr double kLeastLog = -34.0;  // e^-34: a level that does not move within any record

// theta: ln q per sample, ln R.
class Level : public Candidate {
 public:
  explicit Level(double period_s) : period_(period_s) {}
  [[nodiscard]] std::string state() const override { return "random-walk"; }
  [[nodiscard]] int size() const override { return 2; }
  void start(std::span<double> theta) const override {
    theta[0] = -12.0;
    theta[1] = -0.7;  // white noise of unit successive differences has variance one half
  }
  void bounds(std::span<double> low, std::span<double> high) const override {
    low[0] = kLeastLog;
    high[0] = 4.0;
    low[1] = -16.0;
    high[1] = 8.0;
  }
  [[nodiscard]] FilterSettings settings(std::span<const double> theta, double scale) const override {
    FilterSettings s;
    s.state = state();
    s.process_noise = std::exp(theta[0]) * scale * scale / period_;
    s.measurement_noise = std::exp(theta[1]) * scale * scale;
    return s;
  }
  [[nodiscard]] std::vector<CandidateFigure> figures(std::span<const double> theta,
                                                     double scale) const override {
    const FilterSettings s = Level::settings(theta, scale);
    return {{"process_noise", "rad^2/s^3", s.process_noise},
            {"measurement_noise", "rad^2/s^2", s.measurement_noise},
            {"angle_random_walk", "rad/s/sqrt(Hz)", std::sqrt(s.measurement_noise * period_)},
            {"rate_random_walk", "rad/s^2/sqrt(Hz)", std::sqrt(s.process_noise)}};
  }

 protected:
  double period_;
};

// theta: level's two, ln variance of the process, ln correlation time in samples.
class LevelAndGaussMarkov : public Level {
 public:
  using Level::Level;
  [[nodiscard]] std::string state() const override { return "random-walk + gauss-markov"; }
  [[nodiscard]] int size() const override { return 4; }
  void start(std::span<double> theta) const override {
    Level::start(theta);
    theta[0] = -20.0;
    theta[2] = -5.0;
    theta[3] = 5.0;
  }
  void bounds(std::span<double> low, std::span<double> high) const override {
    Level::bounds(low, high);
    low[2] = -20.0;
    high[2] = 8.0;
    low[3] = -1.0;
    high[3] = 14.0;
  }
  [[nodiscard]] FilterSettings settings(std::span<const double> theta, double scale) const override {
    FilterSettings s = Level::settings(theta, scale);
    s.state = state();
    const double tau = std::exp(theta[3]) * period_;
    const double q = 2.0 * std::exp(theta[2]) * scale * scale / tau;
    s.state_parameters = {tau, q / s.process_noise};
    return s;
  }
  [[nodiscard]] std::vector<CandidateFigure> figures(std::span<const double> theta,
                                                     double scale) const override {
    auto out = Level::figures(theta, scale);
    out.push_back({"gauss_markov_sigma", "rad/s", std::exp(0.5 * theta[2]) * scale});
    out.push_back({"gauss_markov_correlation_time", "s", std::exp(theta[3]) * period_});
    return out;
  }
};

// theta: level's two, ln variance of the innovation e, atanh of p partial autocorrelations, of q of the MA
// part.
class LevelAndArma : public Level {
 public:
  LevelAndArma(double period_s, int p, int q) : Level(period_s), p_(p), q_(q) {}
  [[nodiscard]] std::string state() const override {
    return q_ == 0 ? "random-walk + ar(" + std::to_string(p_) + ")"
                   : "random-walk + arma(" + std::to_string(p_) + "," + std::to_string(q_) + ")";
  }
  [[nodiscard]] int size() const override { return 3 + p_ + q_; }
  void start(std::span<double> theta) const override {
    Level::start(theta);
    theta[0] = -20.0;
    theta[2] = -4.0;
    const std::span<double> partial = theta.subspan(kFirst, count(p_ + q_));
    std::fill(partial.begin(), partial.end(), 0.0);
    partial.front() = 1.5;
    if (q_ > 0) partial[count(p_)] = 0.2;
  }
  void bounds(std::span<double> low, std::span<double> high) const override {
    Level::bounds(low, high);
    low[2] = -24.0;
    high[2] = 8.0;
    std::fill_n(low.begin() + kFirst, p_ + q_, -6.0);
    std::fill_n(high.begin() + kFirst, p_ + q_, 6.0);
  }
  [[nodiscard]] FilterSettings settings(std::span<const double> theta, double scale) const override {
    FilterSettings s = Level::settings(theta, scale);
    s.state = state();
    s.state_parameters = coefficients(theta);
    s.state_parameters.push_back(std::exp(theta[2] - theta[0]));
    return s;
  }
  [[nodiscard]] std::vector<CandidateFigure> figures(std::span<const double> theta,
                                                     double scale) const override {
    auto out = Level::figures(theta, scale);
    out.push_back({"innovation_sigma", "rad/s", std::exp(0.5 * theta[2]) * scale});
    const auto c = coefficients(theta);
    for (int i = 0; i < p_ + q_; ++i)
      out.push_back({i < p_ ? "phi_" + std::to_string(i + 1) : "theta_" + std::to_string(i - p_ + 1), "",
                     c[static_cast<std::size_t>(i)]});
    return out;
  }

 private:
  [[nodiscard]] std::vector<double> coefficients(std::span<const double> theta) const {
    const auto part = [&](std::size_t first, int size) {
      std::vector<double> partial(count(size));
      const auto from = theta.subspan(kFirst + first, partial.size());
      std::transform(from.begin(), from.end(), partial.begin(),
                     [](double value) { return std::tanh(value); });
      return ar_from_partial(partial);
    };
    std::vector<double> c = part(0, p_);
    // 1 + θ(B) is invertible when −θ are the coefficients of a stationary AR.
    const std::vector<double> moving = part(count(p_), q_);
    std::transform(moving.begin(), moving.end(), std::back_inserter(c), std::negate<>());
    return c;
  }
  static constexpr std::size_t kFirst = 3;  // in theta, of the partial correlations
  static std::size_t count(int n) { return static_cast<std::size_t>(n); }
  int p_, q_;
};

// "ar(2)" → 2, 0; "arma(3,1)" → 3, 1.
bool orders(const std::string& term, int& p, int& q) {
  const auto read = [](const char* from, const char* end, int& value) {
    return std::from_chars(from, end, value).ptr;
  };
  const char* end = term.data() + term.size();
  p = q = 0;
  if (term.starts_with("ar(")) {
    const char* at = read(term.data() + 3, end, p);
    return p >= 1 && p <= 6 && std::string(at, end) == ")";
  }
  if (term.starts_with("arma(")) {
    const char* at = read(term.data() + 5, end, p);
    if (at == end || *at != ',') return false;
    at = read(at + 1, end, q);
    return p >= 1 && p <= 6 && q >= 1 && q < p && std::string(at, end) == ")";
  }
  return false;
}

}  // namespace

std::vector<double> ar_from_partial(std::span<const double> partial) {
  std::vector<double> phi, last;
  for (std::size_t k = 0; k < partial.size(); ++k) {
    last = phi;
    phi.push_back(partial[k]);
    for (std::size_t i = 0; i < k; ++i) phi[i] = last[i] - partial[k] * last[k - 1 - i];
  }
  return phi;
}

std::unique_ptr<Candidate> make_candidate(const std::string& state, double period_s) {
  if (state == "random-walk") return std::make_unique<Level>(period_s);
  if (state == "random-walk + gauss-markov") return std::make_unique<LevelAndGaussMarkov>(period_s);
  constexpr std::string_view kSum = "random-walk + ";
  int p = 0, q = 0;
  if (state.starts_with(kSum) && orders(state.substr(kSum.size()), p, q))
    return std::make_unique<LevelAndArma>(period_s, p, q);
  throw std::invalid_argument("state: " + in_quotes(state) +
                              ", expected random-walk, random-walk + gauss-markov, random-walk + ar(p) or "
                              "random-walk + arma(p,q) with q < p <= 6");
}

std::vector<std::string> default_candidates() {
  return {
      "random-walk",         "random-walk + gauss-markov", "random-walk + ar(1)",    "random-walk + ar(2)",
      "random-walk + ar(3)", "random-walk + arma(2,1)",    "random-walk + arma(3,2)"};
}

}  // namespace ifog
