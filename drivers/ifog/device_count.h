// SPDX-License-Identifier: Apache-2.0
// How many samples a device has taken from one frame to the next: by the counter that it sends, by its clock
// where it has one, and by the times at which its frames came.
//
// The counter goes round. How often it did, the device's clock says; else the times of arrival, where whole
// rounds fit the time to what those times and the rate are worth: behind a gap that shows, and behind a
// silence of more than kLongSilence_s. Where that time is one in which frames may have been held up, those
// that follow are waited for: what was held up comes with less time between them than they took, and what was
// lost does not. What else comes late and continues the count is only late; where it has not drained for
// Lateness::kStands_s, the labels follow it. So exactly whole rounds that are lost within kLongSilence_s
// cannot be told from a late delivery or a pause and are taken for one; behind a longer silence only those
// that fit it as closely as a pause would by chance alone (kNoChance).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "drivers/ifog/arrivals.h"
#include "drivers/ifog/counted_step.h"
#include "drivers/ifog/lateness.h"
#include "drivers/ifog/measured_period.h"
#include "drivers/ifog/portions.h"
#include "drivers/ifog/prompt_arrivals.h"
#include "drivers/ifog/recent_frames.h"
#include "drivers/ifog/round_doubt.h"

namespace ifog {

class DeviceCount {
 public:
  using Frame = CountedFrame;
  using Step = CountedStep;

  // modulus: the counter's, > 0. period_s > 0. on_bus: frames of a bus, whose times of arrival are made where
  // nothing can have held them up.
  DeviceCount(std::uint64_t modulus, double period_s, bool on_bus = false) noexcept
      : modulus_(modulus), nominal_s_(period_s), on_bus_(on_bus), period_(period_s) {}

  void first(const Frame& frame) noexcept {
    arrivals_.forget();
    begin(frame);
    arrivals_.came(frame.arrival_ns, 0.0);
  }
  // What has passed to a frame of that count, less whole rounds: to one half of one on, or back by little.
  [[nodiscard]] std::optional<double> ahead_s(std::uint32_t sequence, double grain_s) const noexcept {
    const std::uint64_t ahead = difference(sequence), back = modulus_ - ahead;
    const double period_s = period_.by_clock_s(grain_s);
    if (ahead > 0 && ahead <= modulus_ / 2) return static_cast<double>(ahead) * period_s;
    if (ahead > 0 && back < std::min(kMostBack, modulus_ / 4)) return -static_cast<double>(back) * period_s;
    return std::nullopt;
  }
  // In which the counter goes round.
  [[nodiscard]] double round_s(double grain_s) const noexcept {
    return static_cast<double>(modulus_) * period_.by_clock_s(grain_s);
  }
  // Of the next frame; changes nothing.
  [[nodiscard]] Step look(const Frame& next) const noexcept {
    const Timed frame{next, arrivals_.elapsed_s(next.arrival_ns)};
    Step step;
    const std::uint64_t difference = this->difference(frame.sequence);
    if (out_of_turn(frame, difference)) {
      step.out_of_turn = true;
      return step;
    }
    if (!by_clock(frame, difference, step)) by_arrival(frame, difference, step);
    step.gap = step.gap || step.samples > 1 || step.restarted || frame.reopened;
    return step;
  }
  // Of a frame that is used.
  void take(const Frame& frame, const Step& step) noexcept {
    const double elapsed = arrivals_.elapsed_s(frame.arrival_ns);
    arrivals_.came(frame.arrival_ns, step.dt_s);
    if (elapsed >= 0.0) scatter(std::abs(elapsed - static_cast<double>(step.samples) * nominal_s_));
    if (step.restarted) {
      begin(frame);
      return;
    }
    const std::uint64_t samples = std::max<std::uint64_t>(step.samples, 1);
    place_ += samples;
    recent_.add(place_, 0, frame.digest);
    if (step.gap || step.clock_moved)
      period_.broken();
    else if (elapsed >= 0.0 && late_.now_s() == 0.0 && step.late_s == 0.0)
      period_.came(static_cast<double>(samples), elapsed);
    const auto counted = std::max<std::uint64_t>(difference(frame.sequence), 1);
    if (step.by_clock) took_by_clock_s_ = step.dt_s / static_cast<double>(samples);
    if (step.by_clock) each_by_clock_s_ = step.dt_s / static_cast<double>(counted);
    if (step.by_clock && !step.gap) period_.ticked(static_cast<double>(samples), step.dt_s);
    if (elapsed >= 0.0) prompt_.came(elapsed, step.dt_s);
    if (samples == 1 && !step.gap && !unseen(frame)) portions_.came(elapsed, nominal_s_);
    refused_ = clocked(frame) && !step.by_clock && passed_s(frame) != 0.0;
    follow_doubt(frame, step);
    late_.follow(step.late_s, elapsed, held_again(frame));
    if (frame.reopened) late_.begin_again();
    last_ = frame;
  }
  void keep_time(std::int64_t time_ns) noexcept { last_.time_ns = time_ns; }  // the frame's just taken

 private:
  static constexpr std::uint64_t kMostBack = RecentFrames::kKept;
  static constexpr std::uint64_t kBackUntimed = 8;  // so far frames change places, where no time says more
  static constexpr double kLate_s = 1.0;
  static constexpr double kMoved_s = 0.5 * kLate_s;  // what has come to stand, and was more
  static constexpr double kLongSilence_s = 2.0;
  static constexpr double kPaces = 200.0;   // so many times what times scatter by tell that
  static constexpr double kNoChance = 5.0;  // periods: half of the rounds that are lost to one of the pauses
  static constexpr double kAgain_s = 0.25;  // a silence of more is another one; no device begins anew in less
  static constexpr double kRateDoubt = 0.05;  // of the rate that the configuration says
  static constexpr double kScatters = 4.0;    // times what times scatter by is not by chance
  static constexpr double kClockSamples = 2.0, kClockDoubt = 0.01;  // clock and counter agree within this
  static constexpr double kBeside = 1.1;                            // likewise, behind a silence
  static constexpr double kMostMore = 1.5;  // samples than its clock has time for, behind a silence
  static constexpr double kLonger = 8.0;    // than a sample took: a rate that was stated wrong, a late one

  struct Timed : Frame {
    double elapsed_s = -1.0;  // since the frame before, by arrival; negative: not known
  };

  [[nodiscard]] std::uint64_t difference(std::uint32_t sequence) const noexcept {
    // Where both are counts below the modulus, as they are to be, without the two divisions.
    if (sequence < modulus_ && last_.sequence < modulus_) [[likely]]
      return sequence >= last_.sequence ? sequence - last_.sequence : sequence + modulus_ - last_.sequence;
    return (sequence + modulus_ - last_.sequence % modulus_) % modulus_;
  }
  // What arrival times scatter by: all but one in thirty of them by less. One that is far off makes it hardly
  // more.
  void scatter(double apart_s) noexcept {
    constexpr double kRare = 1.0 / 30.0, kUp = 1.0 + 0.3 * (1.0 - kRare), kDown = 1.0 - 0.3 * kRare;
    scatter_s_ = std::clamp(scatter_s_ * (apart_s > scatter_s_ ? kUp : kDown), 1e-4, kLate_s);
  }

  void begin(const Frame& frame) noexcept {
    place_ = kFirstPlace;
    recent_.forget();
    recent_.add(place_, 0, frame.digest);
    late_.forget();
    took_by_clock_s_ = each_by_clock_s_ = 0.0;
    period_.forget();
    prompt_.forget();
    portions_ = {};
    refused_ = false;
    doubt_.forget();
    last_ = frame;
  }
  // Came again, or after one that follows it: the count goes back by little, also of a round, and on from
  // there to here there was no time, as within a read. The very next of the count is never one.
  [[nodiscard]] bool out_of_turn(const Timed& frame, std::uint64_t difference) const noexcept {
    using Had = RecentFrames::Had;
    const std::uint64_t back = modulus_ - difference;
    if (difference <= 1 || back >= kMostBack) return false;
    // Nothing is late behind a silence, and opened again behind a pause it may be a device that began anew.
    if (opened_behind_pause(frame) || frame.quiet_s > std::max(kLongSilence_s, 2.0 * nominal_s_))
      return false;
    const bool timed = frame.elapsed_s >= 0.0;
    const Had had = recent_.at_place(place_ - back, frame.digest);
    // One that is missing just there is late whatever those before it were.
    const bool next_to_it = had == Had::no && back <= kBackUntimed;
    const double elapsed_s = frame.elapsed_s + (next_to_it ? 0.0 : late_.now_s());
    const double forward_s = static_cast<double>(difference) * nominal_s_;
    const double passed_s = clocked(frame) ? this->passed_s(frame) : 0.0;
    if (passed_s > 0.5 * forward_s && (!timed || !ifog::restarted(passed_s, elapsed_s))) return false;
    if (had == Had::same && recent_.tells_values_apart()) return true;
    const double back_s = static_cast<double>(back) * nominal_s_;
    const bool clock_fits = std::abs(passed_s + back_s) <= apart_s(back_s) + frame.grain_s;
    if (had != Had::other && passed_s < 0.0 && clock_fits) return true;
    if (passed_s < 0.0 && !clock_fits) return false;  // what comes late has the stamp of its place
    if (had == Had::other || back >= std::min(kMostBack, modulus_ / 4)) return false;
    if (clocked(frame) && passed_s > 0.0 && timed && !ifog::restarted(passed_s, elapsed_s)) return false;
    if (!timed) return had == Had::same || back <= kBackUntimed;
    return elapsed_s < std::max(0.5, had == Had::same ? 1.0 - prompt_s() / forward_s : 0.0) * forward_s;
  }
  [[nodiscard]] static bool opened_behind_pause(const Frame& frame) noexcept {
    return frame.reopened && !(frame.quiet_s >= 0.0 && frame.quiet_s < kAgain_s);
  }
  // What clock and counter of one device are apart by, at most, over such a time.
  [[nodiscard]] double apart_s(double time_s) const noexcept {
    return kClockSamples * nominal_s_ + kClockDoubt * time_s;
  }
  // Within what a sample is read as it comes, as far as this line has shown it.
  [[nodiscard]] double prompt_s() const noexcept { return std::min(kPrompt_s, kScatters * scatter_s_); }
  [[nodiscard]] bool clocked(const Frame& frame) const noexcept { return frame.clocked && last_.clocked; }
  [[nodiscard]] double passed_s(const Frame& frame) const noexcept {
    return static_cast<double>(ns_between(last_.time_ns, frame.time_ns)) * 1e-9;
  }

  // False where there is no clock, or it does not agree with the counter.
  [[nodiscard]] bool by_clock(const Timed& frame, std::uint64_t difference, Step& step) const noexcept {
    if (!clocked(frame)) return false;
    const double passed_s = this->passed_s(frame);
    if (passed_s == 0.0) return false;  // the same frame again, or a clock of coarse ticks
    const double elapsed_s = frame.elapsed_s < 0.0 ? -1.0 : frame.elapsed_s + late_.now_s();
    const double counted_s = static_cast<double>(difference) * nominal_s_;
    const bool possible =
        passed_s > 0.0 && !ifog::restarted(passed_s, elapsed_s < 0.0 ? counted_s : elapsed_s);
    const bool goes_on = difference == 1 && frame.quiet_s < kAgain_s + 2.0 * nominal_s_;
    if (!possible && goes_on) return false;  // the clock alone has jumped
    if (passed_s < 0.0 || (!possible && elapsed_s >= 0.0)) {
      step.restarted = true;
      step.samples = elapsed_s > 0.0 ? at_least_one(elapsed_s / nominal_s_) : 1;
      step.dt_s = static_cast<double>(step.samples) * nominal_s_;
      return true;
    }
    const double rounds = rounds_by_clock(passed_s, static_cast<double>(difference), frame.grain_s);
    // No clock is ahead of the times of arrival, but by what was held up on its way.
    if (rounds > 0.0 && elapsed_s >= 0.0 && passed_s > elapsed_s + prompt_.behind_s() + kPrompt_s)
      return false;
    const double claimed = static_cast<double>(difference) + rounds * static_cast<double>(modulus_);
    if (!agree(claimed, passed_s, elapsed_s, frame.grain_s)) return false;
    const double took_s = took_by_clock_s_ > 0.0 ? took_by_clock_s_ : nominal_s_;
    const double least_s = claimed * std::min(took_s, nominal_s_);
    if (ifog::restarted(least_s, passed_s) || (silent(frame, 0.0) && least_s > kMostMore * passed_s)) {
      step.restarted = true;  // the counter alone
      step.samples = at_least_one(passed_s / nominal_s_);
      step.dt_s = passed_s;
      return true;
    }
    step.by_clock = true;
    step.samples = static_cast<std::uint64_t>(claimed);
    if (stood_still(frame, claimed, passed_s - frame.grain_s))
      step.samples = at_least_one(passed_s / took_by_clock_s_);
    step.dt_s = passed_s;
    // While a coarse clock stood the count has gone on.
    const bool tick = frame.grain_s > 0.0 && passed_s <= 2.0 * frame.grain_s;
    const double took_by_count_s = claimed * period_.by_arrival_s();
    if (elapsed_s >= 0.0) lateness(frame, elapsed_s - (tick ? took_by_count_s : passed_s), step);
    return true;
  }
  // By its clock much longer than its count says: it measured nothing meanwhile, or began to count anew.
  // Where the one before took as long, or there was no silence, it measures at another rate.
  [[nodiscard]] bool stood_still(const Timed& frame, double claimed, double passed_s) const noexcept {
    const double each_s = passed_s / claimed;
    if (took_by_clock_s_ == 0.0) return false;
    if (each_s > kLonger * took_by_clock_s_ && each_s > 2.0 * each_by_clock_s_) return true;
    return silent(frame, claimed * took_by_clock_s_) && each_s > kBeside * took_by_clock_s_;
  }
  [[nodiscard]] double rounds_by_clock(double passed_s, double counted, double grain_s) const noexcept {
    const double period_s = period_.by_clock_s(grain_s), spare = passed_s / period_s - counted;
    if (spare <= kClockSamples + grain_s / period_s) return 0.0;
    return std::max(0.0, std::round(spare / static_cast<double>(modulus_)));
  }
  // Where clock and count disagree, a clock that goes on as before is followed. Else the times of arrival say
  // which of them: the count where it is as near to them as they scatter by, or where the clock would be
  // ahead of them; the clock by far more than the samples ever took only where that time was to be seen, or
  // where nobody knows how long one takes but the stated rate.
  [[nodiscard]] bool agree(double claimed, double passed_s, double elapsed_s, double grain_s) const noexcept {
    if (std::abs(claimed * nominal_s_ - passed_s) <= apart_s(passed_s) + grain_s) return true;
    const bool usual = passed_s <= kLonger * claimed * std::max(nominal_s_, took_by_clock_s_);
    if (elapsed_s < 0.0) return usual || took_by_clock_s_ == 0.0;
    if (took_by_clock_s_ > 0.0) {
      const double as_before_s = claimed * took_by_clock_s_;
      if (std::abs(as_before_s - passed_s) <=
          kClockSamples * took_by_clock_s_ + kClockDoubt * passed_s + grain_s)
        return true;
      if (prompt_.ahead(passed_s, elapsed_s, apart_s(passed_s) + grain_s)) return false;
      if (!refused_ && std::abs(as_before_s - elapsed_s) <= prompt_s()) return false;
    }
    return std::abs(passed_s - elapsed_s) <= kPrompt_s + kRateDoubt * elapsed_s &&
           (usual || elapsed_s >= 0.5 * passed_s);
  }
  // Nothing came for longer than that, by far.
  [[nodiscard]] static bool silent(const Frame& frame, double usual_s) noexcept {
    return frame.quiet_s > kAgain_s + usual_s;
  }
  // Behind another silence: how that drains is still to be seen.
  [[nodiscard]] bool held_again(const Frame& frame) const noexcept {
    return silent(frame, static_cast<double>(difference(frame.sequence)) * nominal_s_);
  }
  // How far behind its clock a frame is that is held up.
  void lateness(const Timed& frame, double late_s, Step& step) const noexcept {
    if (late_.stands(late_s, frame.elapsed_s, held_again(frame)))
      step.clock_moved = late_s > kMoved_s;
    else if (late_.now_s() > 0.0 ? !late_.over(late_s, frame.elapsed_s) : late_s > kLate_s)
      step.late_s = late_s;
  }
  // Behind what nobody saw coming: a device that was opened again, a backlog of which no times are known.
  [[nodiscard]] bool unseen(const Frame& frame) const noexcept {
    return frame.reopened || (last_.arrival_ns <= 0 && arrivals_.known());
  }
  // Rounds may have been lost where this one is.
  [[nodiscard]] bool doubtful(const Frame& frame, std::uint64_t difference) const noexcept {
    return difference != 1 || frame.quiet_s > kLongSilence_s || unseen(frame);
  }
  // So long frames have to come at the pace at which they were taken.
  [[nodiscard]] double paced_s() const noexcept {
    return std::clamp(kPaces * scatter_s_, 0.09, Lateness::kStands_s);
  }
  void follow_doubt(const Frame& frame, const Step& step) noexcept {
    const std::uint64_t difference = this->difference(frame.sequence);
    const bool here = doubtful(frame, difference);
    if (step.late_s == 0.0 || (late_.now_s() == 0.0 && !here)) return doubt_.forget();
    doubt_.follow({step.late_s, frame.quiet_s, static_cast<double>(difference) * nominal_s_, here,
                   difference != 1 || unseen(frame), step.gap},
                  paced_s());
  }
  // Whole rounds of the counter in a time that it does not account for. None that the rate may be wrong by.
  [[nodiscard]] double rounds_in(double spare_s, double elapsed_s) const noexcept {
    const double slack_s = kPrompt_s + period_.doubt() * elapsed_s;
    if (spare_s <= slack_s || portions_.is_usual(spare_s)) return 0.0;
    return whole_rounds(spare_s, static_cast<double>(modulus_) * period_.by_arrival_s(), slack_s,
                        std::max(kAdapter_s, scatter_s_));
  }
  // Behind a silence the very next of the count: so ends every pause of the device, and one in a round's
  // number of losses. These are told only where whole rounds fit the time as chance seldom would.
  [[nodiscard]] bool paused(bool goes_on, double spare_s, double elapsed_s) const noexcept {
    const double period_s = period_.by_arrival_s(), fits_s = kNoChance * period_s;
    const double round_s = static_cast<double>(modulus_) * period_s;
    return goes_on && (period_.doubt() * elapsed_s + scatter_s_ > fits_s ||
                       std::abs(std::remainder(spare_s, round_s)) > fits_s);
  }

  void by_arrival(const Timed& frame, std::uint64_t difference, Step& step) const noexcept {
    const double period = period_.by_arrival_s();
    const bool known = frame.elapsed_s >= 0.0;
    const double elapsed_s = frame.elapsed_s + late_.now_s();
    // The same count again is a round on, or nothing; behind an opening nothing comes again.
    const bool again = difference == 0 && !opened_behind_pause(frame) &&
                       (frame.digest == last_.digest || frame.quiet_s <= kLate_s);
    step.samples = difference > 0 || again ? difference : modulus_;
    const double counted_s = static_cast<double>(step.samples) * period;
    step.late_s = known ? std::max(0.0, elapsed_s - counted_s) : late_.now_s();
    const bool at_once = on_bus_ || again ||
                         (late_.now_s() == 0.0 && doubtful(frame, difference) &&
                          (frame.reopened || !unseen(frame)) && step.late_s <= kLate_s);
    const bool came_to_stand = late_.stands(step.late_s, frame.elapsed_s, held_again(frame));
    const bool told =
        doubt_.rounds() && (came_to_stand || doubt_.at_pace(step.late_s, frame.elapsed_s, paced_s()));
    if (known && elapsed_s > 0.0 && (at_once || told)) {
      // While a frame came again and again no round was lost: the device stood still.
      const double quiet_s = at_once ? frame.quiet_s : doubt_.quiet_s();
      const double spare_s = std::min(step.late_s, quiet_s);
      const bool goes_on = at_once ? difference == 1 && !unseen(frame) : !doubt_.counts();
      const double over_s = at_once ? frame.elapsed_s : std::max(elapsed_s, doubt_.since_s());
      const double rounds = paused(goes_on, spare_s, over_s) ? 0.0 : rounds_in(spare_s, over_s);
      step.samples += static_cast<std::uint64_t>(rounds) * modulus_;
      step.same_gap = !at_once && rounds > 0.0 && doubt_.gap();
      if (rounds > 0.0) step.late_s = 0.0;
    }
    if (came_to_stand) {
      // What does not drain was no delivery: a pause, or rounds that were lost. Which of them nothing says,
      // but the labels follow.
      step.clock_moved = step.late_s > kMoved_s || rounds_in(step.late_s, elapsed_s) >= 1.0;
      step.late_s = 0.0;
    } else if (late_.now_s() > 0.0 ? late_.over(step.late_s, frame.elapsed_s)
                                   : step.late_s < std::max(kLate_s, 3.0 * period) &&
                                         rounds_in(step.late_s, elapsed_s) < 1.0) {
      step.late_s = 0.0;
    }
    if (step.samples == 0) {
      step.late_s = late_.now_s();
      step.gap = true;
      step.dt_s = nominal_s_;
      return;
    }
    const double claimed_s = static_cast<double>(step.samples) * nominal_s_;
    const bool backwards = !arrivals_.known() && difference > modulus_ / 2;  // no arrival times to ask, ever
    const double slack_s = kLate_s + kRateDoubt * claimed_s;
    const bool jumped =
        known && (ifog::restarted(claimed_s, elapsed_s) ||
                  prompt_.ahead(static_cast<double>(step.samples) * period, elapsed_s, slack_s));
    if (step.samples > 1 && (jumped || backwards)) {
      step.samples = known && elapsed_s > 0.0 ? at_least_one(elapsed_s / nominal_s_) : 1;
      step.restarted = true;
      step.late_s = 0.0;
    }
    step.undecided =
        step.late_s > 0.0 && (late_.now_s() > 0.0 ? doubt_.rounds() : doubtful(frame, difference));
    step.dt_s = static_cast<double>(step.samples) * nominal_s_;
  }

  std::uint64_t modulus_;
  double nominal_s_;
  bool on_bus_;
  Frame last_;
  static constexpr std::uint64_t kFirstPlace = std::uint64_t{1} << 32U;  // those before it have places, too
  std::uint64_t place_ = kFirstPlace;                                    // of the last one
  RecentFrames recent_;
  Arrivals arrivals_;
  RoundDoubt doubt_;
  Lateness late_;  // of the last frame, undecided
  MeasuredPeriod period_;
  double scatter_s_ = 1e-3;
  PromptArrivals prompt_;
  Portions portions_;
  bool refused_ = false;          // the clock's step to the last frame was not followed
  double took_by_clock_s_ = 0.0;  // the last sample of which the clock said it; 0: none yet
  double each_by_clock_s_ = 0.0;  // each that it counted
};

}  // namespace ifog
