// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/test.h"

namespace {

using ifog::CsvLayout;

struct Reading : ifog::Table {
  std::string refused;
};

Reading in_pieces(const std::string& text, std::size_t piece, const CsvLayout& layout = {}) {
  std::size_t at = 0;
  const auto read = [&](char* to, std::size_t most) {
    const std::size_t n = text.copy(to, most, at);
    at += n;
    return n;
  };
  const auto rows = [&](ifog::RowSink& sink) {
    return ifog::read_csv_rows(read, "a.csv", layout, sink, piece);
  };
  Reading out;
  out.refused = ifog::test::refusal([&] { static_cast<ifog::Table&>(out) = ifog::table_of(rows); }, "");
  return out;
}

void expect_same(const Reading& a, const Reading& b, std::size_t piece) {
  SCOPED_TRACE(piece);
  EXPECT_EQ(a.refused, b.refused);
  if (!a.refused.empty()) return;
  EXPECT_EQ(a.time_s, b.time_s);
  ASSERT_EQ(a.columns.size(), b.columns.size());
  for (std::size_t c = 0; c < a.columns.size(); ++c) {
    EXPECT_EQ(a.columns[c].name, b.columns[c].name);
    ASSERT_EQ(a.columns[c].values.size(), b.columns[c].values.size());
    // Bit for bit, missing cells as well.
    EXPECT_EQ(0, std::memcmp(a.columns[c].values.data(), b.columns[c].values.data(),
                             a.columns[c].values.size() * sizeof(double)));
  }
  EXPECT_EQ(a.comments, b.comments);
  for (std::size_t row = 0; row < a.time_s.size(); ++row) ASSERT_EQ(a.line_of_row(row), b.line_of_row(row));
  EXPECT_EQ(a.header_line, b.header_line);
  EXPECT_EQ(a.faults, b.faults);
  EXPECT_EQ(a.notices, b.notices);
}

std::ptrdiff_t count_of(const std::vector<std::string>& said, const std::string& beginning) {
  return std::ranges::count_if(said, [&](const std::string& each) { return each.starts_with(beginning); });
}

constexpr std::size_t kWhole = std::size_t{1} << 24U;
constexpr std::array<std::size_t, 9> kPieces{1, 2, 7, 31, 100, 1000, 4096, 65536, std::size_t{1} << 20U};

// Comments, holes, missing cells, cells that no sensor measures, carriage returns, no end of the last line.
std::string long_text(std::size_t rows) {
  std::mt19937 random(11);
  std::string text =
      "\xEF\xBB\xBF# a gyro\r\n\n# of two axes\ntime_s,rate_x_radps,rate_y_radps,temp_degC\r\n";
  for (std::size_t i = 0; i < rows; ++i) {
    if (i % 997 == 5) text += i % 2 == 0 ? "# somebody came in\n" : "\n";
    char line[128];
    std::snprintf(line, sizeof line, "%.3f,%.9g,%s,%s%s",
                  0.01 * static_cast<double>(i + (i > rows / 2 ? 40 : 0)),
                  1e-6 * static_cast<double>(random() % 2000), i % 11 == 3 ? "nan" : "1e-5",
                  i == 1234     ? "-300"
                  : i % 50 == 0 ? "25.5"
                                : "",
                  i + 1 < rows ? (i % 3 == 0 ? "\r\n" : "\n") : "");
    text += line;
  }
  return text;
}

TEST(CsvRows, PiecesOfEverySizeAreTheWhole) {
  const std::string text = long_text(12000);
  const Reading whole = in_pieces(text, kWhole);
  ASSERT_EQ(whole.refused, "");
  EXPECT_EQ(whole.time_s.size(), 12000U);
  EXPECT_EQ(whole.faults.size(), 1U);
  for (const std::size_t piece : kPieces) expect_same(whole, in_pieces(text, piece), piece);
  // Long enough for threads, and not all at once.
  expect_same(whole, in_pieces(text, std::size_t{200} << 10U), 0);
}

// EECE5554, shakedPunch_parsed.csv: the last cell is the device's line in quotes, with its line end. A stray quote costs
// its own row.
TEST(CsvRows, AQuotedCellMayHoldALineEnd) {
  std::string text = "t_s,gyro_x_dps,\"Original,\nString\"\n";
  for (int i = 0; i < 3000; ++i)
    text += std::to_string(i) + ",0.5," + (i == 700 ? "\"$VN\n" : "\"$VN,\"\"1*6\r\n\"\r\n");
  const Reading whole = in_pieces(text, kWhole);
  ASSERT_EQ(whole.refused, "");
  EXPECT_EQ(whole.time_s.size(), 3000U);
  EXPECT_EQ(whole.line_of_row(10), 24U);
  EXPECT_EQ(ifog::RowNotes{}.line_of_row(10), 0U) << "of no file with lines";
  for (const std::size_t piece : kPieces) expect_same(whole, in_pieces(text, piece), piece);
}

TEST(CsvRows, ChosenColumnsAndAnglesAreTheWholesToo) {
  std::string text = "n;t;GyroX;Angle\n";
  for (int i = 0; i < 5000; ++i) {
    char line[96];
    std::snprintf(line, sizeof line, "x;%d;%d,25;%d\n", 10 * i, i % 7, (i * 3) % 360);
    text += line;
  }
  CsvLayout layout;
  layout.separator = ';';
  layout.time = ifog::CsvTime::parse("t:ms");
  layout.columns = {ifog::CsvColumn::parse("rate_x_radps=GyroX:deg/s"),
                    ifog::CsvColumn::parse("rate_y_radps=Angle:deg")};
  const Reading whole = in_pieces(text, kWhole, layout);
  ASSERT_EQ(whole.refused, "");
  EXPECT_NEAR(whole.columns[0].values[8], 1.25 * std::numbers::pi / 180.0, 1e-15);
  // Three degrees in ten milliseconds, also where the angle begins again.
  EXPECT_NEAR(whole.columns[1].values[120], 300.0 * std::numbers::pi / 180.0, 1e-9);
  for (const std::size_t piece : kPieces) expect_same(whole, in_pieces(text, piece, layout), piece);
}

// One damaged line of thousands is dropped and reported, wherever the piece ends; one in fifty is another table.
TEST(CsvRows, ADamagedLineIsLeftOutAndManyAreRefused) {
  const std::string text = long_text(6000);
  const auto with = [&](std::size_t line, const std::string& instead) {
    std::size_t at = 0;
    for (std::size_t i = 1; i < line; ++i) at = text.find('\n', at) + 1;
    return text.substr(0, at) + instead + text.substr(text.find('\n', at));
  };
  const Reading right = in_pieces(text, kWhole);
  for (const auto& [bad, said] :
       {std::pair<std::string, std::string>{
            "5,1,warm,3", "a.csv:4321: rate_y_radps is 'warm', expected a number, 'nan' or nothing"},
        {"5,1,2", "a.csv:4321: 3 cells, expected 4 (a truncated line?)"},
        {"5,1,2,3,4", "a.csv:4321: more cells than the 4 columns of the header"},
        {"0.5,1,2,3", "a.csv:4321: time_s is 0.5 s, expected more than in the row before"},
        {"999999,1,2,3", "a.csv:4321: time_s is 999999 s, expected less than in the next row"},
        {",1,2,3", "a.csv:4321: time_s is missing, expected a time"}}) {
    const std::string wrong = with(4321, bad);
    for (const std::size_t piece : kPieces) {
      const Reading found = in_pieces(wrong, piece);
      ASSERT_EQ(found.refused, "");
      EXPECT_EQ(found.time_s.size() + 1, right.time_s.size()) << bad << piece;
      EXPECT_EQ(count_of(found.faults, said + "; this"), 1) << bad << piece;
    }
    std::string rows = "time_s,rate_x_radps,rate_y_radps,t_K\n";
    for (int i = 0; i < 300; ++i) rows += i % 50 == 1 ? bad + "\n" : std::to_string(100 + i) + ",1,2,3\n";
    const std::string first = "a.csv:3" + said.substr(said.find(": "));
    for (const std::size_t piece : kPieces)
      EXPECT_TRUE(in_pieces(rows, piece).refused.starts_with(first)) << in_pieces(rows, piece).refused;
  }
  const std::string last = std::to_string(std::ranges::count(text, '\n') + 2);
  // What power that goes leaves of the last line, and what a file system adds.
  for (const std::string& rest : {std::string("900000"), std::string("900000,1,"),
                                  std::string("900000,1,2,3e-0"), std::string(4096, '\0')})
    for (const std::size_t piece : kPieces) {
      const Reading found = in_pieces(text + "\n" + rest, piece);
      ASSERT_EQ(found.refused, "");
      EXPECT_EQ(found.time_s.size(), right.time_s.size()) << piece;
      EXPECT_EQ(count_of(found.faults, "a.csv:" + last + ": "), 1) << piece;
    }
  // A header may be far down, and wrong there.
  std::string late;
  for (int i = 0; i < 3000; ++i) late += "# a long word of somebody\n";
  for (const std::size_t piece : kPieces) {
    EXPECT_EQ(in_pieces(late, piece).refused, "a.csv: no header line, expected 'time_s,rate_radps,…'");
    EXPECT_EQ(in_pieces(late + "time_s,a_V,a_V\n0,1,2\n", piece).refused,
              "a.csv:3001: column 'a_V' stands twice");
    EXPECT_EQ(in_pieces(late + "time_s,a_V\n", piece).refused, "a.csv: no rows after the header");
  }
}

// Above the table, where the last may be names, and between the rows.
TEST(CsvRows, AFileOfCommentsNeedsLittleMemory) {
  std::string comments;
  for (int i = 0; i < 600'000; ++i) comments += "#x\n";
  for (const std::string& text : {"# first\n" + comments + "#time_s,rate_radps\n0,0\n1,0\n",
                                  "# first\ntime_s,rate_radps\n0,0\n" + comments + "1,0\n"})
    for (const std::size_t piece : {std::size_t{4096}, kWhole}) {
      const Reading found = in_pieces(text, piece);
      EXPECT_EQ(found.refused, "");
      EXPECT_EQ(found.time_s.size(), 2U);
      EXPECT_EQ(found.line_of_row(1), static_cast<std::size_t>(std::ranges::count(text, '\n')));
      EXPECT_TRUE(found.comments.starts_with("first\n"));
      EXPECT_LE(found.comments.size(), std::size_t{1} << 20U);
      EXPECT_EQ(count_of(found.notices, "a.csv: of the comments the first 1048576 bytes are kept"), 1);
    }
}

TEST(CsvRows, SeparatorsThatAreBlanksCountAsSeparators) {
  CsvLayout layout;
  layout.separator = '\t';
  EXPECT_EQ(in_pieces("time_s\trate_radps\n0\t1\t\n1\t2\t \n", kWhole, layout).refused, "");
  EXPECT_EQ(in_pieces("time_s\trate_radps\n0\t1\t\t\n", kWhole, layout).refused,
            "a.csv:2: more cells than the 2 columns of the header");
}

}  // namespace
