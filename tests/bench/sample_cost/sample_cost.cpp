// SPDX-License-Identifier: Apache-2.0
// Time per sample, part by part: calls the daemon's parts in one thread as the reader does, with a clock in
// between. In the same round it times a bare read of the same FIFO and a bare lcm_publish of a message of the
// same size. Start it with tests/bench/sample_cost/run in its own network namespace.
//
// Each sample is available when it is read, so sleeping and waking are not included (see
// tests/bench/latency). With --pause there is time between samples, as with a sensor, and other processes use
// the caches.
#include <fcntl.h>
#include <lcm/lcm.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "daemon/pipeline/increment_queue.h"
#include "daemon/publish/publisher.h"
#include "daemon/publish/rate_encoder.h"
#include "daemon/sensor/facts.h"
#include "drivers/host/driver_instance.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/file/file.h"
#include "filters/chain/incrementer.h"
#include "filters/chain/signal_chain.h"

namespace {

using namespace ifog;

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";
constexpr double kRate_hz = 1000.0;
constexpr std::size_t kFrame = 36;

// `effects`: additional time of a chain with a model; samples pass through both chains in turn.
enum Part : std::size_t { kRead, kDecode, kIncrement, kRing, kEffects, kEstimate, kEncode, kSend, kParts };
constexpr std::array<const char*, kParts> kNames{"read",    "decode",   "increment", "ring",
                                                 "effects", "estimate", "encode",    "send"};
// As timed: the chain is one part.
enum Timed : std::size_t { kTimedChain = 4, kTimed = 7 };
enum Bare : std::size_t { kBareRead, kBareSend, kBares };

std::vector<std::uint8_t> frames(std::size_t count) {
  DriverInstance driver = make_driver("kvh1750", {{"format", "a"}});
  std::vector<std::uint8_t> out;
  for (std::size_t n = 0; n < count; ++n) {
    ifog_sample sample{};
    sample.flags = IFOG_SAMPLE_SEQUENCE;
    sample.sequence = static_cast<std::uint32_t>(n % 128);
    sample.valid_axes = 7;
    for (std::size_t a = 0; a < 3; ++a)
      sample.value[a] = 0.01 + 1e-5 * static_cast<double>((n * 7919 + a * 3571) % 101);
    for (double& value : sample.environment) value = 25.0 + 0.01 * static_cast<double>(n % 97);
    sample.environment_fresh = ~0U;
    driver.encode_bytes(sample, out);
  }
  return out;
}

// Common effects on each axis: bias by temperature, its curvature, the Shupe effect, g-sensitivity.
std::shared_ptr<const Model> model(const ifog_description& description) {
  auto made = std::make_shared<Model>();
  const auto add = [&](const char* form, const std::string& channel, const char* axis, double value,
                       double reference, std::vector<ModelParameter> more) {
    Effect effect;
    effect.form = form;
    effect.channel = channel;
    effect.axis = axis;
    effect.reference = reference;
    effect.parameters = std::move(more);
    effect.parameters.insert(effect.parameters.begin(), {"coefficient", value, 0.0, ""});
    made->effects.push_back(std::move(effect));
  };
  std::string temperature, acceleration;
  for (std::uint32_t i = 0; i < description.environments; ++i) {
    const std::string name = description.environment[i];
    if (name.ends_with("_degC")) temperature = name;
    if (name == "accel_x_mps2") acceleration = name;
  }
  for (const char* const axis : {"x", "y", "z"}) {
    add("linear", temperature, axis, 1e-7, 25.0, {});
    add("quadratic", temperature, axis, 1e-9, 25.0, {});
    add("rate", temperature, axis, 1e-5, 0.0, {{"bandwidth_s", 10.0, 0.0, "s"}});
    add("linear", acceleration, axis, 1e-8, 0.0, {});
  }
  return made;
}

ChainSettings chain_settings(const DriverInstance& driver, std::shared_ptr<const Model> model) {
  ChainSettings settings;
  settings.facts = sensor_facts(driver.description(), kRate_hz, 0);
  settings.axes = {"x", "y", "z"};
  settings.filter.process_noise = 1e-10;
  settings.filter.measurement_noise = 1e-8;
  for (std::uint32_t i = 0; i < driver.description().environments; ++i) {
    settings.channels.emplace_back(driver.description().environment[i]);
    settings.channel_max_age_s.push_back(10.0);
  }
  settings.model = std::move(model);
  return settings;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Time of reading the clock.
double clock_cost_ns() {
  std::vector<double> taken(2001);
  for (double& each : taken) {
    const std::int64_t from = monotonic_ns();
    each = static_cast<double>(monotonic_ns() - from);
  }
  return median(std::move(taken));
}

// The parts of one sensor with a FIFO that it fills itself, and a bare reader and sender.
class Sensor {
 public:
  Sensor(const std::string& path, const std::vector<std::uint8_t>& bytes)
      : bytes_(bytes), plain_(chain_settings(driver_, nullptr)), encoder_(plain_.facts.axes) {
    FileSettings file;
    file.path = path;
    transport_ = make_file_transport(file);
    transport_->open({});
    writer_ = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    bare_fd_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (writer_ < 0 || bare_fd_ < 0) throw std::runtime_error(path + ": cannot open");
    encoder_.use(whole_.parts());
  }
  ~Sensor() {
    close(bare_fd_);
    close(writer_);
    lcm_destroy(lcm_);
  }
  Sensor(const Sensor&) = delete;
  Sensor& operator=(const Sensor&) = delete;

  // Sample n through the daemon's parts, with or without a model; ns of each part.
  std::array<double, kTimed> take(std::size_t n, bool with_model) {
    put(n);
    std::array<std::int64_t, kTimed + 2> at{};
    SignalChain& chain = with_model ? whole_ : estimating_;
    at[0] = monotonic_ns();
    const Delivery delivery = transport_->read(std::chrono::seconds(1));
    at[1] = monotonic_ns();
    ifog_sample sample{};
    driver_.decode_bytes(delivery.bytes, delivery.arrival_ns, [&](const ifog_sample& one) { sample = one; });
    at[2] = monotonic_ns();
    Increment& increment = queue_.next();
    at[3] = monotonic_ns();
    read_sample(sample, plain_.facts.frame_channels, reading_);
    if (!incrementer_.next(reading_, increment)) throw std::runtime_error("a sample came twice");
    at[4] = monotonic_ns();
    queue_.push();
    queue_.flush();
    const Increment* const taken = queue_.front();
    at[5] = monotonic_ns();
    chain.process(*taken, out_);
    at[6] = monotonic_ns();
    message_ = encoder_.encode(*taken, out_, chain.parts());
    at[7] = monotonic_ns();
    publisher_->publish("IFOG_BENCH", message_);
    at[8] = monotonic_ns();
    queue_.pop();
    const auto between = [&](std::size_t i) { return static_cast<double>(at[i + 1] - at[i]) - clock_ns_; };
    return {between(0), between(1), between(3), between(2) + between(4), between(5), between(6), between(7)};
  }

  // The same sample with a bare read, and the same message with a bare send.
  std::array<double, kBares> take_bare(std::size_t n) {
    std::array<std::uint8_t, kFrame> bytes{};
    put(n);
    const std::int64_t from = monotonic_ns();
    if (::read(bare_fd_, bytes.data(), kFrame) != static_cast<ssize_t>(kFrame)) std::abort();
    const std::int64_t between = monotonic_ns();
    lcm_publish(lcm_, "IFOG_BARE", message_.data(), static_cast<unsigned>(message_.size()));
    const std::int64_t to = monotonic_ns();
    return {static_cast<double>(between - from) - clock_ns_, static_cast<double>(to - between) - clock_ns_};
  }

 private:
  void put(std::size_t n) const {
    if (write(writer_, bytes_.data() + n * kFrame, kFrame) != static_cast<ssize_t>(kFrame)) std::abort();
  }

  const std::vector<std::uint8_t>& bytes_;
  DriverInstance driver_ = make_driver("kvh1750", {{"format", "a"}});
  ChainSettings plain_;
  std::unique_ptr<Transport> transport_;
  int writer_ = -1, bare_fd_ = -1;
  Incrementer incrementer_{plain_.facts};
  IncrementQueue queue_{1024, IncrementQueue::WhenFull::merge};
  SignalChain estimating_{std::make_unique<ChainParts>(plain_)};
  SignalChain whole_{std::make_unique<ChainParts>(chain_settings(driver_, model(driver_.description())))};
  RateEncoder encoder_;
  std::unique_ptr<Publisher> publisher_ = make_lcm_publisher(kUrl);
  lcm_t* const lcm_ = lcm_create(kUrl);
  Reading reading_;
  ChainOutput out_;
  std::span<const std::uint8_t> message_;
  const double clock_ns_ = clock_cost_ns();
};

// Median time of each part over the samples of a round.
template <std::size_t n>
struct Taken {
  std::array<std::vector<double>, n> of;
  void add(const std::array<double, n>& each) {
    for (std::size_t i = 0; i < n; ++i) of[i].push_back(each[i]);
  }
  std::array<double, n> medians() {
    std::array<double, n> out{};
    for (std::size_t i = 0; i < n; ++i) out[i] = median(std::move(of[i]));
    return out;
  }
};

void run_round(const std::string& path, const std::vector<std::uint8_t>& bytes,
               std::chrono::nanoseconds pause, std::array<double, kParts>& parts,
               std::array<double, kBares>& bare) {
  Sensor sensor(path, bytes);
  Taken<kTimed> with_model, without;
  Taken<kBares> bare_taken;
  for (std::size_t n = 0; n < bytes.size() / kFrame; ++n) {
    if (pause.count() > 0) std::this_thread::sleep_for(pause);
    (n % 2 == 0 ? with_model : without).add(sensor.take(n, n % 2 == 0));
    if (pause.count() > 0) std::this_thread::sleep_for(pause);
    bare_taken.add(sensor.take_bare(n));
  }
  const auto whole = with_model.medians(), estimating = without.medians();
  std::copy_n(whole.begin(), kTimedChain, parts.begin());
  parts[kEstimate] = estimating[kTimedChain];
  parts[kEffects] = whole[kTimedChain] - estimating[kTimedChain];
  parts[kEncode] = whole[kTimedChain + 1];
  parts[kSend] = whole[kTimedChain + 2];
  bare = bare_taken.medians();
}

// Median, least and greatest over rounds.
struct Figure {
  double middle, least, greatest;
};
Figure figure(const std::vector<double>& rounds) {
  const auto [least, greatest] = std::minmax_element(rounds.begin(), rounds.end());
  return {median(rounds), *least, *greatest};
}

nlohmann::ordered_json as_json(const Figure& f) {
  const auto tenth = [](double ns) { return std::round(ns) / 1000.0; };
  return {{"us", tenth(f.middle)}, {"least_us", tenth(f.least)}, {"greatest_us", tenth(f.greatest)}};
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t samples = 5000, rounds = 9;
  double pause_us = 0.0;
  std::string output;
  CLI::App app{"what a sample costs, part by part; JSON"};
  app.add_option("--samples", samples, "a round");
  app.add_option("--rounds", rounds);
  app.add_option("--pause", pause_us, "us between two samples");
  app.add_option("--json", output)->required();
  CLI11_PARSE(app, argc, argv);
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("ifog-cost-" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  std::array<std::vector<double>, kParts> parts;
  std::array<std::vector<double>, kBares> bare;
  std::vector<double> sums, bare_sums;
  const std::chrono::nanoseconds pause(static_cast<std::int64_t>(pause_us * 1e3));
  const std::string path = folder / "fifo";
  if (mkfifo(path.c_str(), 0600) != 0) return 1;
  const std::vector<std::uint8_t> bytes = frames(samples);
  for (std::size_t round = 0; round < rounds; ++round) {
    std::array<double, kParts> part{};
    std::array<double, kBares> bared{};
    run_round(path, bytes, pause, part, bared);
    double sum = 0.0;
    for (std::size_t i = 0; i < kParts; ++i) {
      parts[i].push_back(part[i]);
      sum += part[i];
    }
    for (std::size_t i = 0; i < kBares; ++i) bare[i].push_back(bared[i]);
    sums.push_back(sum);
    bare_sums.push_back(bared[kBareRead] + bared[kBareSend]);
  }
  std::filesystem::remove_all(folder);
  nlohmann::ordered_json out;
  out["samples"] = samples;
  out["rounds"] = rounds;
  out["pause_us"] = pause_us;
  for (std::size_t i = 0; i < kParts; ++i) out["parts"][kNames[i]] = as_json(figure(parts[i]));
  out["sum"] = as_json(figure(sums));
  out["bare"] = {{"read", as_json(figure(bare[kBareRead]))},
                 {"send", as_json(figure(bare[kBareSend]))},
                 {"sum", as_json(figure(bare_sums))}};
  std::ofstream file(output);
  file << out.dump(2) << '\n';
  return file.flush() ? 0 : 1;
}
