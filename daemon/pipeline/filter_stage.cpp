// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/filter_stage.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "drivers/transport/clock.h"

namespace ifog {
namespace {

void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__) || defined(__arm__)
  asm volatile("yield");
#endif
}

}  // namespace

FilterStage::FilterStage(std::unique_ptr<ChainParts> parts, const SensorFacts& facts, std::string channel,
                         const std::vector<PublishedType>& also, std::unique_ptr<Publisher> publisher,
                         IncrementQueue& queue, const SharedBooks& reader_books, EventQueue& events,
                         bool measure_latency)
    : facts_(facts),
      chain_(std::move(parts)),
      output_{std::move(channel), RateEncoder(facts.axes), {}, std::move(publisher)},
      queue_(queue),
      reader_books_(reader_books),
      events_(events),
      measure_latency_(measure_latency),
      noise_known_(chain_.parts().noise_known()) {
  output_.encoder.use(chain_.parts());
  for (const PublishedType& each : also)
    output_.also.push_back({each.channel, make_inertial_encoder(each.type, facts)});
}

bool FilterStage::step() noexcept {
  const Increment* const in = queue_.front();
  if (in == nullptr) return false;
  if (exchange_.exchange(answer_.now.books.samples, chain_)) adopted(in->sequence);
  process(*in);
  queue_.pop();
  return true;
}

void FilterStage::run(bool spin) noexcept {
  // A source that waits for its reader takes no time from others; a spinning thread has its own processor.
  const bool shares = !spin && !queue_.waits_when_full();
  std::int64_t slept_ns = 0;  // total
  for (;;) {
    const bool stepped = step();
    if (answer_.state.load(std::memory_order_acquire) == Ask::asked) answer();
    if (stepped) {
      if (shares) stand_back(slept_ns);
      continue;
    }
    if (queue_.finished()) {
      answer_.finished.store(true, std::memory_order_release);
      return;
    }
    if (spin) {
      relax();
      continue;
    }
    const std::int64_t from_ns = monotonic_ns();
    queue_.wait();
    slept_ns += monotonic_ns() - from_ns;
  }
}

// Pauses here, because waiting at the processor would block others of its priority.
void FilterStage::stand_back(std::int64_t slept_ns) noexcept {
  const std::int64_t now_ns = monotonic_ns();
  const std::int64_t rest_ns = share_.rest_ns(now_ns, [&] { return now_ns - slept_ns - rested_ns_; });
  if (rest_ns == 0) return;
  ++answer_.now.books.stood_back;
  std::this_thread::sleep_for(std::chrono::nanoseconds(rest_ns));
  rested_ns_ += rest_ns;
}

void FilterStage::process(const Increment& in) noexcept {
  chain_.process(in, out_);
  if (answer_.now.model_since_ns == 0) answer_.now.model_since_ns = in.utime_ns;
  const ChainParts& parts = chain_.parts();
  FilterBooks& books = answer_.now.books;
  const bool sent =
      output_.publisher->publish(output_.channel.c_str(), output_.encoder.encode(in, out_, parts));
  if (measure_latency_ && in.arrival_ns != 0) answer_.now.latency.add(arrival_clock_ns() - in.arrival_ns);
  for (Also& each : output_.also) {
    const auto message = each.encoder->encode(in, out_);
    if (message.empty()) continue;
    const bool also_sent = output_.publisher->publish(each.channel.c_str(), message);
    each.encoder->sent(also_sent);
    if (!also_sent) ++books.imu_failures;
  }
  books.samples += in.samples;
  books.merged += in.samples - 1;
  if (sent)
    ++books.sent;
  else if (books.failed++ == 0)
    events_.report({.kind = EventKind::publish_failed, .sequence = in.sequence});
  if ((out_.compensator_flags & (kStaleChannel | kNoChannelYet)) != 0) ++books.channel_stale;
  if ((out_.compensator_flags & kOutOfRange) != 0) ++books.out_of_range;
  if ((out_.flags & kNotCompensated) != 0) ++books.corrections_refused;
  if ((out_.estimate.flags & kRestarted) != 0) {
    ++books.filter_resets;
    events_.report({.kind = EventKind::divergence, .sequence = in.sequence});
  }
  if (!noise_known_ && parts.noise_known()) {
    noise_known_ = true;
    events_.report({.kind = EventKind::noise_learned,
                    .sequence = in.sequence,
                    .a = parts.filter().process_noise,
                    .b = parts.filter().measurement_noise});
  }
  follow_noise(in);
  std::copy_n(in.channel.begin(), facts_.channels, answer_.now.channel.begin());
  std::copy_n(in.channel_age_s.begin(), facts_.channels, answer_.now.channel_age_s.begin());
}

void FilterStage::follow_noise(const Increment& in) noexcept {
  if (in.samples == 1 && (in.flags & kGapBefore) == 0 && in.dt_s > 0.0) {
    ++intervals_.count;
    intervals_.mean_s += (in.dt_s - intervals_.mean_s) / static_cast<double>(intervals_.count);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(facts_.axes); ++i) {
    if ((in.flags & kGapBefore) != 0) {
      intervals_.allan[i].restart();
      answer_.now.rest.break_off(i);
    }
    // A merged sample has another averaging time than its neighbours, so no difference may use it.
    if (in.samples == 1 && ((in.valid_axes >> i) & 1U) != 0) {
      intervals_.allan[i].add(out_.compensated_radps[i]);
      answer_.now.rest.add(i, (out_.estimate.flags & kAtRest) != 0, out_.compensated_radps[i],
                           out_.estimate.innovation_radps[i]);
    } else {
      intervals_.allan[i].restart();
      answer_.now.rest.break_off(i);
    }
  }
}

void FilterStage::adopted(std::uint64_t sequence) noexcept {
  output_.encoder.use(chain_.parts());
  // A reload with the same model does not count as another one.
  if (chain_.parts().model_identity() != answer_.now.model.data()) answer_.now.model_since_ns = 0;
  noise_known_ = chain_.parts().noise_known();
  ++answer_.now.books.filter_resets;
  events_.report({.kind = EventKind::model_in_use, .sequence = sequence});
}

// False: the reader was writing its accounts all the time. It is not waited for, as it may need this
// processor.
bool FilterStage::answer() noexcept {
  constexpr int kTries = 1000;
  const ChainParts& parts = chain_.parts();
  answer_.now.health = chain_.health();
  answer_.now.learned = parts.learned();
  // After the filter's own, so that everything received is in the reader's.
  for (int tries = 0; !reader_books_.try_read(answer_.now.reader); relax())
    if (++tries == kTries) return false;
  answer_.now.allan_period_s = intervals_.count > 0 ? intervals_.mean_s : 1.0 / facts_.nominal_rate_hz;
  answer_.now.allan_octaves = StreamingAllan::kOctaves;
  for (std::size_t i = 0; i < static_cast<std::size_t>(facts_.axes); ++i) {
    answer_.now.allan_octaves = std::min(answer_.now.allan_octaves, intervals_.allan[i].octaves());
    for (int k = 0; k < StreamingAllan::kOctaves; ++k)
      answer_.now.allan_radps[i][static_cast<std::size_t>(k)] = intervals_.allan[i].deviation(k);
  }
  const std::string& identity = parts.model_identity();
  answer_.now.model.fill('\0');
  std::copy_n(identity.begin(), std::min(identity.size(), answer_.now.model.size() - 1),
              answer_.now.model.begin());
  answer_.given = answer_.now;
  answer_.now.latency.clear();
  answer_.state.store(Ask::answered, std::memory_order_release);
  return true;
}

bool FilterStage::ask() noexcept {
  const bool first = answer_.state.load(std::memory_order_acquire) != Ask::asked;
  if (first) answer_.state.store(Ask::asked, std::memory_order_release);
  queue_.notify();
  return first;
}

bool FilterStage::take_snapshot(FilterSnapshot& out) noexcept {
  // After the consumer's end nobody else uses the chain, so the last snapshot needs no request and is up to
  // date.
  if (answer_.finished.load(std::memory_order_acquire)) answer();
  if (answer_.state.load(std::memory_order_acquire) != Ask::answered) return false;
  out = answer_.given;
  // Release: the next answer may be written afterwards, not before `out` is complete.
  answer_.state.store(Ask::none, std::memory_order_release);
  return true;
}

}  // namespace ifog
