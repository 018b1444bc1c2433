// SPDX-License-Identifier: Apache-2.0
#include "daemon/recorder/recorder.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <iterator>
#include <utility>

#include "daemon/realtime/realtime.h"
#include "drivers/transport/clock.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

// Interval between turns. A kill then loses less than a second (ArchiveLimits::flush_ns), and the recorders
// of three sensors interrupt readers a dozen times a second.
constexpr auto kRest = std::chrono::milliseconds(250);
// Largest data rate of a device, bytes per second, for small tapes.
constexpr std::int64_t kFastest = 5'000'000;
// Time without losses after which a problem is over; a disk that keeps up intermittently is slow.
constexpr std::int64_t kQuiet_ns = 10'000'000'000;

std::string losses_in_words(std::uint64_t deliveries, std::int64_t within_ns) {
  if (deliveries == 0) return "nothing is lost";
  return formatted("%llu deliveries are lost, all within %.1f s", static_cast<unsigned long long>(deliveries),
                   static_cast<double>(within_ns) * 1e-9);
}

}  // namespace

Recorder::Recorder(std::string name, std::size_t tape_bytes, std::unique_ptr<FlightFolder> folder,
                   const ArchiveLimits& limits, FlightHeader header)
    : name_(std::move(name)),
      rest_(std::min<std::chrono::nanoseconds>(
          kRest, std::chrono::milliseconds(static_cast<std::int64_t>(tape_bytes) * 1000 / kFastest))),
      tape_(tape_bytes),
      archive_(std::move(folder), limits, std::move(header)) {
  payload_.reserve(Tape::kLeastBytes);
}

Recorder::~Recorder() { stop(); }

void Recorder::start() {
  thread_ = std::thread([this] { run(); });
}

void Recorder::run() {
  apply_to_this_thread({name_, 0, {}});
  // Ordinary scheduling, so that compressing and writing never delay a reader.
  const sched_param none{};
  pthread_setschedparam(pthread_self(), SCHED_BATCH, &none);
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    lock.unlock();
    // A file at its own pace waits for space.
    const bool fills = tape_.is_half_full();
    turn(arrival_clock_ns(), realtime_ns());
    lock.lock();
    stops_.wait_for(lock, fills ? rest_ / 5 : rest_, [this] { return stopping_; });
  }
}

void Recorder::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stops_.notify_one();
  thread_.join();
  const std::int64_t now_ns = arrival_clock_ns(), wall_ns = realtime_ns();
  drain(now_ns, wall_ns, true);
  // Losses without a later delivery.
  const TapeCounters& counters = tape_.counters();
  const FlightLoss unreported{counters.lost_deliveries.value() - reported_.deliveries,
                              counters.lost_bytes.value() - reported_.bytes};
  if (unreported.deliveries > 0)
    archive_.add({FlightKind::lost, 0, 0, 0, now_ns},
                 {reinterpret_cast<const std::uint8_t*>(&unreported), sizeof unreported});
  std::uint64_t unwritten = archive_.close(now_ns, wall_ns);
  // Entries that could not leave the tape because of the disk.
  FlightLoss left;
  for (FlightEntryHead head; tape_.take(head, payload_);) {
    if (head.kind == FlightKind::settings) continue;  // not an entry of the record
    ++unwritten;
    const bool came = head.kind == FlightKind::bytes || head.kind == FlightKind::can;
    if (came) left += {tape_.begins_delivery() ? 1U : 0U, payload_.size()};
  }
  publish_counts(left, unwritten);
  judge(now_ns);
  judge_the_end(archive_.lost_at_close().deliveries + left.deliveries);
}

void Recorder::publish_counts(const FlightLoss& lost, std::uint64_t unwritten) {
  Counts now{archive_.bytes_written(), archive_.files_removed(), unwritten, lost};
  now.lost += archive_.lost_with_files();
  now.lost += archive_.lost_at_close();
  const std::lock_guard lock(mutex_);
  counts_ = now;
}

Recorder::Counts Recorder::counts() const {
  const std::lock_guard lock(mutex_);
  Counts out = counts_;
  out.lost += {tape_.counters().lost_deliveries.value(), tape_.counters().lost_bytes.value()};
  return out;
}

void Recorder::set_header(FlightHeader header, std::uint32_t settings) {
  const std::lock_guard lock(mutex_);
  header.settings = settings;
  next_headers_[settings] = std::move(header);
}

void Recorder::turn(std::int64_t now_ns, std::int64_t wall_ns) {
  drain(now_ns, wall_ns, false);
  publish_counts();
  judge(now_ns);
}

// Moves entries from tape to archive until one is empty, the other full, or new settings start.
void Recorder::fill() {
  FlightEntryHead head;
  while (settings_due_ == 0 && !archive_.full() && tape_.take(head, payload_)) {
    if (head.kind == FlightKind::settings) {
      settings_due_ = head.length;
      return;
    }
    archive_.add(head, payload_, tape_.begins_delivery());
    if (head.kind != FlightKind::lost) continue;
    FlightLoss lost;
    std::memcpy(&lost, payload_.data(), sizeof lost);
    reported_ += lost;
  }
}

// True: everything before is written, and the next data start another file.
bool Recorder::begin_settings() {
  if (settings_due_ == 0 || archive_.entries_waiting() > 0) return false;
  const std::lock_guard lock(mutex_);
  const auto found = next_headers_.find(std::exchange(settings_due_, 0));
  if (found == next_headers_.end()) return true;
  archive_.set_header(std::move(found->second));
  next_headers_.erase(next_headers_.begin(), std::next(found));
  return true;
}

// Until the tape is empty or the disk accepts no more.
void Recorder::drain(std::int64_t now_ns, std::int64_t wall_ns, bool flush) {
  for (bool more = true; more;) {
    fill();
    const bool full = archive_.full();
    archive_.turn(now_ns, wall_ns, flush || (settings_due_ != 0 && archive_.error() == 0));
    tape_.attend(archive_.error() == 0);
    more = begin_settings() || (settings_due_ == 0 && full && !archive_.full());
  }
}

void Recorder::say(std::string message, bool good) {
  const std::lock_guard lock(mutex_);
  // Both in one turn of housekeeping: the later message is used, and mentions the earlier one's end.
  message_ = {std::move(message), good};
}

void Recorder::judge(std::int64_t now_ns) {
  const std::uint64_t gone = archive_.lost_with_files().deliveries;
  if (const std::uint64_t before = std::exchange(trouble_.gone_seen, gone); before != gone)
    say("recorder: " + archive_.path() + ": the recording in work has been removed, " +
            std::to_string(gone - before) + " deliveries with it",
        false);
  const std::uint64_t lost = tape_.counters().lost_deliveries.value();
  if (const std::uint64_t before = std::exchange(trouble_.lost_seen, lost); before != lost) {
    if (before == trouble_.lost_before) trouble_.first_loss_ns = trouble_.judged_ns;
    trouble_.last_loss_ns = now_ns;
  }
  trouble_.judged_ns = now_ns;
  const int error = archive_.error();
  const bool losing = trouble_.last_loss_ns != 0 && now_ns - trouble_.last_loss_ns < kQuiet_ns;
  if (!trouble_.present && (error != 0 || losing)) {
    trouble_.present = true;
    say("recorder: " + archive_.path() + ": " +
            (error != 0 ? archive_.complaint() + ", nothing is recorded until it takes more"
                        : std::string("slower than what is to be recorded, a part is dropped")) +
            "; what is lost is counted",
        false);
  } else if (trouble_.present && error == 0 && !losing) {
    trouble_.present = false;
    say("recorder: " + archive_.path() + ": all is recorded again, " +
            losses_in_words(lost - trouble_.lost_before, trouble_.last_loss_ns - trouble_.first_loss_ns),
        true);
    trouble_.lost_before = lost;
  }
}

// Reports data that the disk did not accept until the end.
void Recorder::judge_the_end(std::uint64_t deliveries) {
  if (deliveries == 0) return;
  say("recorder: " + archive_.path() + ": " + archive_.complaint() + " to the end, the last " +
          std::to_string(deliveries) + " deliveries are not recorded",
      false);
}

std::string Recorder::take_message(bool& good) {
  const std::lock_guard lock(mutex_);
  good = message_.good;
  return std::exchange(message_.text, {});
}

}  // namespace ifog
