// SPDX-License-Identifier: Apache-2.0
// The numbers at a picture's axes: read as what stands there, each another than its neighbour, none over
// another, whatever the range.
#include <regex>

#include "tests/unit/test.h"
#include "tools/report/chart.h"
#include "tools/report/coefficients.h"
#include "tools/report/pages/fleet_page.h"
#include "tools/report/scale.h"

namespace {

using namespace ifog::report;

struct Number {
  double px;
  std::string text;
};

// Of the axis whose numbers have this anchor: x in the middle, y at the end.
std::vector<Number> numbers(const std::string& svg, const std::string& anchor) {
  const std::regex tick("<text class=\"tick\" x=\"([-\\d.]+)\" y=\"([-\\d.]+)\" text-anchor=\"" + anchor +
                        "\">([^<]*)<");
  std::vector<Number> out;
  for (std::sregex_iterator at(svg.begin(), svg.end(), tick), end; at != end; ++at)
    out.push_back({std::stod((*at)[anchor == "middle" ? 1 : 2]), (*at)[3]});
  return out;
}

std::size_t characters(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

// "−1.20 × 10⁻⁶" back to a number.
double value_of(std::string text) {
  const auto replaced = [&](const std::string& from, const std::string& to) {
    for (std::size_t at; (at = text.find(from)) != std::string::npos;) text.replace(at, from.size(), to);
  };
  replaced(" × 10", "e");
  replaced("−", "-");
  replaced("⁻", "-");
  const char* const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  for (int d = 0; d < 10; ++d) replaced(digits[d], std::to_string(d));
  return std::stod(text);
}

struct Range {
  double low, high;
  bool log = false;
};

const std::vector<Range> kRanges = {
    {0.0, 40.0},       {20.00001, 20.00002},     {-20.00002, -20.00001}, {-1e-9, 1e-9},
    {1.1e-9, 1.7e-9},  {-5000000.0, -4999960.0}, {1.7e9, 1.7e9 + 40.0},  {1.7e9, 1.7e9 + 0.01},
    {9.6e5, 1.13e6},   {99999.5, 100000.5},      {-0.5, 99.0},           {1e-300, 3e-300},
    {1e-5, 1e5, true}, {1e-12, 2e3, true},       {0.01, 10.0, true},     {3e-9, 8e-9, true},
    {2e5, 9e7, true},
};

TEST(AxisNumbers, AreReadAsWhatStandsThereAndStandApart) {
  for (const Range& range : kRanges)
    for (const double width : {300.0, 480.0, 720.0, 1100.0}) {
      SCOPED_TRACE(::testing::Message() << range.low << " to " << range.high << ", " << width << " px");
      Chart chart("t", "d", {"x", range.log, range.low, range.high}, {"y", range.log, range.low, range.high});
      chart.line(Role::kAfter, "", {range.low, range.high}, {range.low, range.high});
      const std::string svg = chart.panel(width, 320.0, chart.left_margin(320.0));
      const std::vector<Number> x = numbers(svg, "middle"), y = numbers(svg, "end");
      if (!range.log || range.high / range.low > 20.0) {
        EXPECT_GE(x.size(), width < 720.0 ? 1U : 2U);
        EXPECT_GE(y.size(), 2U);
      }
      const auto scaled = [&](double v) { return range.log ? std::log10(v) : v; };
      for (const auto* axis : {&x, &y})
        for (std::size_t i = 2; i < axis->size(); ++i) {
          const Number &a = axis->front(), &b = (*axis)[i - 1], &c = (*axis)[i];
          EXPECT_NE(b.text, c.text);
          // In line with the first: within a pixel or so of where its number belongs.
          const double per = (b.px - a.px) / (scaled(value_of(b.text)) - scaled(value_of(a.text)));
          EXPECT_NEAR(c.px, a.px + per * (scaled(value_of(c.text)) - scaled(value_of(a.text))), 1.5);
        }
      std::vector<Number> in_order = x;
      std::sort(in_order.begin(), in_order.end(), [](auto& a, auto& b) { return a.px < b.px; });
      constexpr double kDigit = 7.64;  // of the 12 px face, its widest
      for (std::size_t i = 1; i < in_order.size(); ++i) {
        const double halves =
            0.5 * kDigit *
            static_cast<double>(characters(in_order[i].text) + characters(in_order[i - 1].text));
        EXPECT_GT(in_order[i].px - in_order[i - 1].px, halves)
            << in_order[i - 1].text << " | " << in_order[i].text;
      }
    }
}

// Two samples of one clock tick: what lies between has no doubles left, and is drawn nevertheless, at once.
TEST(AxisNumbers, ARangeWithoutDoublesInItEnds) {
  for (const double at : {1.7e9, -3.0, 1e-310, 0.0}) {
    Chart chart("t", "d", {"x", false, at, std::nextafter(at, 1e300)}, {"y", false, at, at});
    chart.line(Role::kAfter, "", {at}, {at});
    const std::string svg = chart.svg();
    EXPECT_FALSE(ifog::test::has(svg, "nan")) << at;
    EXPECT_FALSE(ifog::test::has(svg, "inf")) << at;
    EXPECT_LT(svg.size(), 20000U) << at;
  }
}

TEST(TimeAxis, CountsFromAWholeSecondWhereTimesAreLong) {
  const TimeAxis unix_time(1700000000.25, 1700000040.25);
  EXPECT_EQ(unix_time.label(), "time since 1700000000 s (s)");
  EXPECT_EQ(unix_time(1700000003.5), 3.5);
  EXPECT_EQ(*unix_time.axis().low, 0.25);
  EXPECT_EQ(*unix_time.axis().high, 40.25);
  const TimeAxis eleven_days(1.7e9, 1.7e9 + 1e6);
  EXPECT_EQ(eleven_days.label(), "time since 1700000000 s (h)");
  EXPECT_EQ(eleven_days(1.7e9 + 7200.0), 2.0);
  const TimeAxis before(-5000000.5, -4999000.5);
  EXPECT_EQ(before.label(), "time since −5000001 s (min)");
  EXPECT_EQ(before(-5000001.0 + 60.0), 1.0);
}

// A part of a record keeps the record's times, which --from and --to take.
TEST(TimeAxis, KeepsTimesThatCanBeRead) {
  const TimeAxis part(3600.0, 3640.0);
  EXPECT_EQ(part.label(), "time (s)");
  EXPECT_EQ(part(3601.0), 3601.0);
  const TimeAxis day(0.0, 86400.0);
  EXPECT_EQ(day.label(), "time (h)");
  EXPECT_EQ(day(7200.0), 2.0);
  EXPECT_TRUE(day.axis(false).label.empty());
  EXPECT_FALSE(day.axis(false).numbered);
}

TEST(Coefficients, APrintedBoundIsNeverBelowTheBound) {
  for (double upper = 1.003e-9; upper < 1e9; upper *= 1.0371) {
    const double printed = std::strtod(ifog::report::bound_text(upper).c_str(), nullptr);
    EXPECT_GE(printed, upper);
    EXPECT_LE(printed, 1.1 * upper);
  }
  EXPECT_EQ(ifog::report::bound_text(0.0), "0");
  EXPECT_EQ(ifog::report::bound_text(0.25), "0.25");
  EXPECT_EQ(ifog::report::bound_text(0.2501), "0.26");
  EXPECT_EQ(ifog::report::bound_text(9.91), "10");
}

TEST(Coefficients, ATermIsToldWithItsErrorOrItsBound) {
  ifog::NoiseCoefficients found;
  found.N = {true, 2.9088820866572159e-4, 2.9088820866572159e-6, 3e-4, 9.0};  // 1 °/√h and a hundredth of it
  found.B.upper = 4.8481368110953599e-6;                                      // 1 °/h
  const std::string lines = ifog::report::coefficient_lines(found);
  EXPECT_TRUE(ifog::test::has(lines, "1 ± 0.01"));
  EXPECT_TRUE(ifog::test::has(lines, "not seen; below 1 °/h\n"));
  const auto json = ifog::report::coefficients_json(found);
  EXPECT_TRUE(json["N"]["present"]);
  EXPECT_FALSE(json["K"]["present"]);
}

using namespace ifog;

// Twelve gyros of which the last has neither the effect nor the others' noise, and one without a result.
Population example() {
  Population p;
  p.type = "T<1>";
  TypeEffect effect;
  effect.effect.form = "linear";
  effect.effect.channel = "temperature_degC";
  effect.effect.meaning = "bias by temperature & more";
  effect.effect.parameters = {{"coefficient", 0.0, 0.0, "rad/s/degC"}};
  PopulationParameter noise;
  noise.name = "N";
  noise.unit = "rad/s/rtHz";
  noise.logarithmic = true;
  for (std::size_t i = 0; i < 13; ++i) {
    p.serials.push_back("G" + std::to_string(i));
    if (i == 12) continue;
    const double wiggle = 0.1 * std::sin(static_cast<double>(i));
    EffectInGyro each;
    each.gyro = i;
    each.own = Estimate{(i == 11 ? 0.0 : 6e-9) + 1e-9 * wiggle, 1e-9};
    each.found_alone = i < 4;
    effect.gyros.push_back(each);
    noise.gyros.push_back(i);
    noise.values.push_back({(i == 11 ? 9e-8 : 2e-8) * (1.0 + wiggle), 1e-10});
  }
  judge(effect, 0.01);
  effect.gyros.front().with_prior = Estimate{6e-9, 2e-10};
  p.effects = {effect};
  describe(noise);
  p.parameters = {noise};
  p.standing_out = standing_out(p.parameters);
  p.failed = {{12, "G12.csv: no <such> file"}};
  return p;
}

TEST(FleetPage, SaysWhatTheTypeHasWhoStandsOutAndWhoFailed) {
  const Population population = example();
  FleetPage page;
  page.population = &population;
  page.made = "today";
  page.command = "ifog fleet 'a<b.toml'";
  const std::string html = fleet_page(page);
  for (const char* id : {"account", "failed", "effects", "parameters", "standing-out", "gyros", "origin"})
    EXPECT_TRUE(test::has(html, "<h2 id=\"" + std::string(id) + "\">")) << id;
  EXPECT_FALSE(test::has(html, "<h2 id=\"own\">"));  // nothing to say
  EXPECT_TRUE(test::has(html, "found in 4 gyros by themselves, in 11 of 12 with what the type says"));
  EXPECT_TRUE(test::has(html, "<a href=\"gyros/G11/report.html\">G11</a></th><td>N</td>"));
  EXPECT_TRUE(test::has(html, "12 of 13 gyros have a result"));
  // What files say is text.
  EXPECT_TRUE(test::has(html, "T&lt;1&gt;") && test::has(html, "no &lt;such&gt; file") &&
              test::has(html, "a&lt;b.toml"));
  EXPECT_TRUE(test::has(html, "Bias by temperature &amp; more."));
  EXPECT_FALSE(test::has(html, "T<1>") || test::has(html, "no <such>") || test::has(html, "a<b.toml"));
}

}  // namespace
