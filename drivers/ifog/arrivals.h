// SPDX-License-Identifier: Apache-2.0
// What the times of arrival say of the time that a device counts: how much has passed, and whether what it
// claims can be.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace ifog {

// Between two times, whatever a device says: what has no room wraps, and is a clock that jumps.
inline std::int64_t ns_between(std::int64_t from_ns, std::int64_t to_ns) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(to_ns) - static_cast<std::uint64_t>(from_ns));
}
// So much later, or as late as there is room for.
inline std::int64_t ns_after(std::int64_t time_ns, std::int64_t by_ns) noexcept {
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min(),
                         kMost = std::numeric_limits<std::int64_t>::max();
  if (by_ns > 0 && time_ns > kMost - by_ns) return kMost;
  if (by_ns < 0 && time_ns < kLeast - by_ns) return kLeast;
  return time_ns + by_ns;
}

class Arrivals {
 public:
  void forget() noexcept { known_ns_ = 0; }
  [[nodiscard]] bool known() const noexcept { return known_ns_ > 0; }
  [[nodiscard]] std::int64_t latest_ns() const noexcept { return known_ns_; }
  // From the sample before to one that arrives then; negative: not known. Where the arrival of the one before
  // is not known, from the latest that is, less what has been counted since.
  [[nodiscard]] double elapsed_s(std::int64_t arrival_ns) const noexcept {
    if (arrival_ns <= 0 || !known()) return -1.0;
    return std::max(0.0, static_cast<double>(arrival_ns - known_ns_) * 1e-9 - counted_s_);
  }
  // 0: not known when. step_s: counted since the sample before.
  void came(std::int64_t arrival_ns, double step_s) noexcept {
    if (arrival_ns > 0) known_ns_ = arrival_ns;
    counted_s_ = arrival_ns > 0 ? 0.0 : counted_s_ + step_s;
  }

 private:
  std::int64_t known_ns_ = 0;  // latest that is known; 0: none yet
  double counted_s_ = 0.0;     // steps since then
};

// Of what goes round, a counter or a clock: whole rounds in a time by arrival that it does not account for; 0
// where no number of them fits it. slack_s: to what the times are known. Rounds that are hardly longer than
// what times of arrival scatter by fit any time: of those only one that no delivery takes says that there
// were some, and how many to a round.
inline double whole_rounds(double spare_s, double round_s, double slack_s, double scatter_s) noexcept {
  constexpr double kTells = 0.25;  // of a round: so well times are to be known that tell rounds
  constexpr double kNoDelivery_s = 1.0;
  const double rounds = std::floor(spare_s / round_s + 0.5), tells_s = kTells * round_s;
  if (!(rounds >= 1.0 && rounds <= 1e12)) return 0.0;
  if (slack_s >= tells_s && spare_s >= kNoDelivery_s) return rounds;
  if (scatter_s > tells_s) return 0.0;
  return std::abs(spare_s - rounds * round_s) <= std::min(slack_s, tells_s) ? rounds : 0.0;
}

// A sample that is read as it comes is read within this: an adapter collects for 16 ms, a thread waits its
// turn.
inline constexpr double kPrompt_s = 0.05;
inline constexpr double kAdapter_s = 0.02;

// A step of counter or clock that exceeds the time by arrival by so much is a restart of the device.
inline bool restarted(double claimed_s, double elapsed_s) noexcept {
  return claimed_s > 1.5 * elapsed_s + 10.0;
}

// Of a sample that came: it has taken a period at least.
inline std::uint64_t at_least_one(double samples) noexcept {
  return samples >= 1.5 ? static_cast<std::uint64_t>(std::llround(std::min(samples, 1e18))) : 1;
}

}  // namespace ifog
