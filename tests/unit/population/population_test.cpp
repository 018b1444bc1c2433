// SPDX-License-Identifier: Apache-2.0
// Random effects against a published analysis, robust distances and shrinkage against closed forms.
#include "filters/population/population.h"
#include "filters/population/shrinkage.h"
#include "filters/population/type_effects.h"
#include "tests/unit/population/one_coefficient.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

// Thirteen trials of BCG vaccine (Colditz et al., JAMA 271 (1994) 698-702): ill and well of the vaccinated,
// ill and well of the others. The logarithm of the relative risk is the meta-analysis of many textbooks.
std::vector<Estimate> vaccine_trials() {
  constexpr std::array<std::array<double, 4>, 13> kTrials{{{4, 119, 11, 128},
                                                           {6, 300, 29, 274},
                                                           {3, 228, 11, 209},
                                                           {62, 13536, 248, 12619},
                                                           {33, 5036, 47, 5761},
                                                           {180, 1361, 372, 1079},
                                                           {8, 2537, 10, 619},
                                                           {505, 87886, 499, 87892},
                                                           {29, 7470, 45, 7232},
                                                           {17, 1699, 65, 1600},
                                                           {186, 50448, 141, 27197},
                                                           {5, 2493, 3, 2338},
                                                           {27, 16886, 29, 17825}}};
  std::vector<Estimate> estimates;
  for (const auto& [a, b, c, d] : kTrials)
    estimates.push_back({std::log(a / (a + b) / (c / (c + d))),
                         std::sqrt(1.0 / a - 1.0 / (a + b) + 1.0 / c - 1.0 / (c + d))});
  return estimates;
}

TEST(RandomEffects, TheVaccineTrialsAreAsPublished) {
  // metafor, rma(method = "DL"): mean -0.7141 +- 0.1787, tau^2 0.3088, Q(12) 152.2330, I^2 92.12 %.
  const RandomEffects found = random_effects(vaccine_trials());
  EXPECT_EQ(found.count, 13U);
  EXPECT_NEAR(found.mean, -0.7141, 5e-5);
  EXPECT_NEAR(found.mean_std_error, 0.1787, 5e-5);
  EXPECT_NEAR(found.spread * found.spread, 0.3088, 5e-5);
  EXPECT_NEAR(found.q, 152.2330, 5e-5);
  EXPECT_NEAR(found.i_squared, 0.9212, 5e-5);
}

TEST(RandomEffects, WithoutSpreadItIsTheWeightedMean) {
  const std::vector<Estimate> same{{2.0, 1.0}, {2.0, 0.5}, {2.0, 2.0}};
  const RandomEffects found = random_effects(same);
  EXPECT_DOUBLE_EQ(found.mean, 2.0);
  EXPECT_EQ(found.spread, 0.0);
  EXPECT_EQ(found.i_squared, 0.0);
  EXPECT_NEAR(found.mean_std_error, 1.0 / std::sqrt(1.0 + 4.0 + 0.25), 1e-15);
  EXPECT_THROW((void)random_effects({}), std::invalid_argument);
  EXPECT_THROW((void)random_effects(std::vector<Estimate>{{1.0, 0.0}}), std::invalid_argument);
}

TEST(RobustZ, OneFarOutMovesNeitherMedianNorSigma) {
  // Median 3, distances 2 1 0 1 997: their median 1.
  const std::vector<double> values{1.0, 2.0, 3.0, 4.0, 1000.0};
  EXPECT_DOUBLE_EQ(robust_spread(values).median, 3.0);
  EXPECT_DOUBLE_EQ(robust_spread(values).sigma, 1.4826);
  const std::vector<double> z = robust_z(values);
  EXPECT_NEAR(z[4], 997.0 / 1.4826, 1e-9);
  EXPECT_NEAR(z[0], -2.0 / 1.4826, 1e-12);
  EXPECT_TRUE(std::isnan(robust_z(std::vector<double>{1.0, NAN, 2.0, 3.0})[1]));
}

TEST(RobustZ, AMemberThatIsPoorlyKnownDoesNotStandOutForThat) {
  const std::vector<double> values{1.0, 2.0, 3.0, 4.0, 23.0};
  const std::vector<double> errors{0.1, 0.1, 0.1, 0.1, 10.0};
  const std::vector<double> z = robust_z(values, errors);
  EXPECT_NEAR(z[4], 20.0 / std::sqrt(1.4826 * 1.4826 - 0.01 + 100.0), 1e-12);
  EXPECT_NEAR(z[0], -2.0 / 1.4826, 1e-12);
}

TEST(StandingOut, NoiseIsComparedByItsLogarithm) {
  PopulationParameter parameter;
  parameter.name = "N";
  parameter.logarithmic = true;
  for (const double value : {0.9, 1.0, 1.1, 1.0, 0.95, 1.05, 9.0}) {
    parameter.gyros.push_back(parameter.gyros.size() + 10);
    parameter.values.push_back({value, 0.01});
  }
  describe(parameter);
  const std::vector<StandingOut> out = standing_out({parameter});
  ASSERT_EQ(out.size(), 1U);
  EXPECT_EQ(out.front().gyro, 16U);
  ASSERT_TRUE(parameter.spread);
  EXPECT_NEAR(parameter.robust.median, 0.0, 1e-12);
}

TypePrior prior_of(double mean, double spread) {
  TypePrior prior;
  prior.share = 0.8;
  prior.mean = mean;
  prior.mean_std_error = 0.1;
  prior.spread = spread;
  return prior;
}

TEST(Shrinkage, OneCoefficientIsWeightedByTheInverseVariances) {
  const Estimate own{4.0, 2.0};
  const TypePrior prior = prior_of(1.0, 1.0);
  // (4/4 + 1/1) / (1/4 + 1/1), and 1 / (1/4 + 1/1) besides the mean's own error, of which 4/5 comes through.
  const Estimate expected{1.6, std::sqrt(0.8 + 0.64 * 0.01)};
  EXPECT_NEAR(shrunk(prior, own).value, expected.value, 1e-12);
  EXPECT_NEAR(shrunk(prior, own).std_error, expected.std_error, 1e-12);
  const JointEstimate one{Eigen::VectorXd::Constant(1, 4.0), Eigen::MatrixXd::Constant(1, 1, 4.0)};
  const KnownCoefficient known{0, true, prior};
  const JointEstimate together = shrunk_together(one, {&known, 1});
  EXPECT_NEAR(together.values[0], expected.value, 1e-12);
  EXPECT_NEAR(std::sqrt(together.covariance(0, 0)), expected.std_error, 1e-12);
}

TEST(Shrinkage, KnowingOneCoefficientTellsOfAnother) {
  // By precision matrices, which is another way than the gain's: information adds up.
  JointEstimate own{Eigen::Vector3d(3.0, -1.0, 2.0), Eigen::MatrixXd(3, 3)};
  own.covariance << 2.0, 0.9, -0.3, 0.9, 1.0, 0.2, -0.3, 0.2, 1.5;
  TypePrior prior = prior_of(1.0, 0.5);
  prior.mean_std_error = 0.0;
  const KnownCoefficient known{1, true, prior};
  const JointEstimate found = shrunk_together(own, {&known, 1});
  Eigen::MatrixXd information = own.covariance.inverse();
  Eigen::VectorXd vector = information * own.values;
  information(1, 1) += 4.0;
  vector[1] += 4.0;
  EXPECT_TRUE(found.covariance.isApprox(information.inverse(), 1e-12));
  EXPECT_TRUE(found.values.isApprox(information.inverse() * vector, 1e-12));
}

TEST(Shrinkage, AnEffectThatIsNotThereIsAsIfItHadNotBeenFitted) {
  // Least squares of y = (1, 2, 4) on two columns, and on the first alone.
  Eigen::Matrix<double, 3, 2> columns;
  columns << 1.0, 0.0, 1.0, 1.0, 1.0, 2.0;
  const Eigen::Vector3d y(1.0, 2.0, 4.0);
  const Eigen::Matrix2d gram = columns.transpose() * columns;
  const JointEstimate both{gram.inverse() * columns.transpose() * y, gram.inverse()};
  const KnownCoefficient none{1, false, {}};
  const JointEstimate found = shrunk_together(both, {&none, 1});
  EXPECT_NEAR(found.values[0], 7.0 / 3.0, 1e-12);
  EXPECT_NEAR(found.values[1], 0.0, 1e-12);
  EXPECT_NEAR(found.covariance(0, 0), 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(found.covariance(1, 1), 0.0, 1e-12);
}

Effect effect(const std::string& form, const std::string& channel, double lag_s = 0.0,
              const std::string& axis = "") {
  Effect made;
  made.form = form;
  made.channel = channel;
  made.axis = axis;
  made.parameters = {{"coefficient", 1.0, 0.1, "rad/s"}};
  if (lag_s > 0.0) made.parameters.push_back({"lag_s", lag_s, 1.0, "s"});
  return made;
}

// The binomial's tail, term by term.
double tail(std::size_t n, double p, std::size_t least) {
  double sum = 0.0;
  for (std::size_t k = least; k <= n; ++k) {
    const auto x = static_cast<double>(k), m = static_cast<double>(n);
    sum += std::exp(std::lgamma(m + 1) - std::lgamma(x + 1) - std::lgamma(m - x + 1) + x * std::log(p) +
                    (m - x) * std::log1p(-p));
  }
  return sum;
}

TEST(TypeEffects, SoManyFalseAlarmsHappenOnceInAHundredTypes) {
  for (const std::size_t gyros : {1U, 2U, 10U, 40U, 200U, 1000U}) {
    const std::size_t least = least_repeats(gyros, 0.01);
    EXPECT_LE(tail(gyros, 0.01, least), 0.01 + 1e-12) << gyros;
    EXPECT_GT(tail(gyros, 0.01, least - 1), 0.01) << gyros;
  }
}

TEST(TypeEffects, FormsOfOneChannelStandForEachOther) {
  std::vector<FoundInGyro> found;
  for (std::size_t i = 0; i < 6; ++i)
    found.push_back({i, effect("lagged", "t_degC", 100.0 + 20.0 * static_cast<double>(i))});
  for (std::size_t i = 6; i < 9; ++i) found.push_back({i, effect("linear", "t_degC")});
  found.push_back({9, effect("linear", "supply_V")});
  const auto candidates = type_candidates(found, 20, 0.01);
  ASSERT_EQ(candidates.size(), 1U);
  EXPECT_EQ(candidates[0].found_in, 9U);
  ASSERT_EQ(candidates[0].forms.size(), 2U);
  EXPECT_EQ(candidates[0].forms[0].form, "lagged");
  // The middle of 100 120 140 160 180 200, by the logarithm.
  ASSERT_EQ(candidates[0].forms[0].parameters.size(), 2U);
  EXPECT_NEAR(candidates[0].forms[0].parameters[1].value, std::sqrt(140.0 * 160.0), 1e-9);
  EXPECT_EQ(candidates[0].forms[0].parameters[0].value, 0.0);
  EXPECT_TRUE(is_of(candidates[0], effect("linear", "t_degC")));
  EXPECT_FALSE(is_of(candidates[0], effect("linear", "supply_V")));
  EXPECT_FALSE(is_of(candidates[0], effect("linear", "t_degC", 0.0, "y")));
}

TEST(TypeEffects, FormsThatGyrosShowTogetherAreTwoEffects) {
  std::vector<FoundInGyro> found;
  for (std::size_t i = 0; i < 8; ++i) found.push_back({i, effect("linear", "t_degC")});
  for (std::size_t i = 4; i < 10; ++i) found.push_back({i, effect("quadratic", "t_degC")});
  EXPECT_EQ(type_candidates(found, 20, 0.01).size(), 2U);
}

TEST(TypeEffects, AxesAreApartAndEventsAreNobodys) {
  std::vector<FoundInGyro> found;
  for (std::size_t i = 0; i < 8; ++i) {
    found.push_back({i, effect("linear", "t_degC", 0.0, i % 2 == 0 ? "x" : "y")});
    found.push_back({i, effect("step", "")});
    found.push_back({i, effect("lookup", "ramp_counts")});
  }
  EXPECT_EQ(type_candidates(found, 10, 0.01).size(), 2U);
  // Two of a thousand gyros are what false alarms make.
  EXPECT_TRUE(
      type_candidates(std::vector<FoundInGyro>(found.begin(), found.begin() + 4), 1000, 0.01).empty());
}

TEST(TypeEffects, AGyroCountsOnce) {
  const std::vector<FoundInGyro> found{{3, effect("linear", "t_degC")}, {3, effect("linear", "t_degC")}};
  EXPECT_TRUE(type_candidates(found, 5, 0.01).empty());
}

}  // namespace
}  // namespace ifog
