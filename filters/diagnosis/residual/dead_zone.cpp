// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/dead_zone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/noise_fit.h"
#include "filters/diagnosis/search/scan.h"
#include "filters/linear/projection.h"

namespace ifog {
namespace {

// A sample or few in a block; longer records are averaged, and their zones with them.
constexpr std::size_t kMostBlocks = 40000;
constexpr std::size_t kFewest = 8;  // fine steps inside the narrowest zone
constexpr double kWidest = 0.5;     // of the largest rate
constexpr double kFactor = 1.15;    // between widths: neighbours correlate at 0.8
constexpr Eigen::Index kMostWidths = 48;
constexpr double kShare = 0.1;        // of the significance: one question beside all others
constexpr double kWithoutOne = 12.0;  // twice the log-likelihood that all passages but any one have to gain
constexpr double kNearlyWhole = 0.1;  // of a coefficient of -1, and three standard errors
constexpr Eigen::Index kPassageGap = 8;  // blocks; of one passage

// At rest the error is less the reference's own noise, and so it is in a zone as narrow as that: a zone is
// told by rates beyond it.
constexpr double kOwnNoise = 5.0;
constexpr double kBeyondNoise = 2.0;  // of that, the narrowest zone
constexpr std::size_t kWindow = 16;   // steps
constexpr double kSlowest = 0.2;      // of the windows

// Noise of a step of the reference, from second differences where it is nearest to zero: in rest, or in the
// middle of a swing.
double noise_of(const std::vector<double>& rates) {
  std::vector<std::pair<double, double>> windows;  // size of the mean, mean square
  for (std::size_t from = 0; from + kWindow <= rates.size(); from += kWindow) {
    double square = 0.0;
    for (std::size_t i = from + 1; i + 1 < from + kWindow; ++i) {
      const double d = rates[i - 1] - 2.0 * rates[i] + rates[i + 1];
      square += d * d;
    }
    const auto begin = rates.begin() + static_cast<std::ptrdiff_t>(from);
    const double sum = std::accumulate(begin, begin + kWindow, 0.0);
    windows.emplace_back(std::abs(sum), square / (6.0 * static_cast<double>(kWindow - 2)));
  }
  if (windows.empty()) return 0.0;
  std::sort(windows.begin(), windows.end());
  windows.resize(1 + static_cast<std::size_t>(kSlowest * static_cast<double>(windows.size() - 1)));
  const auto middle = windows.begin() + static_cast<std::ptrdiff_t>(windows.size() / 2);
  std::nth_element(windows.begin(), middle, windows.end(),
                   [](const auto& a, const auto& b) { return a.second < b.second; });
  return std::sqrt(middle->second);
}

// What is left of the measurement and of zones of several widths, whitened, beside the rate's own errors.
struct Projected {
  Eigen::VectorXd y;
  Columns zones;
};

class ZoneFit {
 public:
  explicit ZoneFit(const BlockData& data)
      : data_(data), narrow_(kOwnNoise * noise_of(rates())), beside_(beside()) {
    refit_noise(beside_);
  }

  [[nodiscard]] std::vector<double> widths() const {
    std::vector<double> sizes;
    for (const double rate : rates()) sizes.push_back(std::abs(rate));
    std::sort(sizes.begin(), sizes.end());
    const double least = std::max(kBeyondNoise * narrow_, sizes[std::min(kFewest, sizes.size() - 1)]);
    const double most = kWidest * sizes.back();
    if (!(least > 0.0) || !(least < most)) return {};
    const auto count =
        std::min(kMostWidths, static_cast<Eigen::Index>(std::log(most / least) / std::log(kFactor)) + 2);
    return spaced(least, most, count);
  }

  // Evenly in the logarithm.
  static std::vector<double> spaced(double low, double high, Eigen::Index count) {
    std::vector<double> values;
    for (Eigen::Index i = 0; i < count; ++i)
      values.push_back(low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(count - 1)));
    return values;
  }

  [[nodiscard]] Columns zones(const std::vector<double>& widths) const {
    ShapeSettings settings;
    settings.form = Form::kDeadZone;
    Columns columns(rows(), static_cast<Eigen::Index>(widths.size()));
    for (std::size_t i = 0; i < widths.size(); ++i) {
      settings.half_width = widths[i];
      columns.col(static_cast<Eigen::Index>(i)) =
          column(data_, settings, static_cast<std::size_t>(data_.reference));
    }
    return columns;
  }

  [[nodiscard]] Projected project(const std::vector<double>& widths) const {
    Columns all(rows(), beside_.cols() + static_cast<Eigen::Index>(widths.size()));
    all << beside_, zones(widths);
    Whitening(data_.grid, noise_.shape).apply(all);
    const Projection others(all.middleCols(1, beside_.cols() - 1));
    Projected out{all.col(0), all.rightCols(static_cast<Eigen::Index>(widths.size()))};
    others.take_out_of(out.y);
    others.take_out_of(out.zones);
    return out;
  }

  // Twice the log-likelihood that each gains.
  [[nodiscard]] Eigen::VectorXd ratios(const Projected& p) const {
    const double square = p.y.squaredNorm();
    Eigen::VectorXd out(p.zones.cols());
    for (Eigen::Index j = 0; j < out.size(); ++j) {
      const double xx = p.zones.col(j).squaredNorm();
      const double xy = p.zones.col(j).dot(p.y);
      const double gain = xx > 0.0 ? xy * xy / xx : 0.0;
      out[j] = -static_cast<double>(data_.grid.used()) * std::log(std::max(1.0 - gain / square, 1e-12));
    }
    return out;
  }

  // The noise under a zone of that width: twice the log-likelihood gained by it, noise fitted anew.
  double refit_beside(double width) {
    const double without = noise_.log_likelihood;
    Columns columns(rows(), beside_.cols() + 1);
    columns << beside_, zones({width});
    refit_noise(columns);
    return 2.0 * (noise_.log_likelihood - without);
  }

  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(data_.grid.size()); }

 private:
  [[nodiscard]] const std::vector<double>& rates() const {
    return data_.channels[static_cast<std::size_t>(data_.reference)].values;
  }

  void refit_noise(const Columns& columns) { noise_ = fit_noise(data_.grid, columns, noise_.shape); }

  // Measurement, constants, what a scale factor, its asymmetry and its nonlinearity would leave, and the
  // reference's noise at rest.
  [[nodiscard]] Columns beside() const {
    const auto reference = static_cast<std::size_t>(data_.reference);
    constexpr std::array kForms = {Form::kLinear, Form::kAbsolute, Form::kCubic, Form::kQuintic};
    const Columns constant = constants(data_.grid);
    Columns columns(rows(), 1 + constant.cols() + static_cast<Eigen::Index>(kForms.size()));
    columns.col(0) = data_.grid.error;
    columns.middleCols(1, constant.cols()) = constant;
    for (std::size_t i = 0; i < kForms.size(); ++i) {
      ShapeSettings settings;
      settings.form = kForms[i];
      Eigen::VectorXd mine = column(data_, settings, reference);
      mine /= std::max(mine.cwiseAbs().maxCoeff(), 1e-300);
      columns.col(1 + constant.cols() + static_cast<Eigen::Index>(i)) = mine;
    }
    const Columns narrow = zones({narrow_});
    if (!(narrow.squaredNorm() > 0.0)) return columns;
    columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    columns.rightCols(1) = narrow / narrow.cwiseAbs().maxCoeff();
    return columns;
  }

  const BlockData& data_;
  double narrow_;  // half width
  Columns beside_;
  NoiseFit noise_;
};

// Twice the log-likelihood that is left when the passage that says most is taken away; rows of x that are not
// zero in `zone` belong to one passage while they are near each other.
double without_best_passage(const Eigen::VectorXd& y, const Eigen::VectorXd& x, const Eigen::VectorXd& zone,
                            double variance) {
  std::vector<std::pair<double, double>> passages;  // xy, xx
  Eigen::Index last = -2 * kPassageGap;
  for (Eigen::Index i = 0; i < zone.size(); ++i) {
    if (zone[i] != 0.0) {
      if (i - last > kPassageGap) passages.emplace_back(0.0, 0.0);
      last = i;
    }
    if (passages.empty() || i - last > kPassageGap) continue;
    passages.back().first += x[i] * y[i];
    passages.back().second += x[i] * x[i];
  }
  const double xy = x.dot(y);
  const double xx = x.squaredNorm();
  double least = 0.0;
  for (std::size_t g = 0; g < passages.size(); ++g) {
    const double rest = xx - passages[g].second;
    const double other = xy - passages[g].first;
    const double left = rest > 1e-6 * xx && other * xy > 0.0 ? other * other / rest / variance : 0.0;
    if (g == 0 || left < least) least = left;
  }
  return least;
}

std::size_t best_of(const Eigen::VectorXd& ratios) {
  Eigen::Index at = 0;
  ratios.maxCoeff(&at);
  return static_cast<std::size_t>(at);
}

// The width of greatest likelihood, and half of the span in which twice the log-likelihood is within one of
// it.
void refine_width(const ZoneFit& fit, double low, double high, DeadZone& zone) {
  constexpr Eigen::Index kPoints = 33;
  for (int round = 0; round < 3; ++round) {
    const std::vector<double> widths = ZoneFit::spaced(low, high, kPoints);
    const Eigen::VectorXd ratios = fit.ratios(fit.project(widths));
    const std::size_t at = best_of(ratios);
    std::size_t from = at;
    std::size_t to = at;
    for (std::size_t i = 0; i < widths.size(); ++i) {
      if (ratios[static_cast<Eigen::Index>(i)] < ratios[static_cast<Eigen::Index>(at)] - 1.0) continue;
      from = std::min(from, i);
      to = std::max(to, i);
    }
    zone.half_width = widths[at];
    const double below = widths[from > 0 ? from - 1 : 0];
    const double above = widths[std::min(to + 1, widths.size() - 1)];
    zone.half_width_error = 0.5 * (above - below);
    low = below;
    high = above;
  }
}

std::optional<DeadZone> zone_in(const BlockData& data, double significance) {
  ZoneFit fit(data);
  const std::vector<double> widths = fit.widths();
  if (widths.empty()) return std::nullopt;
  const Projected coarse = fit.project(widths);
  const double tries = independent_columns(widths.size());
  const std::size_t at = best_of(fit.ratios(coarse));
  DeadZone zone;
  refine_width(fit, widths[at > 0 ? at - 1 : 0], widths[std::min(at + 1, widths.size() - 1)], zone);
  zone.ratio = fit.refit_beside(zone.half_width);
  // The width between its neighbours is a second parameter.
  zone.p_value = std::min(1.0, kProfiled * tail(zone.ratio, 2) * tries);
  if (zone.p_value > kShare * significance) return std::nullopt;
  const Projected p = fit.project({zone.half_width});
  const Eigen::VectorXd x = p.zones.col(0);
  zone.coefficient = x.dot(p.y) / x.squaredNorm();
  const double variance = (p.y - zone.coefficient * x).squaredNorm() / static_cast<double>(data.grid.used());
  zone.coefficient_error = std::sqrt(variance / x.squaredNorm());
  if (std::abs(zone.coefficient + 1.0) > kNearlyWhole + 3.0 * zone.coefficient_error) return std::nullopt;
  if (without_best_passage(p.y, x, fit.zones({zone.half_width}).col(0), variance) < kWithoutOne)
    return std::nullopt;
  return zone;
}

}  // namespace

std::optional<DeadZone> find_dead_zone(const std::vector<EvenError>& errors,
                                       const std::vector<Samples>& rates, double sample_s,
                                       double significance) {
  std::vector<Samples> times, measured;
  std::vector<Record> records;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    Samples& time = times.emplace_back();
    Samples& rate = measured.emplace_back();
    for (std::size_t i = 0; i < rates[r].size(); ++i) {
      time.push_back(static_cast<double>(i) * sample_s);
      rate.push_back(rates[r][i] + errors[r].after[i]);
    }
  }
  for (std::size_t r = 0; r < errors.size(); ++r) {
    Record record;
    record.name = std::to_string(r);
    record.time_s = times[r];
    record.rate_radps = measured[r];
    record.reference_radps = rates[r];
    records.push_back(std::move(record));
  }
  const BlockData data = cut_to_blocks(records, kMostBlocks);
  if (data.grid.dwells || !data.channels[static_cast<std::size_t>(data.reference)].varies)
    return std::nullopt;
  return zone_in(data, significance);
}

Samples hidden_by(const DeadZone& zone, std::span<const double> rate) {
  Samples hidden;
  hidden.reserve(rate.size());
  for (const double each : rate)
    hidden.push_back(std::abs(each) < zone.half_width ? zone.coefficient * each : 0.0);
  return hidden;
}

void take_out(const DeadZone& zone, const std::vector<Samples>& rates, BlockGrid& grid,
              std::vector<EvenError>& errors) {
  const double steps = grid.sample_s / grid.fine_s;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    const Samples hidden = hidden_by(zone, rates[r]);
    const BlockRange& record = grid.records[r];
    std::vector<double> sum(record.size(), 0.0);
    std::vector<double> count(record.size(), 0.0);
    Samples& rest = errors[r].rest.own();
    for (std::size_t i = 0; i < hidden.size(); ++i) {
      const bool measured = std::isfinite(rest[i]);
      rest[i] -= hidden[i];
      const auto step = static_cast<std::size_t>(std::floor(static_cast<double>(i) * steps + 0.5));
      const std::size_t b = std::min(step / grid.fine, record.size() - 1);
      if (!measured) continue;
      sum[b] += hidden[i];
      count[b] += 1.0;
    }
    for (std::size_t b = 0; b < record.size(); ++b)
      if (grid.valid[record.first + b] && count[b] > 0.0)
        grid.error[record.row() + static_cast<Eigen::Index>(b)] -= sum[b] / count[b];
  }
}

}  // namespace ifog
