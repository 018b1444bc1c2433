// SPDX-License-Identifier: Apache-2.0
// What comes through the barrier between the HDF5 library and us, packed by hand; and that what is beyond it
// can do as it likes. What others write and read is tried by system/command_line/hdf5.py.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/capture/hdf5/column_stream.h"
#include "drivers/capture/hdf5/hdf5_id.h"
#include "drivers/capture/hdf5/hdf5_input.h"
#include "drivers/capture/hdf5/hdf5_rows.h"
#include "drivers/capture/hdf5/hdf5_writer.h"

namespace {

using namespace ifog;

std::string packed(std::uint64_t number) {
  std::string out(sizeof number, '\0');
  std::memcpy(out.data(), &number, sizeof number);
  return out;
}

std::string packed_texts(const std::vector<std::string>& texts) {
  std::string out = packed(texts.size());
  for (const std::string& text : texts) out += packed(text.size()) + text;
  return out;
}

std::string packed_values(const std::vector<double>& values) {
  std::string out(values.size() * sizeof(double), '\0');
  if (!values.empty()) std::memcpy(out.data(), values.data(), out.size());
  return out;
}

std::string message(char kind, const std::string& body) { return kind + packed(body.size()) + body; }

std::string header(std::uint64_t rows, const std::vector<std::string>& units = {"s", ""},
                   const std::vector<std::uint64_t>& time = {0, 0, 0}) {
  return message(1, packed_texts({"time_s", "rate_radps"}) + packed_texts(units) + packed_texts({"a gyro"}) +
                        packed_texts({}) + packed(rows) + packed(time[0]) + packed(time[1]) +
                        packed(time[2]));
}

std::string values(const std::vector<double>& of) { return message(2, packed_values(of)); }

// All that comes, by column, or the message.
struct Read {
  std::vector<std::vector<double>> columns;
  std::optional<std::int64_t> time_from;
  std::string refusal, no_stream;
};

Read read(std::string bytes) {
  Read out;
  std::size_t at = 0;
  try {
    ColumnStream stream([&](std::span<char> to) {
      if (bytes.size() - at < to.size()) return false;
      bytes.copy(to.data(), to.size(), at);
      at += to.size();
      return true;
    });
    out.columns.resize(stream.header().names.size());
    out.time_from = stream.header().time_from;
    std::vector<std::vector<double>> block;
    while (stream.next(block))
      for (std::size_t i = 0; i < block.size(); ++i)
        out.columns[i].insert(out.columns[i].end(), block[i].begin(), block[i].end());
  } catch (const std::length_error& error) {
    out.no_stream = error.what();
  } catch (const std::runtime_error& error) {
    out.refusal = error.what();
  }
  return out;
}

TEST(Hdf5Stream, TakesAHeaderAndRowsInBlocks) {
  const Read got = read(header(3) + values({0, 1}) + values({5, 6}) + values({2}) + values({7}));
  EXPECT_EQ(got.refusal + got.no_stream, "");
  EXPECT_EQ(got.columns, (std::vector<std::vector<double>>{{0, 1, 2}, {5, 6, 7}}));
}

TEST(Hdf5Stream, SaysWhatWholeTimesAreCountedFrom) {
  EXPECT_EQ(read(header(2) + values({0, 1}) + values({5, 6})).time_from, std::nullopt);
  const auto first = static_cast<std::uint64_t>(-1'700'000'000'123'456'789);
  const Read got = read(header(2, {"s", ""}, {1, first, 0}) + values({0, 1}) + values({5, 6}));
  EXPECT_EQ(got.refusal + got.no_stream, "");
  EXPECT_EQ(got.time_from, -1'700'000'000'123'456'789);
  EXPECT_NE(read(header(2, {"s", ""}, {2, 0, 0})).no_stream, "");
  EXPECT_NE(read(header(2, {"s", ""}, {0, 0, 2})).no_stream, "");
}

TEST(Hdf5Stream, ARefusalIsSaidWheneverItComesAndOnOneLine) {
  EXPECT_EQ(read(message(3, "'x' holds\ntext")).refusal, "'x' holds\\ntext");
  EXPECT_EQ(read(header(2) + values({0, 1}) + message(3, "no more")).refusal, "no more");
}

TEST(Hdf5Stream, WhatContradictsItselfIsNoStream) {
  const std::string two = values({0, 1});
  for (const std::string& bytes :
       {std::string(), std::string("nonsense of any kind"), values({1}), header(0), header(2, {"s"}),
        header(2) + two, header(2) + two + values({0}), header(2) + two + values({0, 1, 2}),
        header(1) + two + two, header(2) + message(2, "1234567"), header(2) + values({}),
        header(2) + header(2), header(2) + message(9, "")})
    EXPECT_NE(read(bytes).no_stream, "") << bytes.size();
  // Lengths that nobody has room for.
  for (const std::uint64_t much : {1ULL << 20U, 1ULL << 40U, ~0ULL}) {
    EXPECT_NE(read(message(1, packed(much))).no_stream, "");
    EXPECT_NE(read('\3' + packed(much)).no_stream, "");
    EXPECT_NE(read(header(~0ULL) + '\2' + packed(much * 8)).no_stream, "");
  }
}

// As time and as rate.
void write(const std::string& path, const std::vector<double>& values, const std::string& comments) {
  Hdf5Writer writer(path, comments, {"time_s", "rate_radps"});
  writer.rows(std::vector<std::span<const double>>{values, values});
  writer.finish();
}

class Hdf5Folder : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("ifog-hdf5-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

// More than a block, so that there are several.
TEST_F(Hdf5Folder, GivesBackWhatWasWrittenToTheBit) {
  constexpr std::size_t kRows = 150'001;
  std::vector<double> time, rate, odd;
  for (std::size_t i = 0; i < kRows; ++i) {
    time.push_back(static_cast<double>(i) / 3.0);
    rate.push_back(std::sin(static_cast<double>(i) * 0.7) * 1e-5);
    odd.push_back(i % 3 == 0 ? -0.0 : i % 3 == 1 ? 5e-324 : std::numeric_limits<double>::quiet_NaN());
  }
  const std::string file = path("c.h5");
  // In pieces that are no whole chunks.
  Hdf5Writer writer(file, "one\n\nthree\n", {"time_s", "rate_y_radps", "odd_counts"});
  for (std::size_t from = 0, count = 1; from < kRows;
       from += count, count = std::min<std::size_t>(70'000, kRows - from))
    writer.rows(std::vector<std::span<const double>>{std::span(time).subspan(from, count),
                                                     std::span(rate).subspan(from, count),
                                                     std::span(odd).subspan(from, count)});
  writer.finish();
  InputFile input(file);
  const Table table = table_of([&](RowSink& sink) { return read_hdf5_rows(input, "", {}, sink); });
  EXPECT_EQ(table.comments, "one\n\nthree\n");
  EXPECT_EQ(table.time_s, time);
  ASSERT_EQ(table.columns.size(), 2U);
  EXPECT_EQ(table.columns[0].name, "rate_y_radps");
  EXPECT_EQ(table.columns[0].values, rate);
  EXPECT_EQ(std::memcmp(table.columns[1].values.data(), odd.data(), kRows * sizeof(double)), 0);
}

TEST_F(Hdf5Folder, ManyLongCommentsAreKept) {
  std::string comments;
  for (int i = 0; i < 6000; ++i) comments += std::to_string(i) + std::string(100, 'x') + "\n";
  write(path("c.h5"), {0.0, 1.0}, comments);
  InputFile input(path("c.h5"));
  EXPECT_EQ(table_of([&](RowSink& sink) { return read_hdf5_rows(input, "", {}, sink); }).comments, comments);
}

// Left half-way by whoever reads it: its process goes with it.
TEST_F(Hdf5Folder, ALeftReaderIsGone) {
  std::vector<double> time;
  for (int i = 0; i < 400'000; ++i) time.push_back(i * 1e-3);
  write(path("c.h5"), time, "");
  for (int i = 0; i < 5; ++i) {
    InputFile input(path("c.h5"));
    Hdf5Input reader(ifog::Hdf5File(input), "", {}, "time_s");
    std::vector<std::vector<double>> block;
    EXPECT_TRUE(reader.next(block));
  }
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

// As others write columns, in chunks of so many rows; the last one under two names.
// Columns that are empty have `fill` rows of zeros, which the file does not hold.
void write_chunks(const std::string& path, const std::vector<std::vector<double>>& columns, hsize_t chunk,
                  hsize_t fill = 0) {
  const Hdf5Id file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  const Hdf5Id how(H5Pcreate(H5P_DATASET_CREATE));
  ASSERT_TRUE(H5Pset_chunk(how, 1, &chunk) >= 0 && H5Pset_shuffle(how) >= 0 && H5Pset_deflate(how, 1) >= 0);
  const std::vector<const char*> names = {"time_s", "rate_radps", "count_counts"};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const hsize_t rows = std::max<hsize_t>(columns[i].size(), fill);
    const Hdf5Id space(H5Screate_simple(1, &rows, nullptr));
    const Hdf5Id set(H5Dcreate2(file, names[i], H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, how, H5P_DEFAULT));
    ASSERT_GE(set, 0);
    if (columns[i].empty()) continue;
    ASSERT_GE(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, columns[i].data()), 0);
  }
  ASSERT_GE(H5Lcreate_hard(file, "count_counts", file, "again_counts", H5P_DEFAULT, H5P_DEFAULT), 0);
}

// In chunks larger than are kept of every column at once: one, two and a part of one, and one beyond the end.
TEST_F(Hdf5Folder, ReadsChunksOfAnySizeToTheBit) {
  constexpr std::size_t kRows = 2'500'001;
  std::vector<std::vector<double>> columns(3, std::vector<double>(kRows));
  for (std::size_t i = 0; i < kRows; ++i) {
    columns[0][i] = static_cast<double>(i) / 1024.0;
    columns[1][i] = static_cast<double>(i * 7919 % 1'000'003) * 1e-9;
    columns[2][i] = static_cast<double>(i / 1000);
  }
  for (const std::size_t chunk : {kRows, std::size_t{1'200'000}, std::size_t{1'048'577}}) {
    write_chunks(path("c.h5"), columns, chunk);
    InputFile input(path("c.h5"));
    Hdf5Input reader(ifog::Hdf5File(input), "", {}, "time_s");
    const std::vector<std::size_t> of = {2, 2, 1, 0};  // again, count, rate, time, as they are sorted
    ASSERT_EQ(reader.header().names.size(), of.size());
    std::vector<std::vector<double>> got(of.size()), block;
    while (reader.next(block))
      for (std::size_t c = 0; c < block.size(); ++c)
        got[c].insert(got[c].end(), block[c].begin(), block[c].end());
    for (std::size_t c = 0; c < got.size(); ++c) EXPECT_TRUE(got[c] == columns[of[c]]) << chunk << " " << c;
  }
}

// What all columns keep of unpacked chunks is bounded: beyond it the message says how to repack the file.
TEST_F(Hdf5Folder, SaysWhatMakesSmallerChunks) {
  write_chunks(path("c.h5"), {{}, {}, {}}, 25U << 20U, 25U << 20U);  // 200 MiB a column
  InputFile input(path("c.h5"));
  try {
    const Hdf5Input reader(ifog::Hdf5File(input), "", {}, "time_s");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("h5repack -l CHUNK=65536"), std::string::npos) << error.what();
  }
}

}  // namespace
