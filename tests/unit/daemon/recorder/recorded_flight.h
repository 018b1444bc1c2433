// SPDX-License-Identifier: Apache-2.0
// The daemon as it runs, its flight recorder on, a sensor at the other end of a FIFO and a subscriber.
#pragma once

#include <ifog/decode.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "drivers/host/driver_instance.h"
#include "filters/model_file/kept_noise.h"
#include "tests/unit/daemon/daemon_process.h"

namespace ifog {

class RecordedFlight : public DaemonProcess {
 protected:
  void SetUp() override {
    DaemonProcess::SetUp();
    if (IsSkipped()) return;
    ASSERT_EQ(mkfifo(path("line").c_str(), 0600), 0);
    line_ = open(path("line").c_str(), O_RDWR | O_CLOEXEC);
    lcm_ = lcm_create(kUrl);
    lcm_subscription_t* const rates = lcm_subscribe(
        lcm_, "IFOG_NOSE",
        [](const lcm_recv_buf_t* buffer, const char*, void* user) {
          auto* const self = static_cast<RecordedFlight*>(user);
          ASSERT_TRUE(decode_message(buffer->data, buffer->data_size, self->published_.emplace_back()));
        },
        this);
    lcm_subscription_set_queue_capacity(rates, 100'000);
  }
  void TearDown() override {
    DaemonProcess::TearDown();
    if (lcm_ != nullptr) lcm_destroy(lcm_);
    if (line_ >= 0) close(line_);
  }
  // Generous: only a test that fails waits so long.
  bool await(std::size_t messages) {
    for (int n = 0; n < 600 && published_.size() < messages; ++n) listen(50);
    return published_.size() >= messages;
  }
  void listen(int milliseconds) {
    pollfd wanted{lcm_get_fileno(lcm_), POLLIN, 0};
    while (poll(&wanted, 1, milliseconds) > 0 && lcm_handle(lcm_) == 0) milliseconds = 0;
  }
  void send(int count) {
    std::vector<std::uint8_t> bytes;
    for (int n = 0; n < count; ++n, ++samples_) {
      ifog_sample sample{};
      sample.flags = IFOG_SAMPLE_SEQUENCE;
      sample.sequence = samples_ % 128;
      sample.valid_axes = 7;
      for (int i = 0; i < 3; ++i)
        sample.value[i] = 0.01 * (i + 1) + 1e-4 * std::sin(0.3 * samples_ * (i + 1));
      for (double& value : sample.environment) value = 20.0 + samples_ / 100;
      sample.environment_fresh = ~0U;
      encoder_.encode_bytes(sample, bytes);
    }
    sent_.append(bytes.begin(), bytes.end());
    ASSERT_EQ(::write(line_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  // In portions that the buffers of LCM's sockets hold.
  bool send_and_await(int count) {
    const std::size_t before = published_.size();
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
  std::string stale_in_words(const std::string& recording) const {
    const auto stale = std::count_if(published_.begin(), published_.end(), [](const rate_t& message) {
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

  lcm_t* lcm_ = nullptr;
  int line_ = -1;
  std::string model_line_ = "model = \"model.toml\"\n";
  std::string rate_hz_ = "1000";
  std::string filter_lines_ = "[sensor.filter]\nprocess_noise = 1e-10\nmeasurement_noise = 1e-8\n";
  std::string transport_lines_ = "type = \"file\"\npath = \"line\"\n";
  std::string realtime_lines_;
  std::vector<rate_t> published_;
  std::uint32_t samples_ = 0;
  std::string sent_, complaint_;
  DriverInstance encoder_ = make_driver("kvh1750", {{"format", "a"}});
};

}  // namespace ifog
