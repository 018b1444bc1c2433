// SPDX-License-Identifier: Apache-2.0
// Frames of two devices on one line or bus. Each counts for itself, so the counter goes to and fro between
// two counts that each go on by one, both as quickly as a device samples: summed, they would be twice the
// time and the sum of both rates.
//
// As soon as that shows, the count that was there first is followed and the other left out. What is left out
// may be the first one's own frames, which come a second time by a longer way: then what one had the other
// has, too. Where neither has the other's, they are two, which one is wanted nobody knows, and nothing is
// taken of either until one has gone.
//
// One device can look so in part. Where its frames change places, what comes late is what was missing: both
// counts together then are as many frames as one of them has gone on. Where frames are missing, or it is
// polled, so that a round and one more passes from one to the next, that takes longer than samples do.
// A counter of less than 128 shows nothing, nor does a clock: frames of one device that change places would
// look like two, and its own samples would be left out.
// Frames that were held up show nothing.
//
// Two devices whose counters are the same, to one, cannot be told from one that counts every second sample.
// They are found when one of them has counted on a little further: 20 ppm apart that is within a minute.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace ifog {

class MixedDevices {
 public:
  enum class Says : std::uint8_t {
    one,   // goes on as what was taken, or nothing speaks against it
    left,  // of another count than the one that is followed, or of two: not taken
    anew   // taken, but it does not join what was
  };
  struct Frame {
    std::int64_t at = 0;          // its count
    std::int64_t arrival_ns = 0;  // 0: not known
    std::uint64_t digest = 0;     // of its values
  };

  // modulus: of the count, > 0. period_s: of a sample; 0: not known.
  MixedDevices(std::int64_t modulus, double period_s) noexcept : modulus_(modulus), period_s_(period_s) {}

  // Nothing comes before it.
  void first(std::int64_t at) noexcept {
    begin(at);
    state_ = State::one;
  }
  // The next frame goes on with the last, and there is nothing else: no more is to be asked.
  [[nodiscard]] bool plain(std::int64_t at) noexcept {
    if (watching_) return false;
    if (ahead(tails_[latest_].at, at) != 1) return false;
    tails_[latest_].at = at;
    return true;
  }
  // Of one that is not plain.
  Says next(const Frame& frame) noexcept {
    watch();
    ++frames_;
    const std::size_t tail = tail_of(frame);
    const bool new_one = tail == kTails, again = !new_one && tails_[tail].at == frame.at;
    if (new_one)
      open(frame);
    else if (!again)
      go_on(tail, frame);
    switch (state_) {
      case State::one:
        return begins(frame);
      case State::doubtful:
        return follow(frame, new_one || again);
      case State::two:
        break;
    }
    if (frames_ - alternated_ <= kAlone) return Says::left;
    begin(frame.at);
    state_ = State::one;
    return Says::anew;
  }
  // Frames of two devices come.
  [[nodiscard]] bool two() const noexcept { return state_ == State::two; }

 private:
  static constexpr std::size_t kTails = 4;
  static constexpr int kShows = 32, kTurns = 8;  // frames in a row that go on with one of the counts; of
                                                 // those such that change from one to another
  // And of two of the counts so many each: the late frames of one device go on for no longer than they are
  // late by, as the counts behind have come already.
  static constexpr int kGoes = 13;
  static constexpr std::uint64_t kAlive = 256;  // frames in which a count that is there goes on
  static constexpr std::uint64_t kAlone = 512;  // likewise, and the other has gone
  static constexpr std::int64_t kLoses = 8;     // frames that may be missing within a count that is followed
  static constexpr std::size_t kKept = 1024;    // frames of all; by a second way half of them may lie between
  static constexpr std::size_t kEvery = 5;  // of them are looked for among the others: of each count in turn
  static constexpr int kLooks = 64, kOwn = 63;  // looks, of which so many find nothing where they are two
  static constexpr std::uint64_t kBlock = 128;  // frames in which both are counted
  static constexpr int kBlocks = 3;             // in a row
  static constexpr double kTogether = 1.5;      // frames for each that the followed one has gone on
  static constexpr double kMostPolled = 16.0, kOfRound = 0.125, kHeldUp = 0.25;  // times what samples take

  enum class State : std::uint8_t { one, doubtful, two };
  struct Tail {
    std::int64_t at = 0;
    std::uint64_t seen = 0, digest = 0;
    bool used = false;
    int went = 0;  // frames of those in a row that were its own
  };
  // Of the followed one, or of all others.
  struct Looks {
    int looks = 0, own = 0;  // of the last kLooks: that no other count had
    bool is_own = false;     // nearly all of the kLooks before these
  };
  // Of the frames since it began.
  struct Block {
    std::uint64_t frames = 0, of_none = 0;
    double advanced = 0.0;  // samples, of the followed count
    std::int64_t began_ns = 0;
  };

  [[nodiscard]] std::int64_t ahead(std::int64_t from, std::int64_t to) const noexcept {
    const std::int64_t by = to - from;
    return by >= 0 ? by : by + modulus_;
  }

  void begin(std::int64_t at) noexcept {
    tails_ = {};
    tails_[0] = {.at = at, .used = true};
    latest_ = followed_ = 0;
    watching_ = joins_ = false;
  }
  void watch() noexcept {
    if (watching_) return;
    watching_ = true;
    frames_ = alternated_ = 0;
    turns_ = 0;
    followed_ = latest_;
    tails_[latest_].seen = 0;
    tails_[latest_].digest = 0;
  }
  // To which count it belongs: the latest where it goes on with that, else the nearest; kTails: to none.
  [[nodiscard]] std::size_t tail_of(const Frame& frame) const noexcept {
    if (ahead(tails_[latest_].at, frame.at) == 1) return latest_;
    const std::int64_t most = state_ == State::one ? 1 : kLoses;
    std::size_t nearest = kTails;
    std::int64_t least = most + 1;
    for (std::size_t i = 0; i < kTails; ++i) {
      const Tail& tail = tails_[i];
      if (!alive(tail)) continue;
      // The very frame again: of a count that was left half a round ago and more it is one of the next round,
      // where the values do not change.
      const bool lately = frames_ - tail.seen <= static_cast<std::uint64_t>(modulus_) / 2;
      if (lately && tail.at == frame.at && tail.digest == frame.digest) return i;
      const std::int64_t by = ahead(tail.at, frame.at);
      if (by <= 0 || by > most || by > least || (by == least && i != followed_)) continue;
      least = by;
      nearest = i;
    }
    return nearest;
  }
  void open(const Frame& frame) noexcept {
    std::size_t oldest = followed_ == 0 ? 1 : 0;
    for (std::size_t i = 0; i < kTails; ++i) {
      if (state_ == State::doubtful && i == followed_) continue;
      if (!tails_[i].used || (tails_[oldest].used && tails_[i].seen < tails_[oldest].seen)) oldest = i;
    }
    if (state_ == State::one && followed_ == oldest) followed_ = latest_;
    tails_[oldest] = {frame.at, frames_, frame.digest, true, 0};
    latest_ = oldest;
    turns_ = 0;
  }
  void go_on(std::size_t tail, const Frame& frame) noexcept {
    Tail& to = tails_[tail];
    const auto by = static_cast<double>(ahead(to.at, frame.at));
    if (tail != latest_) {
      if (turns_++ == 0) {
        began_ns_ = frame.arrival_ns;
        advanced_ = 0.0;
        in_a_row_ = 0;
        for (Tail& each : tails_) each.went = 0;
      }
      alternated_ = frames_;
    }
    ++in_a_row_;
    advanced_ += by;
    if (tail == followed_) block_.advanced += by;
    to = {frame.at, frames_, frame.digest, true, to.went + 1};
    latest_ = tail;
  }
  // They took no longer than samples do; and, where that is asked, were not held up.
  [[nodiscard]] bool at_their_pace(std::int64_t from_ns, std::int64_t to_ns, double samples,
                                   bool not_held_up) const noexcept {
    if (from_ns <= 0 || to_ns <= 0 || period_s_ <= 0.0) return true;
    const double took_s = static_cast<double>(to_ns - from_ns) * 1e-9, usual_s = samples * period_s_;
    return took_s <= std::min(kMostPolled, kOfRound * static_cast<double>(modulus_)) * usual_s &&
           (!not_held_up || took_s >= kHeldUp * usual_s);
  }
  // Both counts go on as quickly as samples are taken, and do not stand beside each other.
  [[nodiscard]] bool shows(const Frame& frame) const noexcept {
    if (turns_ < kTurns || in_a_row_ < kShows) return false;
    const auto goes = [](const Tail& tail) { return tail.went >= kGoes; };
    if (std::count_if(tails_.begin(), tails_.end(), goes) < 2) return false;
    if (!at_their_pace(began_ns_, frame.arrival_ns, advanced_, false)) return false;
    for (const Tail& a : tails_)
      for (const Tail& b : tails_) {
        if (&a == &b || !alive(a) || !alive(b)) continue;
        if (ahead(a.at, b.at) <= 1) return false;
      }
    return true;
  }
  [[nodiscard]] bool alive(const Tail& tail) const noexcept {
    return tail.used && frames_ - tail.seen <= kAlive;
  }
  Says begins(const Frame& frame) noexcept {
    if (shows(frame)) {
      state_ = State::doubtful;
      looks_ = {};
      came_ = 0;
      blocks_ = 0;
      block_ = {0, 0, 0.0, frame.arrival_ns};
      joins_ = true;
      return follow(frame, false);
    }
    bool others = false;
    for (std::size_t i = 0; i < kTails; ++i) others = others || (i != latest_ && alive(tails_[i]));
    if (!others) begin(tails_[latest_].at);
    return Says::one;
  }
  // Of two counts that which was there first.
  Says follow(const Frame& frame, bool of_none) noexcept {
    const bool first = latest_ == followed_;
    if (!alive(tails_[followed_]) || !counted(frame, of_none)) {
      begin(frame.at);
      state_ = State::one;
      return Says::anew;
    }
    if (of_none) return Says::left;
    compare(frame);
    if (blocks_ >= kBlocks && looks_[0].is_own && looks_[1].is_own) {
      state_ = State::two;
      return Says::left;
    }
    if (!first) return Says::left;
    if (joins_) {
      joins_ = false;
      return Says::anew;
    }
    if (frames_ - alternated_ > kAlive) {
      state_ = State::one;
      begin(frame.at);
    }
    return Says::one;
  }
  // False: what was taken for two counts is one, whose frames came in another order, or with a round between.
  bool counted(const Frame& frame, bool of_none) noexcept {
    ++block_.frames;
    block_.of_none += of_none ? 1 : 0;
    const bool timed = frame.arrival_ns > 0 && block_.began_ns > 0;
    if (block_.frames < kBlock || (timed && frame.arrival_ns == block_.began_ns)) return true;
    const bool two = block_.of_none <= block_.frames / 8 &&
                     static_cast<double>(block_.frames) >= kTogether * block_.advanced &&
                     at_their_pace(block_.began_ns, frame.arrival_ns, block_.advanced, false);
    const bool shown = at_their_pace(block_.began_ns, frame.arrival_ns, block_.advanced, true);
    blocks_ = shown ? blocks_ + 1 : 0;
    block_ = {0, 0, 0.0, frame.arrival_ns};
    return two;
  }
  // Whether what came a while ago is among what another count had before and since.
  void compare(const Frame& frame) noexcept {
    static_assert(kTails == 4);
    constexpr std::uint64_t kOfTail = kTails - 1;
    kept_[came_++ % kKept] = (frame.digest & ~kOfTail) | latest_;
    if (came_ < kKept || came_ % kEvery != 0) return;
    const std::uint64_t sought = kept_[(came_ - kKept / 2) % kKept];
    const bool others = std::any_of(kept_.begin(), kept_.end(), [sought](std::uint64_t one) {
      return one != sought && ((one ^ sought) & ~kOfTail) == 0;
    });
    Looks& looks = looks_[(sought & kOfTail) == followed_ ? 0 : 1];
    if (!others) ++looks.own;
    if (++looks.looks < kLooks) return;
    looks.is_own = looks.own >= kOwn;
    looks.looks = looks.own = 0;
  }

  std::int64_t modulus_;
  double period_s_;
  State state_ = State::one;
  bool watching_ = false;  // more than one count has been seen of late
  bool joins_ = false;     // the followed one is to begin anew: others have been taken in between
  std::array<Tail, kTails> tails_{};
  std::size_t latest_ = 0, followed_ = 0;
  std::uint64_t frames_ = 0, alternated_ = 0;  // since watching_; of them the last that changed the count
  int turns_ = 0, in_a_row_ = 0;               // from one count to another, none other between; frames since
  std::int64_t began_ns_ = 0;                  // of these: when, 0: not known
  double advanced_ = 0.0;                      // of these: samples, of all counts
  Block block_;
  int blocks_ = 0;                           // in a row in which both were counted
  std::array<std::uint64_t, kKept> kept_{};  // digests of frames, and which count they were of
  std::size_t came_ = 0;
  std::array<Looks, 2> looks_{};
};

}  // namespace ifog
