// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/lcm/lcm_log.h"

#include <ifog/decode.h>

#include <optional>
#include <set>

#include "drivers/ifog/quoted.h"
#include "tools/ifog/captures/lcm/lcm_events.h"
#include "tools/ifog/console/errors.h"

namespace ifog::tools {
namespace {

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
  std::string list;
  for (const std::string& each : found) list += (list.empty() ? "" : ", ") + printable(each);
  throw refusal("{}: several channels carry bytes, expected --channel with one of {}", path, list);
}

}  // namespace

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
