// SPDX-License-Identifier: Apache-2.0
// DBC files as they are found: what others read is read, a line that cannot be read costs what stands on it
// and is named.
#include "drivers/dbc/codec.h"
#include "drivers/dbc/database.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog::dbc;

// A signal's line, at byte `at`.
std::string sg(const std::string& name, int at, const std::string& unit = "deg/s") {
  return " SG_ " + name + " : " + std::to_string(8 * at) + "|8@1+ (1,0) [0|0] \"" + unit + "\" X\n";
}

Database parse(const std::string& text) { return parse_database(text, "f.dbc"); }

std::string why_not(const Database& database, const std::string& name) {
  const std::vector<SignalInMessage> found = find_signals(database, name);
  if (found.size() != 1) return std::to_string(found.size()) + " found";
  return ifog::test::refusal([&] { check_fits(database, *found[0].message, *found[0].signal); }, "usable");
}

using Strings = std::vector<std::string>;

TEST(DbcBadLines, AStatementWithoutItsSemicolonSwallowsNothing) {
  for (const char* open : {"CM_ BO_ 1 \"of A\"", "CM_ SG_ 1 R \"of R; \nin two lines\"", "CM_ \"file\"",
                           "VAL_ 1 R 0 \"off\" 1 \"on\"", "VAL_TABLE_ T 0 \"off\"", "BA_ \"Cycle\" BO_ 1 10",
                           "BA_DEF_ BO_ \"Cycle\" INT 0 10", "BA_DEF_ SG_ \"Cycle\" INT 0 10",
                           "BA_REL_ \"X\" BU_SG_REL_ Node SG_ 1 R 5", "SIG_GROUP_ 1 G 1 : R"}) {
    const Database d = parse("BO_ 1 A: 8 X\n" + sg("R", 0) + open + "\nBO_ 2 B: 8 X\n" + sg("Q", 1));
    EXPECT_EQ(why_not(d, "B.Q"), "usable") << open;
    EXPECT_EQ(d.warnings, Strings{"f.dbc:3: a statement without its closing ';'"}) << open;
  }
  // With its ';' the same passes without a word, also where the line is broken.
  const Database d =
      parse("BO_ 1 A: 8 X\n" + sg("R", 0) +
            "CM_ BO_ 1 \"BO_ 7 Quoted: 8 X\nBO_ 8 Quoted: 8 X\n SG_ Z : 0|8@1+\" ;\nVAL_ 1 R\n 0 \"off\" ;\n"
            "BA_ \"Cycle\"\n BO_ 1 10;\nBO_TX_BU_ 1 : X,\n Y;\n");
  EXPECT_EQ(d.warnings, Strings{});
  EXPECT_EQ(d.messages.size(), 1U);
}

TEST(DbcBadLines, AnOpenQuoteSwallowsNothing) {
  for (const char* open : {"CM_ BO_ 1 \"of A;", "CM_ \"no end", "VAL_ 1 R 0 \"off 1 \"on\" ;"}) {
    const Database d =
        parse("BO_ 1 A: 8 X\n" + sg("R", 0) + open + "\nBO_ 2 B: 8 X\n" + sg("Q", 1) + "CM_ \"last\";\n");
    EXPECT_EQ(why_not(d, "B.Q"), "usable") << open;
    ASSERT_GE(d.warnings.size(), 1U) << open;
    EXPECT_EQ(d.warnings[0].substr(0, 8), "f.dbc:3:") << open;
  }
  const Database unit = parse("BO_ 1 A: 8 X\n SG_ R : 0|8@1+ (1,0) [0|0] \"deg/s X\n" + sg("Q", 1));
  EXPECT_EQ(why_not(unit, "A.R"), "f.dbc:2: a string without its closing quote");
  EXPECT_EQ(why_not(unit, "A.Q"), "usable");
}

TEST(DbcBadLines, SeveralSignalsOnALine) {
  const Database d =
      parse("BO_ 1 A: 8 X SG_ R : 0|8@1+ (1,0) [0|0] \"\" X SG_ Q : 8|8@1+ (1,0) [0|0] \"\" X, Y\n");
  EXPECT_EQ(d.warnings, Strings{});
  EXPECT_EQ(why_not(d, "A.R"), "usable");
  EXPECT_EQ(why_not(d, "A.Q"), "usable");
  EXPECT_EQ(find_signals(d, "Q")[0].signal->start_bit, 8U);
  // The first of them broken.
  const Database b =
      parse("BO_ 1 A: 8 X SG_ R : 0|x@1+ (1,0) [0|0] \"\" X SG_ Q : 8|8@1+ (1,0) [0|0] \"\" X\n");
  EXPECT_EQ(
      b.warnings,
      Strings{"f.dbc:1: 'x@1+ (1,0) [0|0] \"\" X SG… (53 bytes)', expected the length of a signal, 1 to "
              "64 bits"});
  EXPECT_EQ(why_not(b, "A.R"), b.warnings[0]);
  EXPECT_EQ(why_not(b, "A.Q"), "usable");
}

TEST(DbcBadLines, WhatOthersReadIsRead) {
  const Database d = parse(
      "// written by hand\nVERSION \"\"\nBS_:\nBU_:\n A\n B // node\n  C\n"
      "BO_ 1 A: 8 X // the box\n SG_ R : 0|8@1+ (1,0) [0|0] \"//\"\n   X,\n   Y // both\n"
      " SG_ S M : 8|8@1+ (1,0) [0|0] \"\"\n X\n SG_ T m : 16|8@1+ (1,0) [0|0] \"\" X\n"
      " SG_ H : 32|32@1- (1,0) [0|0] \"\" X\n"
      "BO_ 1073741824 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\n" +
      sg("O", 0) + "SG_MUL_VAL_ 1 T S 3-4;\nSIG_VALTYPE_ 1 H : 1;\nCM_ BO_ 1 \"last\"");
  EXPECT_EQ(d.warnings, Strings{});
  for (const char* name : {"A.R", "A.S", "A.T", "A.H"}) EXPECT_EQ(why_not(d, name), "usable") << name;
  EXPECT_EQ(find_signals(d, "R")[0].signal->unit, "//");
  const SignalInMessage t = find_signals(d, "T")[0];
  const std::array<std::uint8_t, 3> yes{0, 4, 9}, no{0, 5, 9};
  EXPECT_TRUE(selected(*t.message, *t.signal, yes));
  EXPECT_FALSE(selected(*t.message, *t.signal, no));
  EXPECT_EQ(find_signals(d, "H")[0].signal->type, ValueType::kFloat);
  const Database orphans =
      parse("BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 X\nBO_ 1 A: 8 X\n" + sg("R", 0));
  EXPECT_EQ(orphans.warnings, Strings{});
  const Database bare =
      parse("BO_ 1 A: 8 X\n SG_ S M : 8|8@1+ (1,0) [0|0] \"\" X\n SG_ T m : 16|8@1+ (1,0) [0|0] \"\" X\n");
  EXPECT_EQ(why_not(bare, "A.S"), "usable");
  EXPECT_EQ(why_not(bare, "A.T"),
            "f.dbc:3: signal T is multiplexed, but neither a number behind its m nor SG_MUL_VAL_ "
            "says by which value");
}

TEST(DbcBadLines, OneBadLineCostsOnlyWhatStandsOnIt) {
  const std::string good = "BO_ 2 B: 8 X\n" + sg("Q", 1) + "CM_ \"end\";\n";
  for (const auto& [bad, expected] :
       {std::pair{" SG_ R : 0|32@2+ (1,0) [0|0] \"\" X\n", "one of 01"},
        std::pair{" SG_ R : 0|8@1+ (1,) [0|0] \"\" X\n", "an offset"},
        std::pair{" SG_ R  0|8@1+ (1,0) [0|0] \"\" X\n", "M, m and a number, or ':'"},
        std::pair{" SG_ R q1 : 0|8@1+ (1,0) [0|0] \"\" X\n", "both"},
        std::pair{" SG_ R : 0|8@1+ (1,0) [0|0] X\n", "the unit in quotes"}}) {
    const Database d = parse("BO_ 1 A: 8 X\n" + std::string(bad) + sg("P", 2) + good);
    ASSERT_EQ(d.warnings.size(), 1U) << bad;
    EXPECT_EQ(d.warnings[0].substr(0, 8), "f.dbc:2:");
    EXPECT_TRUE(d.warnings[0].ends_with(expected)) << d.warnings[0];
    EXPECT_EQ(why_not(d, "A.R"), d.warnings[0]);
    EXPECT_EQ(why_not(d, "A.P"), "usable") << bad;
    EXPECT_EQ(why_not(d, "B.Q"), "usable") << bad;
  }
}

// The signals behind a damaged BO_ must not become the message's before.
TEST(DbcBadLines, ABadMessageLineTakesItsSignalsAlong) {
  for (const char* bad :
       {"BO_ 2 B 8 X\n", "BO_ x B: 8 X\n", "B0_ 2 B: 8 X\n", "BO_2 B: 8 X\n", "?? 2 B: 8\n",
        "BO_ 99999999999999 B: 8 X\n", "2 B: 8 X\n", "BO_ 4096 B: 8 X\n", "BO_\n", "BO_ 2 B: 99999 X\n"}) {
    const Database d =
        parse("BO_ 1 A: 8 X\n" + sg("R", 0) + bad + sg("Q", 1) + "BO_ 3 C: 8 X\n" + sg("P", 2));
    EXPECT_EQ(why_not(d, "A.R"), "usable") << bad;
    EXPECT_EQ(why_not(d, "C.P"), "usable") << bad;
    EXPECT_EQ(find_signals(d, "A.Q").size(), 0U) << bad;
    ASSERT_GE(d.warnings.size(), 1U) << bad;
    EXPECT_EQ(why_not(d, "Q"), d.warnings[0]) << bad;
    EXPECT_TRUE(d.warnings[0].starts_with("f.dbc:3:") || d.warnings[0].starts_with("f.dbc:4:"))
        << d.warnings[0];
  }
}

TEST(DbcBadLines, WhatIsSaidTwiceIsRefusedBothTimes) {
  const Database id =
      parse("BO_ 1 A: 8 X\n" + sg("R", 0) + "BO_ 1 B: 8 X\n" + sg("Q", 0) + "BO_ 3 C: 8 X\n" + sg("P", 0));
  EXPECT_EQ(id.warnings, Strings{"f.dbc:3: message B has the id of A on line 1"});
  EXPECT_EQ(why_not(id, "A.R"), id.warnings[0]);
  EXPECT_EQ(why_not(id, "B.Q"), id.warnings[0]);
  EXPECT_EQ(why_not(id, "C.P"), "usable");
  const Database name = parse("BO_ 1 A: 8 X\n" + sg("R", 0) + sg("R", 1) + sg("Q", 2));
  EXPECT_EQ(why_not(name, "A.R"), "f.dbc:3: signal R stands twice in message A, first on line 2");
  EXPECT_EQ(why_not(name, "A.Q"), "usable");
}

TEST(DbcBadLines, ADoubtfulTypeOrMultiplexorRefusesItsSignals) {
  const std::string mux =
      "BO_ 1 A: 8 X\n SG_ S M : 0|8@1+ (1,0) [0|0] \"\" X\n SG_ R m1 : 8|32@1- (1,0) [0|0] \"\" X\n";
  EXPECT_EQ(why_not(parse(mux), "A.R"), "usable");
  EXPECT_EQ(why_not(parse(mux + "SIG_VALTYPE_ 1 R : 7;\n"), "A.R"),
            "f.dbc:4: '7;', expected 0 (integer), 1 (float) or 2 (double)");
  EXPECT_EQ(why_not(parse(mux + "SG_MUL_VAL_ 1 R S 1-;\n"), "A.R"),
            "f.dbc:4: ';', expected a multiplexor value");
  EXPECT_EQ(why_not(parse(mux + "SG_MUL_VAL_ 1 R Z 1-1;\n"), "A.R"),
            "f.dbc:4: 'Z' is no multiplexor of message A");
  const std::string broken =
      "BO_ 1 A: 8 X\n SG_ S M : 0|8@7+ (1,0) [0|0] \"\" X\n SG_ R m1 : 8|32@1- (1,0) [0|0] \"\" X\n";
  EXPECT_EQ(why_not(parse(broken), "A.R"),
            "f.dbc:3: signal A.R depends on multiplexor S, and f.dbc:2: '7+ (1,0) [0|0] "
            "\"\" X', expected one of 01");
  // Without its ';' at the end, and in front of another, it counts.
  const Database open = parse(mux + "SIG_VALTYPE_ 1 R : 1\nSIG_VALTYPE_ 1 R : 1");
  EXPECT_EQ(find_signals(open, "R")[0].signal->type, ValueType::kFloat);
  EXPECT_EQ(open.warnings, Strings{"f.dbc:4: a statement without its closing ';'"});
}

TEST(DbcBadLines, LongNamesByAttribute) {
  const Database d = parse(
      "BO_ 1 Box_0001: 8 X\n" + sg("Yaw_0001", 0) + sg("Q", 1) +
      "BA_DEF_ SG_ \"SystemSignalLongSymbol\" STRING ;\n"
      "BA_ \"SystemSignalLongSymbol\" SG_ 1 Yaw_0001 \"Yaw_Rate_Of_The_Vehicle_About_Its_Vertical_Axis\";\n"
      "BA_ \"SystemMessageLongSymbol\" BO_ 1 \"Box_With_A_Name_Of_More_Than_32_Letters\";\n");
  EXPECT_EQ(d.warnings, Strings{});
  for (const char* name :
       {"Yaw_0001", "Box_0001.Yaw_0001", "Yaw_Rate_Of_The_Vehicle_About_Its_Vertical_Axis",
        "Box_With_A_Name_Of_More_Than_32_Letters.Yaw_Rate_Of_The_Vehicle_About_Its_Vertical_Axis",
        "Box_With_A_Name_Of_More_Than_32_Letters.Q"})
    EXPECT_EQ(why_not(d, name), "usable") << name;
}

TEST(DbcBadLines, AFileWithoutAnyMessageIsRefused) {
  EXPECT_THROW(parse(std::string(5000, '\x01')), std::runtime_error);
  std::string many = "BO_ 1 A: 8 X\n" + sg("R", 0);
  for (std::size_t i = 0; i <= kMostBadLines; ++i) many += "?\n";
  EXPECT_EQ(ifog::test::refusal([&] { parse(many); }),
            "f.dbc:1003: '?', expected a section of a DBC file (BO_, SG_, CM_, …); more than "
            "1000 such lines, this is no DBC file");
  // Control characters are shown, not sent to the terminal; a line of 5 MB is named, not printed.
  const Database d =
      parse("BO_ 1 A: 8 X\n" + sg("R", 0) + "\x1b[2Jgone" + std::string(5'000'000, 'x') + "\n");
  ASSERT_EQ(d.warnings.size(), 1U);
  EXPECT_EQ(d.warnings[0],
            "f.dbc:3: '\\x1b[2Jgonexxxxxxxxxxxxx… (5000008 bytes)', expected a section of a DBC file (BO_, "
            "SG_, CM_, …)");
}

}  // namespace
