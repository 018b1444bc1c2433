// SPDX-License-Identifier: Apache-2.0
#include <regex>

#include "tests/unit/report/example.h"
#include "tests/unit/test.h"
#include "tools/report/chart.h"
#include "tools/report/pages/diagnosis_page.h"
#include "tools/report/pages/diagnosis_pictures.h"
#include "tools/report/pages/words.h"
#include "tools/report/picture.h"
#include "tools/report/text.h"

namespace {

using namespace ifog::report;

TEST(ReportText, NumbersAsPeopleWriteThem) {
  EXPECT_EQ(number(0.0), "0");
  EXPECT_EQ(number(440.26), "440");
  EXPECT_EQ(number(0.010832), "0.0108");
  EXPECT_EQ(number(999.96), "1000");
  EXPECT_EQ(number(-3.14159e-7), "−3.14 × 10⁻⁷");
  EXPECT_EQ(number(std::nan("")), "–");
  EXPECT_EQ(with_error(-79.1999, 0.1512), "−79.20 ± 0.15");
  EXPECT_EQ(with_error(1.234e-8, 5e-10), "(1.234 ± 0.050) × 10⁻⁸");
  EXPECT_EQ(escaped("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
}

TEST(ReportText, UnitsOfTheField) {
  EXPECT_EQ(channel_label("coil_temperature_degC"), "coil temperature (°C)");
  EXPECT_EQ(channel_label("accel_x_mps2"), "accel x (m/s²)");
  EXPECT_EQ(field_unit("rad/s/degC").unit, "°/h/°C");
  EXPECT_NEAR(field_unit("rad/s/degC").scale, 206264.806, 1e-3);
  EXPECT_EQ(field_unit("rad/s^2").unit, "°/h/h");
  EXPECT_NEAR(field_unit("rad/s^2").scale, 206264.806 * 3600.0, 10.0);
  EXPECT_EQ(field_unit("s").unit, "s");
  EXPECT_EQ(figure("rms_10s_radps").label, "RMS of 10 s means");
  EXPECT_EQ(figure("heading_drift_rad").unit, "°");
}

// 3, 4, 5: amplitude 5e-7 at atan2(4, 3) = 53.13 deg. Along it 1/10 by the likelihood, of errors that are 3e-8 and 6e-8 the rest
// across, sqrt(45 - 25) e-8 over 5e-7 = 5.12 deg.
TEST(ReportText, ALineHasAmplitudeAndPhase) {
  ifog::FoundEffect found;
  found.effect.form = "line";
  found.effect.parameters = {
      {"cosine", 3e-7, 3e-8, "rad/s"}, {"sine", 4e-7, 6e-8, "rad/s"}, {"frequency_hz", 50.0, 0.1, "Hz"}};
  found.likelihood_ratio = 100.0;
  const auto shown = shown_parameters(found);
  ASSERT_EQ(shown.size(), 3U);
  EXPECT_EQ(shown[0].name, "amplitude");
  EXPECT_NEAR(shown[0].value, 5e-7, 1e-12);
  EXPECT_NEAR(shown[0].std_error, 5e-8, 1e-13);
  EXPECT_NEAR(shown[1].value, 53.13, 0.01);
  EXPECT_NEAR(shown[1].std_error, 5.12, 0.01);
}

// Where the data says a dot is, the picture has it: 0 and 10 on a linear axis, 1 and 100 on a logarithmic
// one.
TEST(ReportChart, DrawsDataWhereItIs) {
  Chart chart("t", "d", {"x", false, 0.0, 10.0}, {"y", true, 1.0, 100.0});
  chart.points(Role::kBefore, "", {0.0, 5.0, 10.0}, {1.0, 10.0, 100.0});
  const std::string svg = chart.svg(1000, 500);
  std::smatch m;
  ASSERT_TRUE(std::regex_search(
      svg, m, std::regex("M([\\d.]+) ([\\d.]+)h0M([\\d.]+) ([\\d.]+)h0M([\\d.]+) ([\\d.]+)h0")));
  const double x0 = std::stod(m[1]), x1 = std::stod(m[3]), x2 = std::stod(m[5]);
  const double y0 = std::stod(m[2]), y1 = std::stod(m[4]), y2 = std::stod(m[6]);
  EXPECT_NEAR(x1, 0.5 * (x0 + x2), 0.11);
  EXPECT_NEAR(y1, 0.5 * (y0 + y2), 0.11);
  EXPECT_LT(y2, y0);
}

TEST(ReportChart, DenseCurvesKeepTheirExtremes) {
  Chart chart("t", "d", {"x", false, {}, {}}, {"y", false, 0.0, 1.0});
  std::vector<double> x(100000), y(100000, 0.5);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = static_cast<double>(k);
  y[54321] = 1.0;  // one spike among a hundred samples a pixel
  Chart flat("t", "d", {"x", false, {}, {}}, {"y", false, 0.0, 1.0});
  flat.line(Role::kAfter, "", x, std::vector<double>(100000, 0.5));
  chart.line(Role::kAfter, "", x, y);
  EXPECT_TRUE(ifog::test::has(chart.svg(), "V34.0"));  // the plot's upper edge
  EXPECT_FALSE(ifog::test::has(flat.svg(), "V34.0L"));
  EXPECT_LT(chart.svg().size(), 60000U);
}

TEST(ReportChart, GapsAndImpossibleValuesAreLeftOut) {
  Chart chart("t", "d", {"x", true, {}, {}}, {"y", true, {}, {}});
  chart.line(Role::kAfter, "a", {-1.0, 1.0, 2.0, 3.0}, {1.0, 0.0, std::nan(""), 4.0});
  EXPECT_FALSE(chart.empty());
  EXPECT_FALSE(ifog::test::has(chart.svg(), "nan"));
  EXPECT_FALSE(ifog::test::has(chart.svg(), "inf"));
  Chart nothing("t", "d", {"x", true, {}, {}}, {"y", true, {}, {}});
  EXPECT_EQ(nothing.svg(), "");
}

// Nothing is drawn across a hole in the rows; a sample or two that are missing are none.
TEST(ReportChart, ALineInTimeIsOpenWhereThereIsAHole) {
  std::vector<double> time, y;
  for (int i = 0; i < 200; ++i) {
    if (i == 20 || (i >= 60 && i < 140)) continue;
    time.push_back(0.01 * i);
    y.push_back(i % 3);
  }
  const auto strokes = [&](bool in_time) {
    Chart chart("t", "d", {"x", false, {}, {}}, {"y", false, {}, {}});
    if (in_time)
      chart.line_in_time(Role::kAfter, "", time, y);
    else
      chart.line(Role::kAfter, "", time, y);
    const std::string svg = chart.svg();
    const std::size_t at = svg.find("class=\"line after");
    const std::string path = svg.substr(at, svg.find("/>", at) - at);
    return std::count(path.begin(), path.end(), 'M');
  };
  EXPECT_EQ(strokes(true), 2);
  EXPECT_EQ(strokes(false), 1);
}

// A band is drawn from its lower to its upper edge and widens the axis; a guide does not.
TEST(ReportChart, BandsWidenTheAxesAndGuidesDoNot) {
  Chart chart("t", "d", {"x", false, 0.0, 10.0}, {"y", false, {}, {}});
  chart.line(Role::kAfter, "", {0.0, 10.0}, {1.0, 1.0});
  chart.band(Role::kAfter, {0.0, 10.0}, {0.0, 0.0}, {2.0, 2.0});
  chart.guide(Role::kAfter, {0.0, 10.0}, {100.0, 100.0});
  const std::string svg = chart.svg(1000, 500);
  std::smatch m;
  ASSERT_TRUE(
      std::regex_search(svg, m,
                        std::regex("class=\"band after\" d=\"M[\\d.]+ ([\\d.]+)L[\\d.]+ ([\\d.]+)L[\\d.]+ "
                                   "([\\d.]+)L[\\d.]+ ([\\d.]+)Z")));
  EXPECT_EQ(m[1], m[2]);
  EXPECT_EQ(m[3], m[4]);
  // 2 at the upper edge and 0 at the lower one, less the margin of 4 % of the span on each side.
  const double inner = 500.0 - 46.0 - 34.0;
  EXPECT_NEAR(std::stod(m[3]) - std::stod(m[1]), inner / 1.08, 0.3);
}

TEST(ReportChart, LegendsThatAreLongTakeAnotherRow) {
  Chart chart("t", "d", {"x", false, {}, {}}, {"y", false, {}, {}});
  for (int i = 0; i < 6; ++i)
    chart.line(role_of(static_cast<std::size_t>(i)), "a capture with a long name " + std::to_string(i),
               {0.0, 1.0}, {0.0, 1.0});
  const std::string both = chart.svg(720, 320);
  const std::size_t narrow = both.find("<svg class=\"chart narrow");
  ASSERT_NE(narrow, std::string::npos);
  for (const auto& [svg, width] : {std::pair{both.substr(0, narrow), 720.0}, {both.substr(narrow), 350.0}}) {
    double right = 0.0;
    const std::regex entry(
        "<text class=\"tick\" x=\"([\\d.]+)\" y=\"[\\d.]+\" text-anchor=\"start\">(a capture[^<]*)");
    int entries = 0;
    for (std::sregex_iterator at(svg.begin(), svg.end(), entry), end; at != end; ++at, ++entries)
      right = std::max(right, std::stod((*at)[1]) + 6.0 * static_cast<double>((*at)[2].length()));
    EXPECT_EQ(entries, 6);
    EXPECT_LT(right, width);
  }
}

// The output of librsvg is tested by its bytes: the curve's blue is there, and nothing is black but
// ink.
TEST(ReportPicture, SvgAndPngByTheName) {
  Chart chart("a <b> & \x1b[31m \xff", "d", {"x", false, {}, {}}, {"y", true, {}, {}});
  chart.line(Role::kAfter, "name \x01", {0.0, 1.0, 2.0}, {1.0, 10.0, 100.0});
  const std::string svg =
      picture_svg("title \x07 & more", {{200.0, {{chart}, {chart, 2.0}}}, {100.0, {{chart}}}}, 600.0);
  EXPECT_EQ(svg.find("var("), std::string::npos) << "librsvg knows no variables";
  for (const char c : svg) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 || c == '\n');
  EXPECT_TRUE(ifog::test::has(svg, "a &lt;b&gt; &amp; \\x1b[31m \\xff"));
  const ifog::test::OwnFolder folder;
  write_picture(folder.path("picture.svg"), svg);
  EXPECT_EQ(folder.content("picture.svg"), svg);
  write_picture(folder.path("picture.png"), svg);
  const std::string png = folder.content("picture.png");
  ASSERT_GT(png.size(), 5000U) << "an empty page packs to less";
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  // The header has width and height, two dots a pixel.
  const auto word = [&](std::size_t at) {
    return static_cast<unsigned char>(png[at + 2]) * 256 + static_cast<unsigned char>(png[at + 3]);
  };
  EXPECT_EQ(word(16), 1200);
  EXPECT_EQ(word(20), 2 * (10 + 30 + 200 + 6 + 100 + 6 + 10));
  EXPECT_THROW(write_picture(folder.path("broken.png"), "<svg"), std::runtime_error);
  EXPECT_EQ(wrong_picture_name("a.svg"), "");
  EXPECT_NE(wrong_picture_name("a.jpeg"), "");
}

// The dots are means of what was measured: they lie on the effect that was put in.
TEST(ReportTraced, DotsLieOnTheEffect) {
  const ifog::example::Example e = ifog::example::make();
  const Traced linear = trace(e.records(), e.diagnosis, 0);
  ASSERT_GT(linear.x.size(), 50U);
  EXPECT_FALSE(linear.angle);
  const double slope = (linear.y.back() - linear.y.front()) / (linear.x.back() - linear.x.front());
  EXPECT_NEAR(slope / ifog::example::kPerDegree, 1.0, 0.15);
  const Traced table = trace(e.records(), e.diagnosis, 1);
  ASSERT_TRUE(table.angle);
  double worst = 0.0;
  for (std::size_t i = 0; i < table.x.size(); ++i)
    worst = std::max(worst, std::abs(table.y[i] - ifog::example::ramp_angle(table.x[i])));
  EXPECT_LT(worst, 3e-8) << "amplitude is 2e-7";
}

std::string page_of(const ifog::example::Example& e) {
  Page page;
  page.sensor = "bench & co";
  page.captures = {"bench.csv"};
  page.axes = {{"\"><i>", &e.diagnosis, e.records()}};
  page.model_path = "bench.toml";
  page.made = "2026-01-01, ifog 0.2.0";
  page.command = "ifog diagnose bench.csv --report 'a & b.html'";
  page.inputs = {{"bench.csv", std::string(64, 'c'), {"serial: 17 <b>"}}};
  return diagnosis_page(page);
}

std::size_t count_of(const std::string& html, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = html.find(part); at != std::string::npos; at = html.find(part, at + 1)) ++count;
  return count;
}

TEST(ReportPage, HoldsEverySectionAndFetchesNothing) {
  const std::string html = page_of(ifog::example::make());
  for (const char* part : {"In short", "Two effects were found", "The error before and after",
                           "What was found", "Before and after in figures", "What cannot be distinguished",
                           "What remains", "Applying it", "ifog denoise", "RMS of 10 s means",
                           "bench &amp; co", "&lt;2 pi reset&gt;", "A capture with faster changes", "τ",
                           "serial: 17 &lt;b&gt;", "a &amp; b.html", "cccccccc", "class=\"band after\""})
    EXPECT_TRUE(ifog::test::has(html, part)) << part;
  EXPECT_FALSE(ifog::test::has(html, "<i>"));
  EXPECT_FALSE(std::regex_search(html, std::regex("(src|href)=\"(?!#|data:,)")));
  // One script, in the page, that asks nobody for anything; numbers packed for it are no text.
  EXPECT_EQ(count_of(html, "<script"), 1U);
  for (const char* part : {"url(", "fetch(", "XMLHttp", "import", "WebSocket", "sendBeacon", "eval("})
    EXPECT_FALSE(ifog::test::has(html, part)) << part;
  std::string shown = html;
  for (std::size_t at = shown.find("data-plot=\""); at != std::string::npos;
       at = shown.find("data-plot=\"", at + 1))
    shown.erase(at + 11, shown.find('"', at + 11) - at - 11);
  EXPECT_FALSE(ifog::test::has(shown, "nan"));
  EXPECT_LT(html.size(), 2'000'000U);
  // For the browser's test.
  if (const char* path = std::getenv("IFOG_REPORT_OUTPUT")) std::ofstream(path) << html;
}

TEST(ReportPage, NothingFoundIsAResult) {
  ifog::example::Example e = ifog::example::make();
  e.diagnosis.effects.clear();
  e.diagnosis.series.contribution_radps.clear();
  e.diagnosis.indistinguishable.clear();
  e.diagnosis.unexplained = {};
  const std::string html = page_of(e);
  EXPECT_TRUE(ifog::test::has(html, "Nothing was found"));
  EXPECT_TRUE(ifog::test::has(html, "Nothing more is found"));
  EXPECT_FALSE(ifog::test::has(html, "nan"));
}

}  // namespace
