// SPDX-License-Identifier: Apache-2.0
// A cable that is pulled again and again, as at a loose connector: the gyro measures on, and every sample
// that nobody got is to be counted, whatever the counter shows of it and however promptly the line delivers.
#include "drivers/timeline/timeline.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

struct Cable {
  std::int64_t modulus = 128;  // of the gyro's counter
  double rate_hz = 200.0;
  double jitter_s = 0.0;  // between sampling and arrival, evenly from 0
  double untimed = 0.0;   // share of openings whose first frame had waited, so that its arrival is not known
  std::int64_t begins = 0;  // the first frame's number
};

class Gyro {
 public:
  Gyro(const Cable& cable, std::uint64_t seed)
      : cable_(cable),
        random_(seed),
        sample_(cable.begins),
        timeline_(static_cast<std::uint64_t>(cable.modulus), cable.rate_hz) {}

  // Frames at once behind each other; opened: the first is behind an opening.
  void send(int frames, bool opened) {
    for (int i = 0; i < frames; ++i, ++sample_) {
      const double value = 0.1 * std::sin(0.0157 * static_cast<double>(sample_)), at_s = arrival_s();
      Timeline::Frame frame;
      frame.counts = true;
      frame.sequence = static_cast<std::uint32_t>(sample_ % cable_.modulus);
      frame.reopened = opened && i == 0;
      const bool untimed = frame.reopened && even_(random_) < cable_.untimed;
      frame.arrival_ns = untimed ? 0 : static_cast<std::int64_t>(at_s * 1e9);
      frame.values = {&value, 1};
      if (sample_ == cable_.begins) {
        timeline_.first(frame);
        continue;
      }
      const Timeline::Step step = timeline_.next(frame);
      ASSERT_FALSE(step.out_of_turn || step.restarted) << "sample " << sample_;
      told_ += static_cast<std::int64_t>(step.samples) - 1;
    }
  }
  void unheard(std::int64_t samples) {
    sample_ += samples;
    lost_ += samples;
  }
  // What comes next is late by so much, and what is behind it comes at once.
  void held_up(double late_s) { latest_s_ = 1.0 + static_cast<double>(sample_) / cable_.rate_hz + late_s; }
  [[nodiscard]] std::int64_t told() const { return told_; }
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  [[nodiscard]] std::int64_t between(std::int64_t least, std::int64_t most) {
    return std::uniform_int_distribution<std::int64_t>(least, most)(random_);
  }

 private:
  double arrival_s() {
    const double due_s =
        1.0 + static_cast<double>(sample_) / cable_.rate_hz + cable_.jitter_s * even_(random_);
    return latest_s_ = std::max(due_s, latest_s_ + 1e-6);
  }

  Cable cable_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> even_{0.0, 1.0};
  std::int64_t sample_, told_ = 0, lost_ = 0;
  double latest_s_ = 0.0;
  Timeline timeline_;
};

// As an emulated computer did: half a second of silence on an open line, whose first delivery was 45 ms late.
TEST(PausedCable, ALateDeliveryBehindASilenceIsNoRestart) {
  Gyro gyro({.jitter_s = 0.001}, 5);
  gyro.send(4000, false);
  for (int pause = 0; pause < 20; ++pause) {
    gyro.unheard(100);
    gyro.held_up(0.045);
    gyro.send(600, false);
  }
  EXPECT_EQ(gyro.told(), gyro.lost());
}

TEST(PulledCable, AgainAndAgainIsCountedWhole) {
  for (const Cable& cable :
       {Cable{128, 200.0, 0.001, 0.0, 0}, Cable{128, 200.0, 0.001, 0.3, 17}, Cable{128, 200.0, 0.005, 0.3, 0},
        Cable{128, 200.0, 0.02, 0.0, 90}, Cable{128, 200.0, 0.02, 0.3, 1000}, Cable{128, 200.0, 0.05, 0.3, 0},
        Cable{128, 1000.0, 0.002, 0.3, 5}, Cable{16, 50.0, 0.01, 0.3, 9}, Cable{256, 50.0, 0.01, 0.0, 0},
        Cable{65536, 1000.0, 0.01, 0.3, 0}}) {
    SCOPED_TRACE(testing::Message() << "of " << cable.modulus << " at " << cable.rate_hz << " Hz within "
                                    << cable.jitter_s << " s, untimed " << cable.untimed);
    Gyro gyro(cable, 5);
    const int second = static_cast<int>(cable.rate_hz);
    gyro.send(second, false);
    for (int pull = 0; pull < 100; ++pull) {
      // A third of the losses are whole rollovers, which the counter does not show.
      const std::int64_t lost = gyro.between(second, 3 * second), round = cable.modulus;
      gyro.unheard(pull % 3 == 0 ? (lost / round + 1) * round - 1 : lost);
      gyro.send(second, true);
    }
    gyro.send(10 * second, false);
    EXPECT_EQ(gyro.told(), gyro.lost());
  }
}

}  // namespace
}  // namespace ifog
