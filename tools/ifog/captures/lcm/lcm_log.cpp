// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/lcm/lcm_log.h"

#include <ifog/decode.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/times/time_stamps.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/utc_now.h"
#include "msgs/channel_name.h"
#include "msgs/in_order.h"
#include "tools/ifog/captures/lcm/lcm_channels.h"
#include "tools/ifog/captures/lcm/lcm_events.h"
#include "tools/ifog/captures/lcm/lcm_loss.h"
#include "tools/ifog/captures/lcm/peer_reader.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

bool carries_rates(const std::string& channel) {
  return channel_name(channel).content == ChannelContent::rate;
}

// A log and its channel of rates: the requested one, or else the first with our rates, or else the first with
// a supported type of another program. Without a request it must be the only one (look_through).
struct ChosenLog {
  ChosenLog(InputFile& file, const std::string& channel)
      : path(file.path()), source(file), asked_for(!channel.empty()), rates(channel) {
    std::string bytes;
    LcmEvents log(source.name());
    while (const LcmEvents::Event* event = log.next()) {
      const bool wanted = asked_for ? event->channel == channel : carries_rates(event->channel);
      const PeerType* const type = peer_type(event->data);
      if (wanted || (rates.empty() && type != nullptr)) {
        rates = event->channel;
        peer = type != nullptr ? std::optional<PeerReader>(*type) : std::nullopt;
      }
      if (wanted) return;
      if (bytes.empty() && carries_bytes(event->data)) bytes = event->channel;
    }
    if (!rates.empty()) return;
    if (bytes.empty())
      throw refusal("{}: has no channel IFOG_<NAME>, and none with rates of another program's type", path);
    throw refusal("{}: has bytes of a device on {}, expected --driver NAME to decode them with", path,
                  printable(bytes));
  }
  std::string path;
  NamedLog source;
  bool asked_for;
  std::string rates;
  std::optional<PeerReader> peer;  // set if the messages are not ifog.rate_t
};

constexpr std::int64_t kLeap_ns = 1'000'000'000;  // of one clock, beyond the others

// Limit of received times, so that differences do not overflow: 146 years.
constexpr std::int64_t kMostTime_ns = std::numeric_limits<std::int64_t>::max() / 2;

bool times_can_be(const rate_t& message) {
  return std::abs(message.utime / 1000) < kMostTime_ns / 1'000'000 &&
         std::abs(message.sensor_time_ns / 2) < kMostTime_ns / 2 && message.seq >= 0 &&
         message.seq / 2 < kMostTime_ns / 2;
}

// Time from the sensor's clock if it has one, from the first message. Where that clock restarted, was set or leaps alone,
// the message's own step continues it, or the fitted time if that says that messages before this one are missing.
class SensorSeconds {
 public:
  // Later than the previous one; -1 if neither clock advances.
  double of(const rate_t& message) {
    const std::int64_t fitted_ns = message.utime * 1000;
    const bool sensor = message.sensor_time_ns != -1, set = (message.flags & rate_t::FLAG_CLOCK_STEP) != 0;
    const std::int64_t now_ns = sensor ? message.sensor_time_ns : fitted_ns;
    const std::int32_t own =
        sensor ? std::int32_t{rate_t::FLAG_SENSOR_CLOCK_SET} : std::int32_t{rate_t::FLAG_CLOCK_STEP};
    std::int64_t step_ns = now_ns - last_ns_;
    const std::int64_t fitted_step_ns = set ? 0 : fitted_ns - last_fitted_ns_, told_ns = step_of(message);
    const bool leaps = told_ns > 0 && step_ns > kLeap_ns + std::max(told_ns, fitted_step_ns);
    if (started_ && (step_ns <= 0 || leaps || sensor != sensor_ || (message.flags & own) != 0))
      step_ns = fitted_step_ns > told_ns + told_ns / 2 ? fitted_step_ns : told_ns;
    if (!std::exchange(started_, true))
      step_ns = 0;
    else if (step_ns <= 0 || step_ns > kMostTime_ns - elapsed_ns_)
      return -1.0;
    elapsed_ns_ += step_ns;
    sensor_ = sensor;
    last_ns_ = now_ns;
    last_fitted_ns_ = fitted_ns;
    last_seq_ = message.seq;
    return static_cast<double>(elapsed_ns_) / 1e9;
  }

 private:
  // 0: unknown.
  [[nodiscard]] std::int64_t step_of(const rate_t& message) const {
    const bool known = message.seq > last_seq_ && message.dt > 0.0 && message.dt < 1e9;
    return known ? std::llround(message.dt * 1e9) : 0;
  }
  bool started_ = false, sensor_ = false;  // sensor_: the last time was by its clock
  std::int64_t elapsed_ns_ = 0, last_ns_ = 0, last_fitted_ns_ = 0, last_seq_ = 0;
};

// Three axes are x, y, z, because messages do not name them.
std::vector<std::string> axis_names(std::size_t axes) {
  std::vector<std::string> names{"x", "y", "z"};
  names.resize(std::min(names.size(), axes));
  return axes == 1 ? std::vector<std::string>{""} : names;
}

std::string one_of(const std::set<std::string>& channels) {
  return "expected --channel with one of " + printable(boost::join(channels, ", "), kLongestMessage);
}

using RateSink = std::function<void(const MeasuredRate&, double)>;
using OtherSink = std::function<void(const std::string&, std::span<const std::uint8_t>)>;

// Passes each message of the channel to `sink` with its time in s since the first, and all others to `others`
// unless that is empty. Times increase; messages that are not later are dropped and reported.
void for_each_rate(ChosenLog& chosen, const RateSink& sink, const OtherSink& others) {
  const std::string &path = chosen.path, &wanted = chosen.rates;
  LcmEvents log(chosen.source.name());
  std::size_t number = 0, axes = 0, left_out = 0;
  Fault damaged;
  SensorSeconds seconds;
  InOrder<MeasuredRate> order;
  LcmLoss way;
  const auto hand_on = [&](const MeasuredRate& message) {
    const double time_s = seconds.of(message);
    if (time_s >= 0.0) return sink(message, time_s);
    ++left_out;
  };
  Progress progress("reading " + std::filesystem::path(path).filename().string(), log.size());
  while (const LcmEvents::Event* event = log.next()) {
    ++number;
    progress.at(log.at());
    if (event->channel != wanted) {
      if (others) others(event->channel, event->data);
      continue;
    }
    const auto drop = [&](const std::string& why) {
      damaged.add(number, "message " + std::to_string(number) + " on " + wanted + " " + why);
    };
    const auto take = [&](MeasuredRate&& message) {
      const std::size_t here = message.raw.size();
      if (here == 0 || here > 3) return drop("has " + std::to_string(here) + " axes, expected 1 to 3");
      if (axes != 0 && here != axes) return drop("has another number of axes");
      if (!times_can_be(message)) return drop("has a time or number that cannot be");
      axes = here;
      way.take(message);
      order.take(std::move(message), hand_on);
    };
    if (chosen.peer) {
      if (!chosen.peer->take(event->data, take))
        drop("is no " + std::string(chosen.peer->type().name) + " that can be");
      continue;
    }
    if (MeasuredRate message; decode_message<rate_t>(event->data, message))
      take(std::move(message));
    else
      drop("is no ifog.rate_t of this version");
  }
  if (kRowsAFault * damaged.count > number) throw refusal("{}: {}", path, damaged.first);
  if (damaged.count > 0)
    warn("{}: {}; {}\n", path, damaged.first,
         damaged.count == 1 ? "it is dropped" : std::to_string(damaged.count) + " such messages are dropped");
  order.flush(hand_on);
  if (way.had_two_publishers()) warn("{}: {}\n", path, two_publishers_sent_on(printable(wanted)));
  if (axes == 0) throw refusal("{}: has no message on channel {}", path, wanted);
  if (way.lost() > 0)
    warn("{}: {} samples on {} are missing by their counts ({} lost them)\n", path, way.lost(),
         printable(wanted), chosen.peer ? "the sensor, its driver or LCM" : "LCM or the recorder");
  if (left_out > 0)
    warn(
        "{}: {} messages on {} came twice or after one that follows, and are dropped (two recorders wrote "
        "at once, or a clock was set back)\n",
        path, left_out, printable(wanted));
  log.say_damage(path);
}

// First pass over a log, for the channels besides the rates. Throws std::runtime_error with one line if
// several channels have rates and none was requested.
void look_through(ChosenLog& chosen, LcmChannels& channels) {
  std::set<std::string> with_rates;
  LcmEvents log(chosen.source.name());
  Progress progress("looking through " + std::filesystem::path(chosen.path).filename().string(), log.size());
  while (const LcmEvents::Event* event = log.next()) {
    progress.at(log.at());
    if (event->channel == chosen.rates) {
      channels.saw_row();
      if (chosen.peer) chosen.peer->look_at(event->data);
      continue;
    }
    const bool others_rates = chosen.peer ? peer_type(event->data) != nullptr : carries_rates(event->channel);
    if (!chosen.asked_for && others_rates) with_rates.insert(event->channel);
    channels.look_at(event->channel, event->data);
  }
  if (with_rates.empty()) return;
  with_rates.insert(chosen.rates);
  throw refusal("{}: has several channels, {}", chosen.path, one_of(with_rates));
}

// Prints the date of t = 0, which the times do not contain.
void tell_start(const std::string& path, const rate_t& first) {
  const TimeOrigin origin = TimeOrigin::of(first.utime * 1000);
  if (origin == TimeOrigin{}) return;
  warn("{}: t = 0 is {}, the first message\n", path, utc_text(origin.s, "%Y-%m-%d %H:%M:%S UTC"));
}

using Bytes = std::span<const std::uint8_t>;

struct Piece {
  std::int64_t utime = 0;  // µs since the epoch
  Bytes bytes;             // valid until the next call
};

class PieceReader {
 public:
  // nullopt: another type, or damaged.
  std::optional<Piece> read(Bytes message) {
    if (type_hash(message) == senlcm::raw_t::getHash() && decode_message(message, raw_))
      return Piece{raw_.utime, raw_.data};
    if (type_hash(message) != senlcm::raw_ascii_t::getHash() || !decode_message(message, line_))
      return std::nullopt;
    // Some publishers omit the end of the line.
    if (!line_.msg.ends_with('\n') && !line_.msg.ends_with('\r')) line_.msg += '\n';
    return Piece{line_.utime, {reinterpret_cast<const std::uint8_t*>(line_.msg.data()), line_.msg.size()}};
  }

 private:
  senlcm::raw_t raw_;
  senlcm::raw_ascii_t line_;
};

// Throws std::runtime_error with one line unless exactly one channel has bytes.
std::string only_channel(const NamedLog& source, const std::string& path) {
  std::set<std::string> found;
  LcmEvents log(source.name());
  while (const LcmEvents::Event* event = log.next())
    if (carries_bytes(event->data)) found.insert(event->channel);
  if (found.size() == 1) return *found.begin();
  if (found.empty())
    throw refusal(
        "{}: no channel carries bytes of a device (senlcm.raw_t, bot_core.raw_t, senlcm.raw_ascii_t), "
        "expected none of --driver and --dbc",
        path);
  throw refusal("{}: several channels carry bytes, {}", path, one_of(found));
}

}  // namespace

void read_lcm_log(InputFile& file, const std::string& channel, RowSink& sink) {
  ChosenLog chosen(file, channel);
  LcmChannels channels(chosen.rates);
  look_through(chosen, channels);
  std::vector<std::string> extra = chosen.peer ? chosen.peer->extra_columns() : std::vector<std::string>();
  const std::vector<std::string> others = channels.settle(extra);
  extra.insert(extra.end(), others.begin(), others.end());
  RowBatch rows(sink);
  std::vector<double> values;
  for_each_rate(
      chosen,
      [&](const MeasuredRate& message, double time_s) {
        if (!rows.begun()) {
          tell_start(chosen.path, message);
          std::vector<std::string> names;
          for (const std::string& axis : axis_names(message.raw.size()))
            names.push_back(of_axis("rate", axis) + "_radps");
          names.insert(names.end(), extra.begin(), extra.end());
          rows.begin(names);
        }
        values = message.raw;
        values.insert(values.end(), message.extra.begin(), message.extra.end());
        channels.end_row(values);
        rows.add(time_s, values);
      },
      [&](const std::string& name, std::span<const std::uint8_t> message) { channels.take(name, message); });
  rows.hand_on();
}

void read_published(InputFile& file, const std::string& channel, RowSink& sink) {
  ChosenLog chosen(file, channel);
  if (chosen.peer)
    throw refusal("{}: {} carries {}, expected --channel with one that carries ifog.rate_t", chosen.path,
                  printable(chosen.rates), chosen.peer->type().name);
  LcmChannels unused(chosen.rates);
  if (!chosen.asked_for) look_through(chosen, unused);
  RowBatch rows(sink);
  double time_s = 0.0;
  std::vector<double> values;
  const auto take = [&](const rate_t& message, double) {
    if (!rows.begun()) {
      std::vector<std::string> names;
      for (const std::string& axis : axis_names(message.raw.size()))
        for (const std::string what : {"raw", "compensated", "denoised", "variance"})
          names.push_back(of_axis(what, axis) + (what == "variance" ? "_rad2ps2" : "_radps"));
      rows.begin(names);
    } else {
      time_s += message.dt;  // the sensor's time even if a recording was played faster
    }
    values.clear();
    for (std::size_t i = 0; i < message.raw.size(); ++i)
      values.insert(values.end(),
                    {message.raw[i], message.compensated[i], message.denoised[i], message.variance[i]});
    rows.add(time_s, values);
  };
  for_each_rate(chosen, take, {});
  rows.hand_on();
}

bool carries_bytes(Bytes message) {
  const std::int64_t hash = type_hash(message);
  return hash == senlcm::raw_t::getHash() || hash == senlcm::raw_ascii_t::getHash();
}

RecordingCounts decode_logged_bytes(InputFile& file, DriverInstance& driver, const std::string& channel,
                                    const std::function<void(const ifog_sample&)>& sink) {
  const std::string path = file.path();
  if (!driver.takes_bytes())
    throw refusal("{}: is an LCM log, and this driver takes CAN frames, not bytes", path);
  constexpr std::int64_t kMost_us = std::int64_t{1} << 53U;  // beyond any date, and representable in ns
  const NamedLog source(file);
  const std::string wanted = channel.empty() ? only_channel(source, path) : channel;
  RecordingCounts counts;
  PieceReader reader;
  std::size_t number = 0;
  LcmEvents log(source.name());
  while (const LcmEvents::Event* event = log.next()) {
    ++number;
    if (event->channel != wanted) continue;
    const std::optional<Piece> piece = reader.read(event->data);
    if (!piece || piece->utime < 0 || piece->utime > kMost_us)
      throw refusal(
          "{}: message {} on {} is no senlcm.raw_t, bot_core.raw_t or senlcm.raw_ascii_t that can be", path,
          number, printable(wanted));
    driver.decode_bytes(piece->bytes, piece->utime * 1000, [&](const ifog_sample& sample) {
      ++counts.samples;
      sink(sample);
    });
  }
  log.say_damage(path);
  finish_recording(driver, counts);
  return counts;
}

}  // namespace ifog::tools
