// SPDX-License-Identifier: Apache-2.0
#include "daemon/housekeeping/status_report.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/transport.h"
#include "filters/units/told_time.h"
#include "msgs/counters.h"

namespace ifog {
namespace {

constexpr int kPatience = 60;  // seconds with samples until the noise should be known
constexpr int kInVain = 5;     // seconds of input without a frame before a warning

// Time without data after which an open device counts as silent.
double silence_s(double rate_hz) { return std::max(2.0, 3.0 / rate_hz); }
constexpr const char* kFrozen =
    "the device sends the same frame again and again: its counter or clock stands still, nothing of it is "
    "used";
constexpr const char* kMixed =
    "the sequence runs to and fro: two devices send on one line, and nothing of either is used";

std::int64_t as_signed(std::uint64_t count) { return static_cast<std::int64_t>(count); }

std::string fault_of(const Transport& transport, std::uint64_t bytes_at_end) {
  const TransportFault fault = transport.fault();
  const std::string words =
      fault.what == nullptr
          ? ""
          : std::string(fault.what) + (fault.text.empty() ? "" : ", found " + in_quotes(fault.text));
  if (transport.state() != TransportState::open && transport.reason() != 0)
    return transport.name() + ": " + std::strerror(transport.reason()) +
           (words.empty() || fault.line > 0 ? "" : " (" + words + ")");
  if (bytes_at_end != 0)
    return transport.name() + ": ends within a frame, its last " + std::to_string(bytes_at_end) +
           " bytes are no whole one (is the file cut off?)";
  if (fault.what == nullptr) return "";
  return transport.name() + (fault.line > 0 ? ":" + std::to_string(fault.line) : "") + ": " + words;
}

}  // namespace

StatusReport::StatusReport(std::string sensor, std::vector<std::string> channels,
                           const std::vector<std::string>& axes, double sample_rate_hz)
    : before_(), now_(), watch_(axes.size(), sample_rate_hz), axes_(axes), nominal_rate_hz_(sample_rate_hz) {
  now_.sensor = std::move(sensor);
  now_.version = IFOG_VERSION;
  now_.axes = static_cast<std::int8_t>(axes.size());
  now_.nis_mean.resize(axes.size());
  now_.whiteness.resize(axes.size());
  now_.measurement_noise.resize(axes.size());
  now_.allan_rate_radps.resize(axes.size());
  now_.channels = static_cast<std::int32_t>(channels.size());
  now_.channel_value.resize(channels.size());
  now_.channel_age_s.resize(channels.size());
  now_.channel_name = std::move(channels);
  before_ = now_;
}

std::int32_t StatusReport::state_of(const Pipeline& pipeline, const ReaderBooks& read) const {
  const Transport& transport = pipeline.reader().transport();
  switch (transport.state()) {
    case TransportState::gone:
      return status_t::STATE_REOPENING;
    case TransportState::ended:
      // A fault at the end means a truncated or damaged file, or another sensor's.
      if (nothing_in_file(pipeline) || transport.reason() != 0 || transport.fault().what != nullptr ||
          read.bytes_at_end != 0)
        return status_t::STATE_FAILED;
      return status_t::STATE_ENDED;
    case TransportState::open:
      break;
  }
  if (read.mixed != 0) return status_t::STATE_NO_DATA;
  const std::int64_t since_ns = std::max(samples_.first_look_ns, samples_.last_ns);
  if (static_cast<double>(monotonic_ns() - since_ns) * 1e-9 > silence_s(nominal_rate_hz_))
    return status_t::STATE_NO_DATA;
  if (samples_.last_ns == 0) return status_t::STATE_STARTING;
  return status_t::STATE_RUNNING;
}

// From the reader, so it does not depend on the filter's answer. A repeated frame is no sample.
void StatusReport::look_for_samples(const ReaderBooks& read) {
  if (samples_.first_look_ns == 0) samples_.first_look_ns = monotonic_ns();
  const bool came = now_.samples_decoded != before_.samples_decoded;
  samples_.news = now_.samples_in != before_.samples_in;
  if (samples_.news) samples_.last_ns = monotonic_ns();
  samples_.seconds += samples_.news ? 1 : 0;
  samples_.axes_seen = read.axes_seen;
  samples_.frozen_before = samples_.frozen;
  const bool long_ago =
      samples_.last_ns != 0 &&
      static_cast<double>(monotonic_ns() - samples_.last_ns) * 1e-9 > silence_s(nominal_rate_hz_);
  samples_.frozen = long_ago && read.mixed == 0 && !samples_.news && (came || samples_.frozen);
}

std::string StatusReport::fault_of_samples(bool mixed) {
  const bool in_vain = now_.frames_good + now_.samples_decoded == 0 && now_.bytes_read + now_.frames_read > 0;
  in_vain_ = in_vain ? in_vain_ + 1 : 0;
  if (mixed) return kMixed;
  if (samples_.frozen) return kFrozen;
  if (in_vain_ < kInVain) return "";
  return std::string(now_.frames_read > 0 ? "CAN frames" : "bytes") +
         " received and no frame of the sensor in them: check driver, options and baud";
}

// True if a file has ended, is completely counted, and had no frame.
bool StatusReport::nothing_in_file(const Pipeline& pipeline) const {
  const Transport& transport = pipeline.reader().transport();
  const TransportCounters line = transport.counters();
  return transport.state() == TransportState::ended && pipeline.ended() &&
         as_signed(line.bytes) == now_.bytes_read && as_signed(line.frames) == now_.frames_read &&
         now_.frames_good + now_.samples_decoded == 0;
}

// From the moment of the filter's snapshot, so they balance.
void StatusReport::take_books(const ReaderBooks& read, const FilterBooks& filtered) {
  now_.bytes_read = as_signed(read.line.bytes);
  now_.bytes_framed = as_signed(read.driver.bytes_framed);
  now_.bytes_skipped = as_signed(read.driver.bytes_skipped);
  now_.bytes_pending = as_signed(read.driver.bytes_pending);
  now_.frames_read = as_signed(read.line.frames);
  now_.frames_other = as_signed(read.driver.frames_other);
  now_.frames_good = as_signed(read.driver.frames_good);
  now_.frames_format = as_signed(read.driver.frames_format);
  now_.frames_crc = as_signed(read.driver.frames_crc);
  now_.frames_repeated = as_signed(read.driver.frames_repeated);
  now_.log_faults = as_signed(read.line.malformed);
  now_.kernel_drops = as_signed(read.line.kernel_drops);
  now_.can_error_frames = as_signed(read.line.error_frames);
  now_.reopened = as_signed(read.line.reopened);
  now_.samples_decoded = as_signed(read.decoded);
  now_.samples_in = as_signed(read.counts.samples);
  now_.samples_repeated = as_signed(read.counts.repeated);
  now_.samples_incomplete = as_signed(read.driver.samples_incomplete);
  now_.sequence_gaps = as_signed(read.counts.gaps);
  now_.sequence_missing = as_signed(read.counts.missing);
  now_.invalid_samples = as_signed(read.counts.invalid);
  now_.saturated_samples = as_signed(read.counts.saturated);
  now_.implausible_samples = as_signed(read.counts.implausible);
  now_.channel_drops = as_signed(read.channel_drops);
  now_.channel_implausible =
      as_signed(read.counts.channel_implausible + read.driver.values_refused + read.channel_refused);
  now_.clock_offset_ppm = read.clock_offset_ppm;
  interval_error_before_ = std::exchange(interval_error_, read.interval_error);
  now_.samples_waiting = as_signed(read.counts.samples - filtered.samples);
  now_.samples_published = as_signed(filtered.sent);
  now_.samples_merged = as_signed(filtered.merged);
  now_.lcm_failures = as_signed(filtered.failed);
  now_.imu_failures = as_signed(filtered.imu_failures);
  now_.channel_stale = as_signed(filtered.channel_stale);
  now_.out_of_range = as_signed(filtered.out_of_range);
  now_.corrections_refused = as_signed(filtered.corrections_refused);
  now_.filter_resets = as_signed(filtered.filter_resets);
  now_.stood_back = as_signed(read.stood_back + filtered.stood_back);
}

void StatusReport::take_health(const FilterSnapshot& snapshot) {
  now_.gated = as_signed(snapshot.health.gated);
  now_.floor_hits = as_signed(snapshot.health.floor_hits);
  now_.manoeuvres = as_signed(snapshot.health.manoeuvres);
  now_.divergences = as_signed(snapshot.health.divergences);
  for (std::size_t i = 0; i < now_.nis_mean.size(); ++i) {
    now_.nis_mean[i] = snapshot.health.nis_mean[i];
    now_.whiteness[i] = snapshot.health.whiteness[i];
    now_.measurement_noise[i] = snapshot.health.measurement_noise[i];
  }
  now_.latency_p50_us = snapshot.latency.percentile_us(0.5);
  now_.latency_p99_us = snapshot.latency.percentile_us(0.99);
  now_.latency_max_us = snapshot.latency.max_us();
  now_.octaves = snapshot.allan_octaves;
  now_.allan_tau0_s = snapshot.allan_period_s;
  for (std::size_t i = 0; i < now_.allan_rate_radps.size(); ++i)
    now_.allan_rate_radps[i].assign(snapshot.allan_radps[i].begin(),
                                    snapshot.allan_radps[i].begin() + now_.octaves);
  for (std::size_t i = 0; i < now_.channel_value.size(); ++i) {
    now_.channel_value[i] = snapshot.channel[i];
    now_.channel_age_s[i] = static_cast<double>(snapshot.channel_age_s[i]);
  }
}

const status_t& StatusReport::update(const Pipeline& pipeline, const FilterSnapshot& snapshot,
                                     double interval_s) {
  const Transport& transport = pipeline.reader().transport();
  const ReaderBooks& read = snapshot.reader;
  before_ = now_;
  now_.utime = realtime_ns() / 1000;
  now_.model = snapshot.model.data();
  now_.model_since = snapshot.model_since_ns / 1000;
  take_books(read, snapshot.books);
  now_.fault = imbalance(read, snapshot.books);
  look_for_samples(read);
  // A fault in the data may be an old one.
  if (now_.fault.empty() && transport.state() == TransportState::open)
    now_.fault = fault_of_samples(read.mixed != 0);
  if (now_.fault.empty()) now_.fault = fault_of(transport, read.bytes_at_end);
  if (now_.fault.empty() && nothing_in_file(pipeline))
    now_.fault = transport.name() + ": ended, and no frame of the sensor was in its " +
                 (now_.frames_read > 0 ? std::to_string(now_.frames_read) + " CAN frames"
                                       : std::to_string(now_.bytes_read) + " bytes") +
                 " (is it this driver's, with these options?)";
  take_health(snapshot);
  watch_.take(snapshot.rest, snapshot.books.sent, snapshot.books.out_of_range);
  now_.noticed = watch_.noticed();
  now_.notice = watch_.words();
  now_.ring_overflows = as_signed(pipeline.queue().overflows());
  now_.events_lost = as_signed(pipeline.events_lost());
  now_.state = state_of(pipeline, read);
  if (interval_s > 0.0) {
    now_.input_rate_hz = input_rate_.of(now_.samples_in, interval_s, nominal_rate_hz_);
    now_.output_rate_hz = output_rate_.of(now_.samples_published, interval_s, nominal_rate_hz_);
  }
  return now_;
}

void StatusReport::update(Recorder& recorder) {
  const Recorder::Counts counts = recorder.counts();
  now_.record_deliveries = as_signed(recorder.tape().counters().deliveries.value());
  now_.record_lost = as_signed(counts.lost.deliveries);
  now_.record_lost_bytes = as_signed(counts.lost.bytes);
  now_.record_file_bytes = as_signed(counts.file_bytes);
  now_.record_removed = as_signed(counts.files_removed);
}

std::string StatusReport::newly_noticed() const { return watch_.words(now_.noticed & ~before_.noticed); }

std::string StatusReport::unseen_axes() const {
  if (!samples_.news || samples_.seconds != kInVain || samples_.axes_seen == 0) return "";
  std::string out;
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (((samples_.axes_seen >> i) & 1U) == 0) out += (out.empty() ? "" : ", ") + axes_[i];
  return out.empty() ? "" : "no value of axis " + out + " so far: does the device have it?";
}

std::string StatusReport::unknown_noise() const {
  const bool known = std::ranges::any_of(now_.measurement_noise, [](double noise) { return noise > 0.0; });
  if (known || !samples_.news || samples_.seconds != kPatience) return "";
  return "the noise is not known after a minute, so the rate is published as compensated: that takes rests "
         "of 512 samples, 4096 in all; if the sensor never rests, configure the model of 'ifog tune' for a "
         "recording at rest";
}

std::string StatusReport::newly_frozen() const {
  return samples_.frozen && !samples_.frozen_before ? kFrozen : "";
}

std::string StatusReport::wrong_rate() const {
  if (interval_error_ == 0.0 || interval_error_before_ != 0.0) return "";
  // Intervals in use are 1/nominal, the true ones 1/rate.
  const double rate_hz = nominal_rate_hz_ / (1.0 + interval_error_), off = rate_hz / nominal_rate_hz_ - 1.0;
  return formatted(
      "samples come at %.4g Hz by their arrival, expected %.4g Hz: intervals, and angles made of a "
      "rate, are %.3g %% too %s: is rate_hz of its options (or nominal_rate_hz) that of the device?",
      rate_hz, nominal_rate_hz_, 100.0 * std::abs(off), off < 0.0 ? "small" : "large");
}

std::string StatusReport::moved() const {
  std::string out;
  for (const StatusCounter& fault : kStatusCounters) {
    const std::int64_t by = now_.*fault.count - before_.*fault.count;
    if ((fault.use & kCounterLogged) != 0 && by != 0)
      out += (out.empty() ? "" : ", ") + std::string(fault.name) + " +" + std::to_string(by);
  }
  return out;
}

}  // namespace ifog
