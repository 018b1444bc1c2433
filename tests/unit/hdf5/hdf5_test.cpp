// SPDX-License-Identifier: Apache-2.0
// That what is written comes back to the bit, in chunks of any size, and that no reader is left behind. What
// others write and read, and damaged files, are tried by system/command_line/hdf5.py.
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include "drivers/capture/hdf5/hdf5_id.h"
#include "drivers/capture/hdf5/hdf5_text.h"
#include "drivers/capture/hdf5/hdf5_writer.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog;

// As time and as rate.
void put(const std::string& path, const std::vector<double>& values, const std::string& comments) {
  Hdf5Writer writer(path, comments, {"time_s", "rate_radps"});
  writer.rows(std::vector<std::span<const double>>{values, values});
  writer.finish();
}

Table read(const std::string& path) {
  InputFile input(path);
  return table_of([&](RowSink& sink) { return read_hdf5_rows(input, "", {}, sink); });
}

class Hdf5Folder : public testing::Test, protected test::OwnFolder {};

TEST_F(Hdf5Folder, ManyLongCommentsAreKept) {
  std::string comments;
  for (int i = 0; i < 6000; ++i) comments += std::to_string(i) + std::string(100, 'x') + "\n";
  put(path("c.h5"), {0.0, 1.0}, comments);
  EXPECT_EQ(read(path("c.h5")).comments, comments);
}

struct LeftAtOnce final : RowSink {
  void begin(const std::vector<std::string>&) override {}
  void take(RowBlock&) override { throw 1; }
};

// Left half-way by whoever reads it: its process goes with it.
TEST_F(Hdf5Folder, ALeftReaderIsGone) {
  std::vector<double> time;
  for (int i = 0; i < 400'000; ++i) time.push_back(i * 1e-3);
  put(path("c.h5"), time, "");
  for (int i = 0; i < 5; ++i) {
    InputFile input(path("c.h5"));
    LeftAtOnce sink;
    EXPECT_THROW((void)read_hdf5_rows(input, "", {}, sink), int);
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
    const Table got = read(path("c.h5"));
    EXPECT_TRUE(got.time_s == columns[0]) << chunk;
    ASSERT_EQ(got.columns.size(), 3U);  // again, count, rate, as they are sorted
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_TRUE(got.columns[c].values == columns[c < 2 ? 2 : 1]) << chunk << " " << c;
  }
}

// What all columns keep of unpacked chunks is bounded: beyond it the message says how to repack the file.
TEST_F(Hdf5Folder, SaysWhatMakesSmallerChunks) {
  write_chunks(path("c.h5"), {{}, {}, {}}, 25U << 20U, 25U << 20U);  // 200 MiB a column
  EXPECT_TRUE(ifog::test::has(ifog::test::refusal([&] { read(path("c.h5")); }), "h5repack -l CHUNK=65536"));
}

}  // namespace
