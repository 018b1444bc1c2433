// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/daemon/faults/random_faults.h"

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <thread>

#include "daemon/channels/channel_sources.h"
#include "daemon/housekeeping/log.h"
#include "daemon/housekeeping/status_report.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/sensor/sensor_parts.h"
#include "tests/unit/daemon/faults/parts.h"
#include "tests/unit/daemon/faults/wall_clock.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

class Findings {
 public:
  template <typename A, typename B>
  void equal(const char* what, A found, B expected) {
    if (static_cast<std::int64_t>(found) != static_cast<std::int64_t>(expected))
      add(std::string(what) + " " + std::to_string(found) + ", expected " + std::to_string(expected));
  }
  void holds(bool good, const std::string& what) {
    if (!good) add(what);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void add(const std::string& line) { text_ += (text_.empty() ? "" : "\n") + line; }
  std::string text_;
};

// Standard error, and with it the log, on a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(bool full) {
    if (!full) return;
    kept_ = dup(STDERR_FILENO);
    const int disk = open("/dev/full", O_WRONLY | O_CLOEXEC);
    dup2(disk, STDERR_FILENO);
    close(disk);
  }
  ~FullDisk() {
    if (kept_ < 0) return;
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  [[nodiscard]] bool full() const { return kept_ >= 0; }

 private:
  int kept_ = -1;
};

// What is drawn for a run, in the order of drawing.
struct Draw {
  explicit Draw(unsigned seed) : random(seed) {}
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); }
  bool coin() { return below(2) != 0; }

  std::mt19937 random;
  bool can = coin();
  Wire wire{random, can, 100 + below(900)};
  bool flooded = below(3) == 0, disk_full = coin(), clock_set = coin();
  bool holds_back = coin(), slow_network = coin();
};

std::vector<std::size_t> draw_cuts(Draw& draw) {
  std::vector<std::size_t> cuts;
  for (int n = draw.below(4); n > 0; --n)
    cuts.push_back(static_cast<std::size_t>(draw.below(static_cast<int>(draw.wire.size()))));
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  return cuts;
}

// A pipeline with one channel of another bus in addition to those of its frames.
class Run {
 public:
  Run(unsigned seed, Draw& draw)
      : draw_(draw), cuts_(draw_cuts(draw)), outside_(std::make_shared<ChannelTable>(1)) {
    DriverInstance driver = Wire::driver(draw.can);
    PipelinePlan plan;
    plan.lcm_channel = "test";
    SensorConfig sensor;
    sensor.nominal_rate_hz = 1000.0;
    sensor.channels = {coil()};
    sensor.filter.process_noise = 1e-10;
    sensor.filter.measurement_noise = 1e-8;
    chain_ = sensor_chain_settings(sensor, driver.description(), nullptr);
    plan.facts = chain_.facts;
    plan.ring_slots = draw.coin() ? 2 : 64;
    plan.direct = draw.coin();
    plan.reader.name = plan.filter.name = "test";
    auto transport = std::make_unique<FaultyTransport>(draw.wire, cuts_, seed + 1, draw.holds_back);
    auto publisher = std::make_unique<FaultyPublisher>(seed + 2, draw.slow_network);
    line_ = transport.get();
    network_ = publisher.get();
    pipeline_ = std::make_unique<Pipeline>(plan, std::move(transport), std::move(driver), outside_,
                                           std::make_unique<ChainParts>(chain_), std::move(publisher));
    report_ =
        std::make_unique<StatusReport>("test", chain_.channels, chain_.axes, chain_.facts.nominal_rate_hz);
    flood(seed + 3);
  }

  void go() {
    pipeline_->open();
    pipeline_->start();
    if (sources_) sources_->start();
    const int looks = draw_.below(4) == 0 ? 1 + draw_.below(5) : std::numeric_limits<int>::max();
    for (int n = 0; n < looks && !pipeline_->ended(); ++n) look();
    if (sources_) sources_->stop();
    pipeline_->stop();
    last_word();
  }
  [[nodiscard]] const std::string& findings() const { return findings_.text(); }

 private:
  static ChannelConfig coil() {
    ChannelConfig out;
    out.name = "coil_degC";
    out.source = ChannelConfig::Source::can;
    out.interface = "flooded";
    out.dbc = IFOG_SOURCE_DIR "/drivers/dbc/examples/ifogd_gyro.dbc";
    out.signal = "Temperature";
    out.limits.maximum = FloodedBus::kMost_degC;
    return out;
  }
  void flood(unsigned seed) {
    if (!draw_.flooded) return;
    sources_ = std::make_unique<ChannelSources>(
        std::vector{ChannelSources::Wanted{coil(), outside_, 0}}, "",
        [&](const CanSettings&) { return std::make_unique<FloodedBus>(seed, channel_dropped_); });
  }

  void set_clock() {
    if (!draw_.clock_set || draw_.below(8) != 0) return;
    const std::int64_t minutes = draw_.below(2'000'000) - 1'000'000;
    shifts_min_.insert(minutes);
    set_wall_clock(minutes * 60'000'000'000);
  }

  void look() {
    set_clock();
    pipeline_->filter().ask();
    if (draw_.below(4) == 0) pipeline_->filter().offer(std::make_unique<ChainParts>(chain_));
    pipeline_->filter().collect_retired();
    for (Event event; pipeline_->take_event(event);)
      if (draw_.disk_full) log_->warn("{}", describe(event));
    std::this_thread::sleep_for(500us);
    // Without an answer the reader's books continue, as housekeeping does it.
    if (!pipeline_->filter().take_snapshot(snapshot_)) snapshot_.reader = pipeline_->reader().books();
    balance(report_->update(*pipeline_, snapshot_, 1.0));
  }

  void balance(const status_t& s) {
    findings_.equal("bytes read", s.bytes_read, s.bytes_framed + s.bytes_skipped + s.bytes_pending);
    if (draw_.can)
      findings_.equal("frames read", s.frames_read, s.frames_good + s.frames_format + s.frames_other);
    findings_.equal("samples decoded", s.samples_decoded, s.samples_in + s.samples_repeated);
    findings_.equal("samples", s.samples_in,
                    s.samples_published + s.samples_merged + s.lcm_failures + s.samples_waiting);
    findings_.holds(s.samples_waiting >= 0, "less than nothing waits");
    findings_.holds(s.fault.find("balance") == std::string::npos, s.fault);
    const double coil = s.channel_value.back();
    findings_.holds(std::isnan(coil) || (coil >= FloodedBus::kLeast_degC && coil <= FloodedBus::kMost_degC),
                    "a coil of " + std::to_string(coil) + " degC");
  }

  void last_word() {
    findings_.holds(pipeline_->filter().take_snapshot(snapshot_), "the filter has no last word");
    const status_t& s = report_->update(*pipeline_, snapshot_, 1.0);
    balance(s);
    const Truth said = draw_.wire.truth(cuts_, line_->given());
    findings_.equal("bytes read", s.bytes_read, draw_.can ? 0 : line_->given());
    findings_.equal("bytes pending", s.bytes_pending, 0);
    findings_.equal("samples waiting", s.samples_waiting, 0);
    findings_.equal("samples decoded", s.samples_decoded, said.decoded);
    findings_.equal("samples repeated", s.samples_repeated, said.repeated);
    findings_.equal("invalid samples", s.invalid_samples, said.invalid);
    findings_.equal("samples published", s.samples_published, network_->taken());
    findings_.equal("kernel drops", s.kernel_drops, line_->dropped());
    findings_.equal("drops of the channel's bus", outside_->drops(), channel_dropped_.load());
    // The reader tells of them until its own end, which may have come before the bus was left.
    findings_.holds(s.channel_drops <= static_cast<std::int64_t>(outside_->drops()),
                    "more drops of the channel than there were");
    if (draw_.can) {
      findings_.equal("frames read", s.frames_read, line_->given());
      findings_.equal("frames good", s.frames_good, said.frames_good);
      findings_.equal("frames refused", s.frames_format, said.frames_refused);
      findings_.equal("frames of others", s.frames_other, said.frames_other);
    }
    findings_.holds(network_->all_readable(), "a message that cannot be read");
    findings_.holds(
        std::abs(network_->angle() - said.angle) < 1e-12,
        "angle " + std::to_string(network_->angle()) + ", expected " + std::to_string(said.angle));
    for (const std::int64_t minutes : network_->label_shifts_min())
      findings_.holds(shifts_min_.count(minutes) != 0, "times of day off by " + std::to_string(minutes) +
                                                           " min, to which nobody set the clock");
  }

  Draw& draw_;
  std::vector<std::size_t> cuts_;
  std::shared_ptr<ChannelTable> outside_;
  ChainSettings chain_;
  FaultyTransport* line_ = nullptr;
  FaultyPublisher* network_ = nullptr;
  std::unique_ptr<Pipeline> pipeline_;
  std::unique_ptr<ChannelSources> sources_;
  std::atomic<std::uint64_t> channel_dropped_{0};
  std::unique_ptr<StatusReport> report_;
  std::shared_ptr<spdlog::logger> log_ = make_log("test");
  FilterSnapshot snapshot_;
  std::set<std::int64_t> shifts_min_{0};
  Findings findings_;
};

}  // namespace

std::string random_faults(unsigned seed) {
  Draw draw(seed);
  const FullDisk disk(draw.disk_full);
  Run run(seed, draw);
  run.go();
  set_wall_clock(0);
  return run.findings();
}

Held held_by_process() {
  Held out;
  const std::filesystem::directory_iterator open_files("/proc/self/fd");
  out.descriptors = static_cast<int>(std::distance(begin(open_files), end(open_files)));
  const struct mallinfo2 info = mallinfo2();
  out.bytes = info.uordblks + info.hblkhd;
  return out;
}

}  // namespace ifog
