// SPDX-License-Identifier: Apache-2.0
// ifog record: what the daemon publishes, from LCM into flight recordings on this computer, which every
// command reads.
#include <poll.h>
#include <CLI/CLI.hpp>

#include <ifog/decode.h>
#include <cerrno>
#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "drivers/flight/archive.h"
#include "drivers/ifog/quoted.h"
#include "drivers/transport/clock.h"
#include "msgs/channel_name.h"
#include "tools/ifog/captures/lcm_listener.h"
#include "tools/ifog/captures/lcm_loss.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/interrupt.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

struct Options {
  std::string folder, sensor, url = "udpm://239.255.76.67:7667?ttl=0";
  std::vector<std::string> channels;  // others
  double seconds = 0.0;               // 0: until interrupted
  double bytes = 1e9, days = 30.0, file_bytes = 16e6;
};

constexpr int kTurn_ms = 50;

class LcmRecorder {
 public:
  explicit LcmRecorder(const Options& options)
      : options_(options),
        listener_(options.url, [this](const lcm_recv_buf_t& message,
                                      const std::string& channel) { take(message, channel); }),
        archive_(make_flight_folder(options.folder), limits(options), header(options)) {
    listener_.listen_to_sensor(options.sensor);
    for (const std::string& channel : options.channels) listener_.listen_to(channel);
  }

  void run();

 private:
  static ArchiveLimits limits(const Options& options) {
    ArchiveLimits out;
    out.bytes = static_cast<std::uint64_t>(options.bytes);
    out.age_ns = static_cast<std::int64_t>(options.days * 86'400e9);
    out.file_bytes = static_cast<std::uint64_t>(options.file_bytes);
    return out;
  }
  static FlightHeader header(const Options& options) {
    FlightHeader out;
    out.program = IFOG_VERSION;
    out.sensor = options.sensor;
    out.carries = FlightHeader::Carries::messages;
    out.source = options.url;
    return out;
  }
  void take(const lcm_recv_buf_t& buffer, const std::string& channel);
  void add_lost(std::uint64_t messages, std::uint64_t bytes);
  void tell_trouble();

  const Options& options_;
  LcmListener listener_;
  FlightArchive archive_;
  std::map<std::string, LcmLoss> ways_;
  std::vector<std::uint8_t> payload_;
  std::uint64_t messages_ = 0, lost_here_ = 0, lost_here_bytes_ = 0, lost_total_ = 0;
  bool troubled_ = false;
};

void LcmRecorder::add_lost(std::uint64_t messages, std::uint64_t bytes) {
  const std::uint64_t lost[2] = {messages, bytes};
  archive_.add({FlightKind::lost, 0, 0, 0, realtime_ns()},
               {reinterpret_cast<const std::uint8_t*>(lost), sizeof lost});
}

void LcmRecorder::take(const lcm_recv_buf_t& buffer, const std::string& channel) {
  ++messages_;
  payload_.assign(channel.begin(), channel.end());
  const auto* const data = static_cast<const std::uint8_t*>(buffer.data);
  payload_.insert(payload_.end(), data, data + buffer.data_size);
  if (archive_.full()) archive_.turn(arrival_clock_ns(), realtime_ns());
  if (archive_.full() || payload_.size() > kMostFlightPayload) {
    ++lost_here_;
    ++lost_total_;
    lost_here_bytes_ += buffer.data_size;
    return;
  }
  if (lost_here_ > 0) add_lost(std::exchange(lost_here_, 0), std::exchange(lost_here_bytes_, 0));
  rate_t rate{};
  if (channel_name(channel).content == ChannelContent::rate &&
      decode_message(buffer.data, buffer.data_size, rate))
    if (const std::int64_t missing = ways_[channel].take(rate); missing > 0)
      add_lost(static_cast<std::uint64_t>(missing), 0);
  archive_.add(
      {FlightKind::message, 0, static_cast<std::uint16_t>(channel.size()), 0, buffer.recv_utime * 1000},
      payload_);
}

// Once when it begins, once when it is over.
void LcmRecorder::tell_trouble() {
  const int error = archive_.error();
  if ((error != 0) == troubled_) return;
  troubled_ = error != 0;
  if (troubled_)
    warn("%s: %s; nothing is recorded until it takes more\n", options_.folder.c_str(),
         archive_.complaint().c_str());
  else
    warn("%s: all is recorded again, %llu messages were lost\n", options_.folder.c_str(),
         static_cast<unsigned long long>(lost_total_));
}

void LcmRecorder::run() {
  catch_interrupts();
  const std::int64_t start_ns = monotonic_ns();
  const auto end_ns = start_ns + static_cast<std::int64_t>(options_.seconds * 1e9);
  pollfd wanted{listener_.descriptor(), POLLIN, 0};
  while (!interrupted() && (options_.seconds <= 0.0 || monotonic_ns() < end_ns)) {
    if (poll(&wanted, 1, kTurn_ms) > 0) listener_.take();
    archive_.turn(arrival_clock_ns(), realtime_ns());
    tell_trouble();
  }
  if (lost_here_ > 0) add_lost(lost_here_, lost_here_bytes_);
  const std::uint64_t unwritten = archive_.close(arrival_clock_ns(), realtime_ns());
  std::int64_t on_the_way = 0, anew = 0;
  for (const auto& [channel, way] : ways_) {
    on_the_way += way.lost();
    anew += way.began_anew();
  }
  say("%s: %llu messages, %llu bytes written, %llu lost here, %lld lost on LCM\n", options_.folder.c_str(),
      static_cast<unsigned long long>(messages_), static_cast<unsigned long long>(archive_.bytes_written()),
      static_cast<unsigned long long>(lost_total_) + unwritten, static_cast<long long>(on_the_way));
  if (anew > 0)
    warn(
        "%s: %lld times a message's seq was beyond what its sensor can have counted: taken for a new count\n",
        options_.folder.c_str(), static_cast<long long>(anew));
  if (messages_ == 0) {
    warn("ifog record: nothing heard on %s\n", printable(options_.url).c_str());
    throw Failed("nothing heard");
  }
  if (archive_.error() != 0) throw std::runtime_error(options_.folder + ": " + archive_.complaint());
}

}  // namespace

void add_record(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("record", "Record what the daemon publishes on LCM, for every command to read");
  auto options = std::make_shared<Options>();
  command->add_option("--output", options->folder, "Folder of the recordings; made if it is not there")
      ->required()
      ->type_name("FOLDER");
  command->add_option("--sensor", options->sensor, "Only this sensor")->type_name("NAME");
  command
      ->add_option("--lcm-channel", options->channels,
                   "Another LCM channel beside, with ifog.channel_t; may stand several times")
      ->type_name("NAME");
  command->add_option("--seconds", options->seconds, "Stop after this long")->check(CLI::PositiveNumber);
  command->add_option("--bytes", options->bytes, "Keep no more than this; the oldest goes")
      ->check(CLI::Range(1e6, 1e15))
      ->capture_default_str();
  command->add_option("--days", options->days, "Keep nothing older")
      ->check(CLI::Range(1e-3, 1e5))
      ->capture_default_str();
  command
      ->add_option("--file-bytes", options->file_bytes,
                   "End a file at this size, at most a quarter of --bytes")
      ->check(CLI::Range(1e5, 1e9))
      ->capture_default_str();
  command->add_option("--lcm-url", options->url, "As in the daemon's configuration")->type_name("URL");
  command->callback([options] {
    if (options->file_bytes > options->bytes / 4.0)
      throw CLI::ValidationError("--file-bytes",
                                 "is more than a quarter of --bytes, expected room for four files");
    LcmRecorder(*options).run();
  });
}

}  // namespace ifog::tools
