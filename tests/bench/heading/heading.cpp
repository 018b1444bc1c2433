// SPDX-License-Identifier: Apache-2.0
// Heading over a simulated day: three gyros at 5 kHz through the daemon's pipelines (driver, ring, filter,
// LCM encoding), with reloads and overload. Compares the encoded messages with the input, which is known
// exactly: every rate is a multiple of 2^-20 rad/s, and the sum is an integer.
//
//   heading_bench [--hours H] [--sensors N]     exit 1 if an angle is off by more than 1e-9 rad
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ifog/rate_t.hpp>
#include <memory>
#include <numbers>
#include <thread>
#include <vector>

#include "daemon/pipeline/pipeline.h"
#include "drivers/host/driver_instance.h"
#include "tests/unit/daemon/chain_behind.h"
#include "tests/unit/daemon/kvh_frames.h"

namespace {

using namespace ifog;
using namespace std::chrono_literals;

constexpr double kRate_hz = 5000.0;
constexpr double kUnit_radps = 1.0 / (1 << 20);  // float32 holds its multiples up to 16 rad/s exactly
constexpr std::size_t kPortion = 64;             // frames per delivery
constexpr std::size_t kSlots = 1024;
constexpr int kBlock = 128 * 512;                // frames, repeated: 13 s
constexpr std::uint64_t kCalm = 100'000;         // frames between two overloads: 20 s
constexpr std::uint64_t kOverload = 4 * kSlots;  // frames sent faster than the filter
constexpr double kAllowed_rad = 1e-9;
constexpr double kAllowedDenoised_deg = 1e-3;  // of the denoised rate at rest

// Rate of one axis in units of kUnit_radps: Earth's rate at rest, a turn of 90° with a sharp start and a slow
// end and one back, noise of some 1e-4 rad/s.
int units(int n, int axis) {
  const double t = n / kRate_hz;
  const auto turn = [](double s) { return s < 0.0 ? 0.0 : s < 0.5 ? 1.0 : std::exp(-(s - 0.5) / 0.4); };
  const double motion =
      axis == 2 ? 1.7 * (turn(t - 2.0) - turn(t - 7.0)) : 0.1 * std::sin(0.7 * t * (axis + 1));
  const auto noise =
      static_cast<double>((static_cast<std::uint32_t>(n) * 2654435761U + 977U * static_cast<unsigned>(axis)) %
                          401U) -
      200.0;
  return static_cast<int>(std::lround((7.3e-5 + motion) / kUnit_radps + noise));
}

struct Block {
  std::vector<std::uint8_t> bytes;
  std::array<std::vector<std::int64_t>, 3> sums;  // of the first n frames
};

Block make_block() {
  Block block;
  for (auto& sums : block.sums) sums.push_back(0);
  block.bytes = kvh_frames(0, kBlock, [&](int n, int axis) {
    auto& sums = block.sums[static_cast<std::size_t>(axis)];
    const int value = units(n, axis);
    sums.push_back(sums.back() + value);
    return value * kUnit_radps;
  });
  return block;
}

// Sends the block repeatedly as fast as the filter follows, and sometimes faster.
class DayTransport final : public Transport {
 public:
  DayTransport(const Block& block, std::uint64_t frames) : Transport("day"), block_(block), frames_(frames) {}
  bool connect(std::string&, std::int64_t) override { return true; }
  Delivery receive(std::int64_t) noexcept override {
    if (given_ >= frames_) {
      end(0);
      return {};
    }
    const bool overload = given_ % (kCalm + kOverload) >= kCalm;
    if (!overload && given_ - taken_->load() > 3 * kSlots / 4) {
      // An empty delivery, so that the reader tries to store what it has merged.
      std::this_thread::sleep_for(200us);
      return {};
    }
    const std::uint64_t at = given_ % kBlock;
    const std::uint64_t n = std::min({std::uint64_t{kPortion}, kBlock - at, frames_ - given_});
    Delivery out;
    out.bytes = std::span(block_.bytes).subspan(at * kFrame, n * kFrame);
    // No arrival times: only the counter shows that nothing is missing, at any speed.
    given_ += n;
    return out;
  }
  // taken: samples that the filter has published.
  void follow(const std::atomic<std::uint64_t>& taken) { taken_ = &taken; }

 private:
  const Block& block_;
  std::uint64_t frames_, given_ = 0;
  const std::atomic<std::uint64_t>* taken_ = nullptr;
};

// Decodes the messages as a subscriber would.
class SummingPublisher final : public Publisher {
 public:
  bool publish(const char*, std::span<const std::uint8_t> message) noexcept override {
    if (last.decode(message.data(), 0, static_cast<int>(message.size())) < 0) return false;
    ++messages;
    samples += last.merged;
    taken += static_cast<std::uint64_t>(last.merged);
    gaps += (last.flags & rate_t::FLAG_GAP) != 0 ? 1 : 0;
    resets += (last.flags & rate_t::FLAG_FILTER_RESET) != 0 ? 1 : 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sum[axis].add(last.delta_theta[axis]);
      residual_rad[axis] += (last.denoised[axis] - last.compensated[axis]) * last.covered[axis];
    }
    return true;
  }
  rate_t last{};
  std::int64_t messages = 0, samples = 0, gaps = 0, resets = 0, not_finite = 0;
  std::atomic<std::uint64_t> taken{0};
  std::array<ExactSum, 3> sum;
  std::array<double, 3> residual_rad{};
};

struct Sensor {
  Sensor(const Block& block, std::uint64_t frames) {
    DriverInstance driver = make_driver("kvh1750", {});
    PipelinePlan plan;
    plan.lcm_channel = "IFOG_DAY";
    chain = chain_behind(driver, kRate_hz, 1e-8, 1e-8);
    plan.facts = chain.facts;
    plan.ring_slots = kSlots;
    plan.reader.name = "read";
    plan.filter.name = "filter";
    auto day = std::make_unique<DayTransport>(block, frames);
    auto summing = std::make_unique<SummingPublisher>();
    DayTransport* const transport = day.get();
    publisher = summing.get();
    pipeline = std::make_unique<Pipeline>(plan, std::move(day), std::move(driver), nullptr,
                                          std::make_unique<ChainParts>(chain), std::move(summing));
    transport->follow(publisher->taken);
    pipeline->open();
  }
  ChainSettings chain;
  SummingPublisher* publisher;
  std::unique_ptr<Pipeline> pipeline;
};

// Makes a new filter for every sensor, as SIGHUP does.
void reload(std::vector<std::unique_ptr<Sensor>>& sensors, int number) {
  for (auto& sensor : sensors) {
    sensor->chain.filter.measurement_noise = number % 2 == 0 ? 1e-8 : 2e-8;
    sensor->pipeline->filter().collect_retired();
    sensor->pipeline->filter().offer(std::make_unique<ChainParts>(sensor->chain));
  }
}

}  // namespace

int main(int argc, char** argv) {
  double hours = 24.0;
  int count = 3;
  CLI::App app{
      "published angle against sent angle over accelerated hours of 5 kHz, with reloads and overload"};
  app.add_option("--hours", hours, "of each sensor")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--sensors", count)->check(CLI::Range(1, 16))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const Block block = make_block();
  const auto frames = static_cast<std::uint64_t>(hours * 3600.0 * kRate_hz);
  std::vector<std::unique_ptr<Sensor>> sensors;
  for (int i = 0; i < count; ++i) sensors.push_back(std::make_unique<Sensor>(block, frames));
  const auto begin = std::chrono::steady_clock::now();
  for (auto& sensor : sensors) sensor->pipeline->start();
  int reloads = 0;
  const auto ended = [&] {
    return std::all_of(sensors.begin(), sensors.end(), [](const auto& s) { return s->pipeline->ended(); });
  };
  while (!ended()) {
    reload(sensors, ++reloads);
    std::this_thread::sleep_for(200ms);
  }
  for (auto& sensor : sensors) sensor->pipeline->stop();
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  std::printf("%d sensors, %g h at %g Hz in %.0f s (%.0f times as fast), %d reloads\n", count, hours,
              kRate_hz, took_s, hours * 3600.0 / took_s, reloads);
  std::printf("%-7s %12s %12s %10s %10s %8s %5s %14s %14s %18s\n", "sensor", "sent", "published", "merged",
              "overflows", "resets", "gaps", "angle off, rad", "sum off, rad", "denoised off, deg");
  bool good = true;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const SummingPublisher& got = *sensors[i]->publisher;
    double angle = 0.0, sum = 0.0, residual = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t sent_units = static_cast<std::int64_t>(frames / kBlock) * block.sums[axis].back() +
                                      block.sums[axis][frames % kBlock];
      const double sent = static_cast<double>(sent_units) * kUnit_radps / kRate_hz;
      angle = std::max(angle, std::abs(got.last.angle[axis] - sent));
      sum = std::max(sum, std::abs(got.sum[axis].value() - sent));
      residual = std::max(residual, std::abs(got.residual_rad[axis]) * 180.0 / std::numbers::pi);
    }
    const IncrementQueue& queue = sensors[i]->pipeline->queue();
    std::printf("%-7zu %12llu %12lld %10llu %10llu %8lld %5lld %14.1e %14.1e %18.1e\n", i,
                static_cast<unsigned long long>(frames), static_cast<long long>(got.messages),
                static_cast<unsigned long long>(queue.merged()),
                static_cast<unsigned long long>(queue.overflows()), static_cast<long long>(got.resets),
                static_cast<long long>(got.gaps), angle, sum, residual);
    good = good && got.samples == static_cast<std::int64_t>(frames) && got.gaps == 0 && got.not_finite == 0 &&
           angle <= kAllowed_rad && sum <= kAllowed_rad && residual <= kAllowedDenoised_deg;
  }
  std::printf("target: every sample published, angle within %g rad, denoised within %g deg: %s\n",
              kAllowed_rad, kAllowedDenoised_deg, good ? "met" : "MISSED");
  return good ? 0 : 1;
}
