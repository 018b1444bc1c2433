// Random faults through a whole pipeline: damaged, doubled, lost and impossible frames, a device that is
// closed and opened within a frame, a full ring, a network that does not take messages, reloads, stops.
// Whatever happens, the books balance at every look, and the published angle is what the intact frames say.
#include "daemon/health/books.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ifog/rate_t.hpp>
#include <limits>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "daemon/housekeeping/status_report.h"
#include "daemon/pipeline/pipeline.h"
#include "drivers/host/driver_instance.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kFrame = 36;
constexpr double kPeriod_s = 1e-3;

// A frame as it stands in the stream, whole.
struct Sent {
  std::size_t begin = 0;
  std::uint32_t sequence = 0;
  bool valid = true;
  double rate = 0.0;  // as a float holds it
};

// The bytes of a device with all that may befall them, and what of it is still intact.
class Stream {
 public:
  Stream(std::mt19937& random, int count) : random_(random) {
    for (int n = 0; n < count; ++n) frame(static_cast<std::uint32_t>(n % 128));
  }
  std::vector<std::uint8_t> bytes;
  std::vector<Sent> intact;

 private:
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  double rate() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }

  void frame(std::uint32_t sequence) {
    ifog_sample sample{};
    sample.flags = IFOG_SAMPLE_SEQUENCE;
    sample.sequence = sequence;
    sample.valid_axes = 7;
    for (double& value : sample.value) value = rate();
    const int fate = below(100);
    if (fate == 0) sample.value[0] = below(2) != 0 ? 1e30 : -8.6;  // beyond full scale
    if (fate == 1) sample.valid_axes = 6;
    std::vector<std::uint8_t> made;
    driver_.encode_bytes(sample, made);
    if (fate == 2) return;  // lost on the way
    if (fate == 3)          // damaged: a checksum of 32 bits finds every single bit
      made[static_cast<std::size_t>(below(kFrame))] ^= static_cast<std::uint8_t>(1U << below(8));
    // Cut off by the whole checksum at least: the next frame may begin with the one byte that is missing.
    if (fate == 4) made.resize(static_cast<std::size_t>(below(kFrame - 4) + 1));
    if (fate == 5)
      for (int n = below(200); n >= 0; --n) bytes.push_back(static_cast<std::uint8_t>(below(256)));
    for (int copies = fate == 6 ? 2 : 1; copies > 0; --copies) {
      if (fate != 3 && fate != 4)
        intact.push_back(
            {bytes.size(), sequence, fate > 1, static_cast<double>(static_cast<float>(sample.value[0]))});
      bytes.insert(bytes.end(), made.begin(), made.end());
    }
  }

  std::mt19937& random_;
  DriverInstance driver_ = make_driver("kvh1750", {{"format", "a"}});
};

// Gives the bytes in portions of any size, and is opened anew at each of `cuts`. The times of arrival are
// made up from the bytes, so that no load of the machine is a gap.
class FaultyTransport final : public Transport {
 public:
  FaultyTransport(const std::vector<std::uint8_t>& bytes, std::vector<std::size_t> cuts, unsigned seed,
                  bool holds_back)
      : Transport("faulty"), bytes_(bytes), cuts_(std::move(cuts)), random_(seed), holds_back_(holds_back) {}
  void connect(std::string&) override {}
  Delivery receive(std::int64_t) noexcept override {
    Delivery out;
    if (at_ == bytes_.size()) {
      end(0);
      return out;
    }
    if (cut_ < cuts_.size() && at_ == cuts_[cut_]) {
      ++cut_;
      left();
      return out;
    }
    const std::size_t until = cut_ < cuts_.size() ? cuts_[cut_] : bytes_.size();
    const std::size_t n = std::min(until - at_, std::uniform_int_distribution<std::size_t>(1, 300)(random_));
    out.bytes = std::span(bytes_).subspan(at_, n);
    at_ += n;
    out.arrival_ns = 1'000'000'000'000 + static_cast<std::int64_t>(at_ * 1'000'000 / kFrame);
    given_.store(at_, std::memory_order_release);
    return out;
  }
  [[nodiscard]] bool holds_back() const override { return holds_back_; }
  [[nodiscard]] std::size_t given() const { return given_.load(std::memory_order_acquire); }

 private:
  const std::vector<std::uint8_t>& bytes_;
  std::vector<std::size_t> cuts_;
  std::mt19937 random_;
  bool holds_back_;
  std::size_t at_ = 0, cut_ = 0;
  std::atomic<std::size_t> given_{0};
};

class FaultyPublisher final : public Publisher {
 public:
  FaultyPublisher(unsigned seed, bool slow) : random_(seed), slow_(slow) {}
  bool publish(const char*, std::span<const std::uint8_t> message) noexcept override {
    const int fate = std::uniform_int_distribution<int>(0, 49)(random_);
    if (slow_ && fate < 5) std::this_thread::sleep_for(200us);
    const std::lock_guard lock(mutex_);
    EXPECT_GT(last_.decode(message.data(), 0, static_cast<int>(message.size())), 0);
    if (fate == 49) return false;
    ++taken_;
    return true;
  }
  // Of the last message, also of one that was not taken.
  double angle() {
    const std::lock_guard lock(mutex_);
    return last_.axes > 0 ? last_.angle[0] : 0.0;
  }
  std::uint64_t taken() {
    const std::lock_guard lock(mutex_);
    return taken_;
  }

 private:
  std::mt19937 random_;
  bool slow_;
  std::mutex mutex_;
  rate_t last_{};
  std::uint64_t taken_ = 0;
};

// What the intact frames among the first `given` bytes say; a frame over a cut is in two parts, and none.
struct Truth {
  std::uint64_t decoded = 0, repeated = 0, invalid = 0;
  double angle = 0.0;
};

Truth truth(const Stream& stream, const std::vector<std::size_t>& cuts, std::size_t given) {
  Truth out;
  std::int64_t last = -1;
  for (const Sent& sent : stream.intact) {
    const std::size_t end = sent.begin + kFrame;
    const bool severed =
        std::any_of(cuts.begin(), cuts.end(), [&](std::size_t cut) { return sent.begin < cut && cut < end; });
    if (end > given || severed) continue;
    ++out.decoded;
    if (sent.sequence == last) {
      ++out.repeated;
      continue;
    }
    last = sent.sequence;
    out.invalid += sent.valid ? 0 : 1;
    if (sent.valid) out.angle += sent.rate * kPeriod_s;
  }
  return out;
}

void expect_balance(const status_t& status) {
  EXPECT_EQ(status.bytes_read, status.bytes_framed + status.bytes_skipped + status.bytes_pending);
  EXPECT_EQ(status.samples_decoded, status.samples_in + status.samples_repeated);
  EXPECT_EQ(status.samples_in,
            status.samples_published + status.samples_merged + status.lcm_failures + status.samples_waiting);
  EXPECT_GE(status.samples_waiting, 0);
  EXPECT_EQ(status.fault.find("balance"), std::string::npos) << status.fault;
}

void run(unsigned seed) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto below = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  const Stream stream(random, 100 + below(900));
  std::vector<std::size_t> cuts;
  for (int n = below(4); n > 0; --n)
    cuts.push_back(static_cast<std::size_t>(below(static_cast<int>(stream.bytes.size()))));
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());

  DriverInstance driver = make_driver("kvh1750", {});
  PipelinePlan plan;
  plan.lcm_channel = "test";
  plan.facts = sensor_facts(driver.description(), 1000.0, 0);
  plan.ring_slots = below(2) != 0 ? 2 : 64;
  plan.direct = below(2) != 0;
  plan.reader.name = plan.filter.name = "test";
  ChainSettings chain;
  chain.facts = plan.facts;
  chain.axes = {"x", "y", "z"};
  chain.channels.assign(driver.description().environments, "channel_V");
  chain.channel_max_age_s.assign(driver.description().environments, 10.0);
  chain.filter.process_noise = 1e-10;
  chain.filter.measurement_noise = 1e-8;
  auto transport = std::make_unique<FaultyTransport>(stream.bytes, cuts, seed + 1, below(2) != 0);
  auto publisher = std::make_unique<FaultyPublisher>(seed + 2, below(2) != 0);
  FaultyTransport& line = *transport;
  FaultyPublisher& network = *publisher;
  Pipeline pipeline(plan, std::move(transport), std::move(driver), nullptr,
                    std::make_unique<ChainParts>(chain), std::move(publisher));
  StatusReport report("test", chain.channels, chain.axes);
  FilterSnapshot snapshot;
  pipeline.open();
  pipeline.start();
  const bool stopped_early = below(4) == 0;
  const int looks = stopped_early ? 1 + below(5) : std::numeric_limits<int>::max();
  for (int look = 0; look < looks && !pipeline.ended(); ++look) {
    pipeline.filter().ask();
    if (below(4) == 0) pipeline.filter().offer(std::make_unique<ChainParts>(chain));
    pipeline.filter().collect_retired();
    std::this_thread::sleep_for(500us);
    pipeline.filter().take_snapshot(snapshot);
    expect_balance(report.update(pipeline, snapshot, 1.0));
  }
  pipeline.stop();
  ASSERT_TRUE(pipeline.filter().take_snapshot(snapshot));
  const status_t& status = report.update(pipeline, snapshot, 1.0);
  expect_balance(status);

  const Truth said = truth(stream, cuts, line.given());
  EXPECT_EQ(status.bytes_read, static_cast<std::int64_t>(line.given()));
  EXPECT_EQ(status.bytes_pending, 0);
  EXPECT_EQ(status.samples_waiting, 0);
  EXPECT_EQ(status.samples_decoded, static_cast<std::int64_t>(said.decoded));
  EXPECT_EQ(status.samples_repeated, static_cast<std::int64_t>(said.repeated));
  EXPECT_EQ(status.invalid_samples, static_cast<std::int64_t>(said.invalid));
  EXPECT_EQ(status.samples_published, static_cast<std::int64_t>(network.taken()));
  EXPECT_NEAR(network.angle(), said.angle, 1e-12);
}

TEST(Books, BalanceWhateverHappensAndTheAngleIsThatOfTheIntactFrames) {
  for (unsigned seed = 0; seed < 200 && !HasFailure(); ++seed) run(seed);
}

TEST(Books, AnImbalanceIsSaidWithItsNumbers) {
  const ReaderBooks reader{.bytes_read = 100,
                           .bytes_framed = 72,
                           .bytes_skipped = 20,
                           .bytes_pending = 8,
                           .decoded = 3,
                           .samples = 2,
                           .repeated = 1};
  const FilterBooks filter{.samples = 2, .sent = 1, .failed = 0, .merged = 1};
  EXPECT_EQ(imbalance(reader, filter), "");
  ReaderBooks wrong = reader;
  wrong.bytes_pending = 7;
  EXPECT_EQ(imbalance(wrong, filter),
            "the books do not balance: 100 bytes read, 72 in frames + 20 skipped + 7 pending");
  wrong = reader;
  wrong.frames_read = 9;
  wrong.frames_good = 5;
  wrong.frames_refused = 1;
  wrong.frames_other = 3;
  EXPECT_EQ(imbalance(wrong, filter), "");
  wrong.frames_other = 2;
  EXPECT_EQ(imbalance(wrong, filter),
            "the books do not balance: 9 CAN frames read, 5 decoded + 1 refused + 2 none of the sensor's");
  wrong = reader;
  wrong.repeated = 0;
  EXPECT_EQ(imbalance(wrong, filter), "the books do not balance: 3 samples decoded, 2 taken + 0 repeated");
  wrong = reader;
  wrong.decoded = 2;
  wrong.samples = 1;
  EXPECT_NE(imbalance(wrong, filter), "");  // more filtered than read
  FilterBooks lost = filter;
  lost.merged = 0;
  EXPECT_EQ(imbalance(reader, lost),
            "the books do not balance: 2 samples, 2 of them filtered: 1 sent + 0 failed + 0 merged");
}

}  // namespace
}  // namespace ifog
