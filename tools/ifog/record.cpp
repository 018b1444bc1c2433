// SPDX-License-Identifier: Apache-2.0
// ifog record: writes the daemon's LCM messages into flight recordings, which every command reads.
#include <poll.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/flight/folder.h"
#include "drivers/flight/header.h"
#include "drivers/ifog/quoted.h"
#include "drivers/transport/clock.h"
#include "tools/ifog/captures/lcm/lcm_listener.h"
#include "tools/ifog/captures/lcm/message_archive.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/command.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

struct RecordOptions {
  std::string folder, sensor, url = "udpm://239.255.76.67:7667?ttl=0";
  std::vector<std::string> channels;  // further ones
  double seconds = 0.0;               // 0: until interrupted
  double bytes = 1e9, days = 30.0, file_bytes = 16e6;
};

ArchiveLimits limits(const RecordOptions& options) {
  ArchiveLimits out;
  out.bytes = static_cast<std::uint64_t>(options.bytes);
  out.age_ns = static_cast<std::int64_t>(options.days * 86'400e9);
  out.file_bytes = static_cast<std::uint64_t>(options.file_bytes);
  return out;
}

FlightHeader header(const RecordOptions& options) {
  FlightHeader out;
  out.program = IFOG_VERSION;
  out.sensor = options.sensor;
  out.carries = FlightHeader::Carries::messages;
  out.source = options.url;
  return out;
}

// Reports a disk error once, and its end once.
void tell_trouble(const MessageArchive& messages, const std::string& folder, bool& troubled) {
  if ((messages.archive().error() != 0) == troubled) return;
  troubled = !troubled;
  if (troubled)
    warn("{}: {}; nothing is recorded until it takes more\n", folder, messages.archive().complaint());
  else
    warn("{}: all is recorded again, {} messages were lost\n", folder, messages.books().lost_here);
}

void tell_books(const MessageArchive& messages, const std::string& folder) {
  const MessageArchive::Books books = messages.books();
  say("{}: {} messages, {} bytes written, {} lost here, {} lost on LCM\n", folder, books.received,
      messages.archive().bytes_written(), books.lost_here, books.lost_on_way);
  if (!books.two_publishers.empty()) warn("{}: {}\n", folder, two_publishers_sent_on(books.two_publishers));
  if (books.restarts > 0)
    warn(
        "{}: {} times a message's seq was beyond what its sensor can have counted: treated as a new "
        "count\n",
        folder, books.restarts);
}

void record(const RecordOptions& options) {
  constexpr int kTurn_ms = 50;
  std::optional<MessageArchive> archive;
  // Before the folder is made, because a wrong address is refused here.
  LcmListener listener(options.url, [&](const lcm_recv_buf_t& buffer, const std::string& channel) {
    archive->take(channel, {static_cast<const std::uint8_t*>(buffer.data), buffer.data_size},
                  buffer.recv_utime, arrival_clock_ns(), realtime_ns());
  });
  MessageArchive& messages =
      archive.emplace(make_flight_folder(options.folder), limits(options), header(options));
  // Before listening, because until then another recorder may own the folder.
  messages.open(arrival_clock_ns(), realtime_ns());
  listener.listen_to_sensor(options.sensor);
  for (const std::string& channel : options.channels) listener.listen_to(channel);
  catch_interrupts();
  const auto end_ns = monotonic_ns() + static_cast<std::int64_t>(options.seconds * 1e9);
  pollfd wanted{listener.descriptor(), POLLIN, 0};
  for (bool troubled = false; !interrupted() && (options.seconds <= 0.0 || monotonic_ns() < end_ns);) {
    if (poll(&wanted, 1, kTurn_ms) > 0) listener.take();
    messages.turn(arrival_clock_ns(), realtime_ns());
    tell_trouble(messages, options.folder, troubled);
  }
  messages.close(arrival_clock_ns(), realtime_ns());
  tell_books(messages, options.folder);
  if (messages.books().received == 0) {
    warn("ifog record: nothing heard on {}\n", printable(options.url));
    throw Failed("nothing heard");
  }
  if (messages.archive().error() != 0)
    throw refusal("{}: {}", options.folder, messages.archive().complaint());
}

}  // namespace

void add_record(const Command& program) {
  const Command command =
      program.add_subcommand("record", "Record what the daemon publishes on LCM, for every command to read");
  auto options = std::make_shared<RecordOptions>();
  command.add_option("-o,--output", options->folder, "Folder of the recordings; made if it is not there",
                     {.required = true, .type = "FOLDER"});
  command.add_option("--sensor", options->sensor, "Only this sensor");
  command.add_option("--lcm-channel", options->channels,
                     "Another LCM channel, with ifog.channel_t; may stand several times", {.type = "NAME"});
  command.add_option("--seconds", options->seconds, "Stop after this long", {.range = within(1e-3, 1e9)});
  command.add_option("--bytes", options->bytes, "Keep no more than this; the oldest goes",
                     {.shows_default = true, .range = within(1e6, 1e15)});
  command.add_option("--days", options->days, "Keep nothing older",
                     {.shows_default = true, .range = within(1e-3, 1e5)});
  command.add_option("--file-bytes", options->file_bytes,
                     "End a file at this size, at most a quarter of --bytes",
                     {.shows_default = true, .range = within(1e5, 1e9)});
  command.add_option("--lcm-url", options->url, "As in the daemon's configuration", {.type = "URL"});
  command.callback([options] {
    if (options->file_bytes > options->bytes / 4.0)
      throw WrongUsage("--file-bytes", "is more than a quarter of --bytes, expected room for four files");
    record(*options);
  });
}

}  // namespace ifog::tools
