// SPDX-License-Identifier: Apache-2.0
// The daemon as it runs, its flight recorder on, a sensor at the other end of a FIFO and a subscriber.
#pragma once

#include "filters/model_file/kept_noise.h"
#include "tests/unit/daemon/running_daemon.h"
#include "tests/unit/test.h"

namespace ifog {

class RecordedFlight : public RunningDaemon {
 protected:
  void SetUp() override {
    RunningDaemon::SetUp();
    if (!IsSkipped()) line_ = fifo("line");
  }
  bool await(std::size_t messages) {
    return RunningDaemon::await([&] { return published().size() >= messages; });
  }
  void listen(int milliseconds) { listener_->listen(milliseconds); }
  std::vector<rate_t>& published() { return listener_->rates; }
  void send(int count) {
    const std::vector<std::uint8_t> bytes = kvh_frames(
        static_cast<int>(samples_), count,
        [](int n, int i) { return 0.01 * (i + 1) + 1e-4 * std::sin(0.3 * n * (i + 1)); },
        [](int n) { return 20.0 + n / 100; });
    samples_ += static_cast<std::uint32_t>(count);
    sent_.append(bytes.begin(), bytes.end());
    ASSERT_EQ(::write(line_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  // In portions that the buffers of LCM's sockets hold.
  bool send_and_await(int count) {
    const std::size_t before = published().size();
    for (int n = 50; n <= count; n += 50) {
      send(50);
      if (!await(before + static_cast<std::size_t>(n))) return false;
    }
    return true;
  }
  // The command line; what it said to standard error is in `complaint_`.
  int ifog(const std::string& arguments) {
    const int status = std::system(
        (IFOG_BINARY_DIR "/tools/ifog/ifog " + arguments + " >/dev/null 2>" + path("complaint")).c_str());
    complaint_ = content("complaint");
    return status;
  }
  // What `ifog denoise` says of the samples that were published before the channel from elsewhere had a
  // value; "" where there were none.
  std::string stale_in_words(const std::string& recording) {
    const auto stale = std::count_if(published().begin(), published().end(), [](const rate_t& message) {
      return (message.flags & rate_t::FLAG_STALE_CHANNEL) != 0;
    });
    if (stale == 0) return "";
    return path(recording) + ": " + std::to_string(stale) +
           " samples without a value of a channel that the model wants, or with one too old: corrected with "
           "the last one, or not at all\n";
  }
  // Two columns of every axis; NaN where a cell is empty.
  std::vector<std::vector<double>> rows_of(const std::string& name) const {
    std::istringstream in(content(name));
    std::vector<std::vector<double>> out;
    std::string line, cell;
    for (bool header = true; std::getline(in, line); header = false) {
      if (header || line.starts_with('#')) continue;
      std::istringstream cells(line);
      out.emplace_back();
      while (std::getline(cells, cell, ',')) out.back().push_back(cell.empty() ? NAN : std::stod(cell));
    }
    return out;
  }
  // The denoised rows of every sample are what was published, column by column: raw, compensated, denoised, variance.
  void expect_as_published(const std::string& name) {
    const auto rows = rows_of(name);
    ASSERT_EQ(rows.size(), published().size());
    for (std::size_t n = 0; n < rows.size(); ++n)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(rows[n][1 + 4 * axis], published()[n].raw[axis]) << n;
        ASSERT_EQ(rows[n][2 + 4 * axis], published()[n].compensated[axis]) << n;
        ASSERT_EQ(rows[n][3 + 4 * axis], published()[n].denoised[axis]) << n;
        ASSERT_EQ(rows[n][4 + 4 * axis], published()[n].variance[axis]) << n;
      }
  }
  void configure() {
    write("supply", "11500\n");
    write("model.toml",
          "version = 1\nsensor = \"made\"\n"
          "[[effect]]\nform = \"linear\"\nchannel = \"supply_V\"\naxis = \"y\"\nreference = 12.0\n"
          "[[effect.parameter]]\nname = \"coefficient\"\nvalue = 1e-3\nstd_error = 1e-6\n"
          "unit = \"rad/s/V\"\n");
    write("ifogd.toml",
          "[daemon]\nlock_memory = false\nstate_folder = \"state\"\n[[sensor]]\nname = \"nose\"\ndriver = "
          "\"kvh1750\"\n"
          "nominal_rate_hz = " +
              rate_hz_ + "\n" + model_line_ + "[sensor.options]\nformat = \"a\"\n[sensor.transport]\n" +
              transport_lines_ + filter_lines_ + realtime_lines_ +
              "[sensor.record]\nfolder = \"record\"\nfile_bytes = 100_000\nbytes = 1_000_000\n"
              "[[sensor.channel]]\nname = \"supply_V\"\nsource = \"file\"\npath = \"supply\"\nscale = 1e-3\n"
              "period_s = 0.01\nmax_age_s = 0.5\n");
  }

  int line_ = -1;
  std::string model_line_ = "model = \"model.toml\"\n";
  std::string rate_hz_ = "1000";
  std::string filter_lines_ = "[sensor.filter]\nprocess_noise = 1e-10\nmeasurement_noise = 1e-8\n";
  std::string transport_lines_ = "type = \"file\"\npath = \"line\"\n";
  std::string realtime_lines_;
  std::uint32_t samples_ = 0;
  std::string sent_, complaint_;
};

}  // namespace ifog
