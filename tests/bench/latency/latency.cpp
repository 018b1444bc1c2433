// SPDX-License-Identifier: Apache-2.0
// Time from a frame's last byte to the end of its LCM send, and processor time per sample. Compares the
// daemon's pipeline with a bare loop that reads the same FIFO and calls lcm_publish with a message of the
// same size. With --record there are two more runs, with the flight recorder and without it, whose difference
// is the noise of this machine. Interleaved rounds in one process. Start it with tests/bench/latency/run in
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
#include "daemon/recorder/recorder.h"
#include "drivers/host/driver_instance.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/file/file.h"
#include "tests/bench/latency/thread_costs.h"

namespace {

using namespace ifog;

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";
constexpr std::size_t kFrame = 36;

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
  bool spin = false, two_threads = false, record = false;
  std::string folder;  // of FIFOs and recordings
  std::string place = "any";
  std::string rule = "irwe-akfg";

  // Processors of the source and its reader; empty: chosen by the scheduler.
  [[nodiscard]] std::vector<int> source_cpus() const {
    return place == "any" ? std::vector<int>{} : std::vector<int>{0};
  }
  [[nodiscard]] std::vector<int> reader_cpus() const {
    return place == "any" ? std::vector<int>{} : std::vector<int>{place == "same" ? 0 : 1};
  }
};

std::vector<std::uint8_t> frames(std::size_t count) {
  DriverInstance driver = make_driver("kvh1750", {{"format", "a"}});
  std::vector<std::uint8_t> out;
  for (std::size_t n = 0; n < count; ++n) {
    ifog_sample sample{};
    sample.flags = IFOG_SAMPLE_SEQUENCE;
    sample.sequence = static_cast<std::uint32_t>(n % 128);
    sample.valid_axes = 7;
    for (double& value : sample.value) value = 0.01 + 1e-5 * static_cast<double>(n * 7919 % 101);
    sample.environment_fresh = ~0U;
    driver.encode_bytes(sample, out);
  }
  return out;
}

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
  ChainSettings chain;
  chain.facts.axes = 3;
  chain.facts.nominal_rate_hz = 1000.0;
  chain.axes = {"x", "y", "z"};
  chain.filter.process_noise = 1e-10;
  chain.filter.measurement_noise = 1e-8;
  const ChainParts parts(chain);
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

enum class Kind { bare, daemon, recording, again };

struct Result {
  std::vector<double> latency_us;
  std::vector<double> p50_us, p99_us;  // of each round
  double cpu_us = 0.0;                 // per sample, without the writer
  std::size_t lost = 0;
  std::uint64_t unrecorded = 0;  // deliveries
  ThreadCosts readers, recorders;
};

double percentile(const std::vector<double>& sorted, double p) {
  return sorted.empty() ? 0.0
                        : sorted[std::min(sorted.size() - 1,
                                          static_cast<std::size_t>(p * static_cast<double>(sorted.size())))];
}

std::unique_ptr<Recorder> make_recorder(const Plan& plan, std::size_t sensor) {
  FlightHeader header;
  header.driver = "kvh1750";
  ArchiveLimits limits;
  auto recorder = std::make_unique<Recorder>(
      "recorder", 4U << 20U, make_flight_folder(plan.folder + "/" + std::to_string(sensor)), limits, header);
  recorder->start();
  return recorder;
}

std::unique_ptr<Pipeline> make_pipeline(const std::string& fifo, const Plan& plan, Stamps& stamps,
                                        Tape* tape) {
  DriverInstance driver = make_driver("kvh1750", {});
  PipelinePlan pipeline;
  pipeline.lcm_channel = "IFOG_BENCH";
  pipeline.facts = sensor_facts(driver.description(), plan.rate_hz, 0);
  pipeline.reader = {"read", 0, plan.reader_cpus()};
  pipeline.filter = {"filter", 0, plan.reader_cpus()};
  pipeline.spin = plan.spin;
  pipeline.tape = tape;
  pipeline.direct = !plan.two_threads;
  ChainSettings chain;
  chain.facts = pipeline.facts;
  chain.axes = {"x", "y", "z"};
  chain.filter.rule = plan.rule;
  chain.filter.process_noise = 1e-10;
  chain.filter.measurement_noise = 1e-8;
  for (std::uint32_t i = 0; i < driver.description().environments; ++i)
    chain.channels.emplace_back(driver.description().environment[i]);
  FileSettings file;
  file.path = fifo;
  return std::make_unique<Pipeline>(pipeline, make_file_transport(file), std::move(driver), nullptr,
                                    std::make_unique<ChainParts>(chain),
                                    std::make_unique<StampingPublisher>(stamps));
}

void run_round(Kind kind, const Plan& plan, const std::vector<std::string>& paths,
               const std::vector<std::uint8_t>& bytes, std::size_t size, Result& result) {
  const std::size_t count = bytes.size() / kFrame;
  std::vector<std::unique_ptr<Stamps>> stamps;
  std::vector<std::unique_ptr<Recorder>> recorders;
  std::vector<std::unique_ptr<Pipeline>> pipelines;
  std::vector<std::thread> loops;
  std::vector<int> fifos;
  for (const std::string& path : paths) {
    stamps.push_back(std::make_unique<Stamps>(count));
    if (kind != Kind::bare) {
      if (kind == Kind::recording) recorders.push_back(make_recorder(plan, recorders.size()));
      pipelines.push_back(make_pipeline(path, plan, *stamps.back(),
                                        kind == Kind::recording ? &recorders.back()->tape() : nullptr));
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
  const ThreadCosts readers = costs_of_threads("read"), recording = costs_of_threads("recorder");
  std::thread writer(write_frames, std::cref(plan), std::cref(fifos), std::cref(bytes), std::ref(stamps),
                     std::ref(writer_ns));
  writer.join();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  result.cpu_us += 1e-3 * static_cast<double>(cpu_ns(CLOCK_PROCESS_CPUTIME_ID) - from_ns - writer_ns) /
                   static_cast<double>(count * paths.size()) / plan.rounds;
  result.readers += costs_of_threads("read") - readers;
  result.recorders += costs_of_threads("recorder") - recording;
  for (auto& pipeline : pipelines) pipeline->stop();
  for (auto& recorder : recorders) {
    recorder->stop();
    result.unrecorded += recorder->tape().counters().lost_deliveries.value();
    if (recorder->tape().counters().bytes.value() != bytes.size()) std::abort();
  }
  for (std::thread& loop : loops) loop.join();
  for (const int fd : fifos) close(fd);
  std::vector<double> latency_us;
  for (const auto& one : stamps)
    for (std::size_t n = count / 10; n < count; ++n) {  // the first tenth warms the caches
      const std::int64_t sent_ns = one->sent[n].load();
      if (sent_ns == 0)
        ++result.lost;
      else
        latency_us.push_back(1e-3 * static_cast<double>(sent_ns - one->written[n].load()));
    }
  std::sort(latency_us.begin(), latency_us.end());
  result.p50_us.push_back(percentile(latency_us, 0.5));
  result.p99_us.push_back(percentile(latency_us, 0.99));
  result.latency_us.insert(result.latency_us.end(), latency_us.begin(), latency_us.end());
}

void print(const char* name, const std::vector<double>& l, double cpu_us, std::size_t lost) {
  std::printf("%-10s %8.1f %8.1f %8.1f %9.1f %12.2f %6zu\n", name, percentile(l, 0.5), percentile(l, 0.99),
              percentile(l, 0.999), l.empty() ? 0.0 : l.back(), cpu_us, lost);
}

// Each round relative to the reference of the same round: median and quartiles.
void print_rounds(const char* what, const std::vector<double>& of, const std::vector<double>& by) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < of.size(); ++i) ratios.push_back(of[i] / by[i]);
  std::sort(ratios.begin(), ratios.end());
  std::printf("  %s %.3f (%.3f … %.3f)", what, percentile(ratios, 0.5), percentile(ratios, 0.25),
              percentile(ratios, 0.75));
}

void print_costs(const char* name, const Plan& plan, const Result& result) {
  const double seconds = plan.seconds * plan.rounds;
  const auto each = [&](std::uint64_t count) { return static_cast<double>(count) / seconds; };
  std::printf(
      "%-10s a second: readers' page faults %.1f, preempted %.1f; recorders slept %.1f, preempted %.1f\n",
      name, each(result.readers.faults), each(result.readers.preempted), each(result.recorders.slept),
      each(result.recorders.preempted));
}

void report_recording(const Plan& plan, const Result& daemon, const Result& recording, const Result& again) {
  print("recording", recording.latency_us, recording.cpu_us, recording.lost);
  std::printf("%-10s %8.2f %8.2f %8.2f %9s %12.2f   of the daemon without it; %llu deliveries not recorded\n",
              "ratio", percentile(recording.latency_us, 0.5) / percentile(daemon.latency_us, 0.5),
              percentile(recording.latency_us, 0.99) / percentile(daemon.latency_us, 0.99),
              percentile(recording.latency_us, 0.999) / percentile(daemon.latency_us, 0.999), "",
              recording.cpu_us / daemon.cpu_us, static_cast<unsigned long long>(recording.unrecorded));
  std::printf("each round, of the daemon without it:");
  print_rounds("p50", recording.p50_us, daemon.p50_us);
  print_rounds("p99", recording.p99_us, daemon.p99_us);
  std::printf("\nand of the daemon once more:         ");
  print_rounds("p50", again.p50_us, daemon.p50_us);
  print_rounds("p99", again.p99_us, daemon.p99_us);
  std::printf("\n");
  print_costs("daemon", plan, daemon);
  print_costs("recording", plan, recording);
}

void report(const Plan& plan, std::size_t size, const Result& bare, const Result& daemon) {
  std::printf(
      "%d sensor(s) at %g Hz, %d interleaved rounds of %g s, processors %s, filter %s%s, messages of %zu "
      "bytes\n",
      plan.sensors, plan.rate_hz, plan.rounds, plan.seconds, plan.place.c_str(), plan.rule.c_str(),
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
  app.add_option("--filter", plan.rule);
  app.add_option(
         "--place", plan.place,
         "processors of the source and of its reader: any, the same one, or two (an interrupt on one, "
         "the reader on another)")
      ->check(CLI::IsMember({"any", "same", "other"}));
  auto* const spin = app.add_flag("--spin", plan.spin, "filter threads never sleep");
  app.add_flag("--record", plan.record, "beside both, with the flight recorder on");
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
  const std::vector<std::uint8_t> bytes = frames(static_cast<std::size_t>(plan.rate_hz * plan.seconds));
  const std::size_t size = message_size();
  Result bare, daemon, recording, again;
  plan.folder = folder;
  std::vector<std::pair<Kind, Result*>> ways{{Kind::daemon, &daemon}};
  if (plan.record) ways.insert(ways.end(), {{Kind::recording, &recording}, {Kind::again, &again}});
  for (int round = 0; round < plan.rounds; ++round) {
    run_round(Kind::bare, plan, paths, bytes, size, bare);
    for (const auto& [kind, result] : ways) run_round(kind, plan, paths, bytes, size, *result);
    // In every order, because each run affects the next one.
    std::next_permutation(ways.begin(), ways.end());
  }
  for (Result* const result : {&bare, &daemon, &recording})
    std::sort(result->latency_us.begin(), result->latency_us.end());
  report(plan, size, bare, daemon);
  if (plan.record) report_recording(plan, daemon, recording, again);
  std::filesystem::remove_all(folder);
  return 0;
}
