// SPDX-License-Identifier: Apache-2.0
// Time from a frame's last byte to the end of its LCM send, and processor time per sample. Compares the
// daemon's pipeline with a bare loop that reads the same FIFO and calls lcm_publish with a message of the
// same size. Interleaved rounds in one process. Start it with tests/bench/latency/run in
// its own network namespace.
#include <fcntl.h>
#include <lcm/lcm.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "daemon/pipeline/pipeline.h"
#include "drivers/host/driver_instance.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/file/file.h"
#include "tests/unit/daemon/chain_behind.h"
#include "tests/unit/daemon/kvh_frames.h"

namespace {

using namespace ifog;

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

std::int64_t cpu_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

// Times when each frame was written and when its send ended; frame n is message n, because a FIFO loses
// nothing.
struct Stamps {
  explicit Stamps(std::size_t n) : written(n), sent(n) {}
  std::vector<std::atomic<std::int64_t>> written, sent;
};

class StampingPublisher final : public Publisher {
 public:
  explicit StampingPublisher(Stamps& stamps) : lcm_(make_lcm_publisher(kUrl)), stamps_(stamps) {}
  bool publish(const char* channel, std::span<const std::uint8_t> message) noexcept override {
    const bool sent = lcm_->publish(channel, message);
    if (count_ < stamps_.sent.size()) stamps_.sent[count_].store(monotonic_ns(), std::memory_order_relaxed);
    ++count_;
    return sent;
  }

 private:
  std::unique_ptr<Publisher> lcm_;
  Stamps& stamps_;
  std::size_t count_ = 0;
};

struct Plan {
  double rate_hz = 1000.0, seconds = 3.0;
  int sensors = 1, rounds = 5;
  bool spin = false, two_threads = false;
  std::string place = "any";

  // Processors of the source and its reader; empty: chosen by the scheduler.
  [[nodiscard]] std::vector<int> source_cpus() const {
    return place == "any" ? std::vector<int>{} : std::vector<int>{0};
  }
  [[nodiscard]] std::vector<int> reader_cpus() const {
    return place == "any" ? std::vector<int>{} : std::vector<int>{place == "same" ? 0 : 1};
  }
};

// Writes one frame per period at absolute deadlines to each sensor's FIFO in turn.
void write_frames(const Plan& plan, const std::vector<int>& fifos, const std::vector<std::uint8_t>& bytes,
                  std::vector<std::unique_ptr<Stamps>>& stamps, std::int64_t& used_ns) {
  apply_to_this_thread({"source", 0, plan.source_cpus()});
  const std::int64_t from_ns = cpu_ns(CLOCK_THREAD_CPUTIME_ID);
  const std::int64_t start_ns = monotonic_ns() + 20'000'000;
  const std::size_t count = bytes.size() / kFrame;
  for (std::size_t n = 0; n < count; ++n) {
    const std::int64_t due_ns =
        start_ns + static_cast<std::int64_t>(static_cast<double>(n) / plan.rate_hz * 1e9);
    const timespec due{due_ns / 1'000'000'000, due_ns % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
    for (std::size_t s = 0; s < fifos.size(); ++s) {
      stamps[s]->written[n].store(monotonic_ns(), std::memory_order_relaxed);
      if (write(fifos[s], bytes.data() + n * kFrame, kFrame) != static_cast<ssize_t>(kFrame)) std::abort();
    }
  }
  used_ns = cpu_ns(CLOCK_THREAD_CPUTIME_ID) - from_ns;
}

std::size_t message_size() {
  RateEncoder encoder(3);
  const ChainParts parts(chain_behind(make_driver("kvh1750", {}), 1000.0));
  return encoder.encode(Increment{}, ChainOutput{}, parts).size();
}

void bare_loop(const Plan& plan, const std::string& fifo, Stamps& stamps, std::size_t size) {
  apply_to_this_thread({"bare", 0, plan.reader_cpus()});
  lcm_t* const lcm = lcm_create(kUrl);
  const int fd = open(fifo.c_str(), O_RDONLY);
  std::vector<std::uint8_t> message(size);
  for (std::size_t n = 0; n < stamps.sent.size(); ++n) {
    for (std::size_t have = 0; have < kFrame;) {
      const ssize_t got = read(fd, message.data() + have, kFrame - have);
      if (got <= 0) std::abort();
      have += static_cast<std::size_t>(got);
    }
    lcm_publish(lcm, "IFOG_BARE", message.data(), static_cast<unsigned>(message.size()));
    stamps.sent[n].store(monotonic_ns(), std::memory_order_relaxed);
  }
  close(fd);
  lcm_destroy(lcm);
}

struct Result {
  std::vector<double> latency_us;
  double cpu_us = 0.0;  // per sample, without the writer
  std::size_t lost = 0;
};

double percentile(const std::vector<double>& sorted, double p) {
  return sorted.empty() ? 0.0
                        : sorted[std::min(sorted.size() - 1,
                                          static_cast<std::size_t>(p * static_cast<double>(sorted.size())))];
}

std::unique_ptr<Pipeline> make_pipeline(const std::string& fifo, const Plan& plan, Stamps& stamps) {
  DriverInstance driver = make_driver("kvh1750", {});
  PipelinePlan pipeline;
  pipeline.lcm_channel = "IFOG_BENCH";
  const ChainSettings chain = chain_behind(driver, plan.rate_hz);
  pipeline.facts = chain.facts;
  pipeline.reader = {"read", 0, plan.reader_cpus()};
  pipeline.filter = {"filter", 0, plan.reader_cpus()};
  pipeline.spin = plan.spin;
  pipeline.direct = !plan.two_threads;
  FileSettings file;
  file.path = fifo;
  return std::make_unique<Pipeline>(pipeline, make_file_transport(file), std::move(driver), nullptr,
                                    std::make_unique<ChainParts>(chain),
                                    std::make_unique<StampingPublisher>(stamps));
}

void run_round(bool bare, const Plan& plan, const std::vector<std::string>& paths,
               const std::vector<std::uint8_t>& bytes, std::size_t size, Result& result) {
  const std::size_t count = bytes.size() / kFrame;
  std::vector<std::unique_ptr<Stamps>> stamps;
  std::vector<std::unique_ptr<Pipeline>> pipelines;
  std::vector<std::thread> loops;
  std::vector<int> fifos;
  for (const std::string& path : paths) {
    stamps.push_back(std::make_unique<Stamps>(count));
    if (!bare) {
      pipelines.push_back(make_pipeline(path, plan, *stamps.back()));
      pipelines.back()->open();
      pipelines.back()->start();
    } else {
      loops.emplace_back(bare_loop, std::cref(plan), path, std::ref(*stamps.back()), size);
    }
    fifos.push_back(open(path.c_str(), O_WRONLY));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const std::int64_t from_ns = cpu_ns(CLOCK_PROCESS_CPUTIME_ID);
  std::int64_t writer_ns = 0;
  std::thread writer(write_frames, std::cref(plan), std::cref(fifos), std::cref(bytes), std::ref(stamps),
                     std::ref(writer_ns));
  writer.join();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  result.cpu_us += 1e-3 * static_cast<double>(cpu_ns(CLOCK_PROCESS_CPUTIME_ID) - from_ns - writer_ns) /
                   static_cast<double>(count * paths.size()) / plan.rounds;
  for (auto& pipeline : pipelines) pipeline->stop();
  for (std::thread& loop : loops) loop.join();
  for (const int fd : fifos) close(fd);
  for (const auto& one : stamps)
    for (std::size_t n = count / 10; n < count; ++n) {  // the first tenth warms the caches
      const std::int64_t sent_ns = one->sent[n].load();
      if (sent_ns == 0)
        ++result.lost;
      else
        result.latency_us.push_back(1e-3 * static_cast<double>(sent_ns - one->written[n].load()));
    }
}

void print(const char* name, const std::vector<double>& l, double cpu_us, std::size_t lost) {
  std::printf("%-10s %8.1f %8.1f %8.1f %9.1f %12.2f %6zu\n", name, percentile(l, 0.5), percentile(l, 0.99),
              percentile(l, 0.999), l.empty() ? 0.0 : l.back(), cpu_us, lost);
}

void report(const Plan& plan, std::size_t size, const Result& bare, const Result& daemon) {
  std::printf(
      "%d sensor(s) at %g Hz, %d interleaved rounds of %g s, processors %s%s, messages of %zu "
      "bytes\n",
      plan.sensors, plan.rate_hz, plan.rounds, plan.seconds, plan.place.c_str(),
      plan.spin          ? ", spinning"
      : plan.two_threads ? ", two threads"
                         : "",
      size);
  std::printf("%-10s %8s %8s %8s %9s %12s %6s\n", "us", "p50", "p99", "p99.9", "max", "CPU/sample", "lost");
  print("bare loop", bare.latency_us, bare.cpu_us, bare.lost);
  print("daemon", daemon.latency_us, daemon.cpu_us, daemon.lost);
  std::printf("%-10s %8.2f %8.2f %8.2f %9s %12.2f\n", "ratio",
              percentile(daemon.latency_us, 0.5) / percentile(bare.latency_us, 0.5),
              percentile(daemon.latency_us, 0.99) / percentile(bare.latency_us, 0.99),
              percentile(daemon.latency_us, 0.999) / percentile(bare.latency_us, 0.999), "",
              daemon.cpu_us / bare.cpu_us);
}

}  // namespace

int main(int argc, char** argv) {
  Plan plan;
  CLI::App app{"latency and load of the daemon's pipeline beside a bare read-and-publish loop"};
  app.add_option("--rate", plan.rate_hz, "frames a second and sensor");
  app.add_option("--sensors", plan.sensors);
  app.add_option("--seconds", plan.seconds, "a round");
  app.add_option("--rounds", plan.rounds);
  app.add_option(
         "--place", plan.place,
         "processors of the source and of its reader: any, the same one, or two (an interrupt on one, "
         "the reader on another)")
      ->check(CLI::IsMember({"any", "same", "other"}));
  auto* const spin = app.add_flag("--spin", plan.spin, "filter threads never sleep");
  app.add_flag("--two-threads", plan.two_threads, "every step by the filter thread")->excludes(spin);
  CLI11_PARSE(app, argc, argv);
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("ifog-bench-" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  std::vector<std::string> paths;
  for (int s = 0; s < plan.sensors; ++s) {
    paths.push_back(folder / ("fifo" + std::to_string(s)));
    if (mkfifo(paths.back().c_str(), 0600) != 0) return 1;
  }
  const std::vector<std::uint8_t> bytes =
      kvh_frames(0, static_cast<int>(plan.rate_hz * plan.seconds),
                 [](int n) { return 0.01 + 1e-5 * static_cast<double>(n * 7919L % 101); });
  const std::size_t size = message_size();
  Result bare, daemon;
  for (int round = 0; round < plan.rounds; ++round) {
    run_round(true, plan, paths, bytes, size, bare);
    run_round(false, plan, paths, bytes, size, daemon);
  }
  for (Result* const result : {&bare, &daemon})
    std::sort(result->latency_us.begin(), result->latency_us.end());
  report(plan, size, bare, daemon);
  std::filesystem::remove_all(folder);
  return 0;
}
