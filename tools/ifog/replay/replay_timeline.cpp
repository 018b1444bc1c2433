// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/replay/replay_timeline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "drivers/capture/candump/candump.h"
#include "drivers/capture/capture_encoder.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/recording.h"
#include "drivers/capture/times/sample_times.h"
#include "tools/ifog/captures/flight/flight_input.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

bool plugin_is_there(const std::string& name) {
  try {
    return find_plugin(name, plugin_folders()) != nullptr;
  } catch (const std::runtime_error&) {
    return false;
  }
}

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

FileKind kind_of(const ReplaySource& source, const InputFile& file) {
  if (source.format == "candump") return FileKind::candump;
  if (source.format == "bytes") return FileKind::bytes;
  if (source.format == "csv") return FileKind::capture;
  if (source.input.has_layout()) return FileKind::capture;
  const FileKind found = file_kind(file);
  // Text of a sensor (DSP-3000) is not recognised by its content.
  const bool described = source.input.has_driver() || source.block_bytes != 0;
  return found == FileKind::unknown && described ? FileKind::bytes : found;
}

ReplayTimeline from_candump(const ReplaySource& source, InputFile& file) {
  ReplayTimeline timeline;
  // A log keeps the frames of each interface, another interface mixes them.
  const CandumpLosses lost = for_each_candump_frame(
      file, source.input.channel, [&](const ifog_can_frame&) { return source.prefer_can; },
      [&](const ifog_can_frame& frame, std::string_view from) {
        auto found = std::ranges::find(timeline.interfaces, from);
        if (found == timeline.interfaces.end()) found = timeline.interfaces.emplace(found, from);
        const auto number = found - timeline.interfaces.begin();
        if (number > std::numeric_limits<std::uint16_t>::max())
          throw std::runtime_error("more than 65535 interfaces, this is no candump log");
        timeline.frames.push_back(frame);
        timeline.on.push_back(static_cast<std::uint16_t>(number));
      });
  if (lost.remote + lost.error > 0)
    warn("{}: {} remote and {} error frames are not sent\n", source.path, lost.remote, lost.error);
  if (lost.cut_off) warn("{}: the last line is no whole frame and is not sent\n", source.path);
  if (file.ends_early())
    warn("{}: the gzip stream ends early (truncated file); what is there is sent\n", source.path);
  return timeline;
}

// Cuts blocks of a given size at a given rate.
void cut_evenly(const ReplaySource& source, ReplayTimeline& timeline) {
  for (std::size_t end = 0; end < timeline.bytes.size();) {
    end = std::min(end + source.block_bytes, timeline.bytes.size());
    timeline.blocks.push_back(
        {nanoseconds(static_cast<double>(timeline.blocks.size()) / source.rate_hz), end});
  }
}

// Cuts blocks at the ends of samples, at the device's time or by its counter and the nominal rate.
void cut_by_driver(const ReplaySource& source, ReplayTimeline& timeline) {
  DriverInstance driver = source.input.make_driver();
  const ifog_description& d = driver.description();
  timeline.baud = d.baud;
  if (!driver.takes_bytes())
    throw refusal("{}: driver {} takes no bytes", source.path, source.input.driver_name());
  if (d.has_device_time == 0 && !(d.nominal_rate_hz > 0.0))
    throw refusal("{}: the frames carry no time, expected --option rate_hz=HZ", source.path);
  SampleTimes times(d);
  times.allow_restarts();
  for (std::size_t i = 0; i < timeline.bytes.size(); ++i)
    driver.decode_bytes({&timeline.bytes[i], 1}, 0, [&](const ifog_sample& sample) {
      (void)times.next(sample);  // repeated or late samples keep their place
      timeline.blocks.push_back({nanoseconds(times.last_s()), i + 1});
    });
  if (timeline.blocks.empty())
    throw refusal("{}: no frame of driver {} in it", source.path, source.input.driver_name());
  timeline.blocks.back().end = timeline.bytes.size();
}

ReplayTimeline from_bytes(const ReplaySource& source, InputFile& file) {
  const bool even = source.block_bytes != 0 && source.rate_hz > 0.0;
  if (!even && !source.input.has_driver())
    throw refusal("{}: raw bytes carry no times, expected --block BYTES and --rate HZ, or --driver NAME",
                  source.path);
  const std::string text = file.bytes();
  ReplayTimeline timeline;
  timeline.bytes.assign(text.begin(), text.end());
  if (timeline.bytes.empty()) return timeline;
  even ? cut_evenly(source, timeline) : cut_by_driver(source, timeline);
  return timeline;
}

ReplayTimeline from_capture(const ReplaySource& source, InputFile& file) {
  if (!source.input.has_driver())
    throw refusal("{}: a capture in columns needs --driver NAME, whose frames its rows become", source.path);
  const LongCapture read(source.input.read_long_columns(file), source.path);
  const CaptureView& capture = read.view();
  const auto plugin = find_plugin(source.input.driver_name(), plugin_folders());
  DriverInstance driver(plugin, with_rate(capture, *plugin, source.input.settings()));
  CaptureEncoder encoder(capture, driver, source.axis);
  for (const std::string& notice : encoder.notices()) warn("{}: {}\n", source.path, notice);
  ReplayTimeline timeline;
  timeline.baud = driver.description().baud;
  if (driver.takes_can() && (source.prefer_can || !driver.takes_bytes())) {
    while (encoder.next(timeline.frames)) {
    }
  } else {
    while (encoder.next(timeline.bytes))
      if (timeline.bytes.size() > (timeline.blocks.empty() ? 0 : timeline.blocks.back().end))
        timeline.blocks.push_back(
            {nanoseconds(capture.time_s[encoder.rows_done() - 1]), timeline.bytes.size()});
  }
  if (encoder.rows_left_out() > 0)
    warn("{}: {} rows without a rate are not sent: the format cannot say so\n", source.path,
         encoder.rows_left_out());
  return timeline;
}

// Each delivery at its arrival time.
ReplayTimeline from_flight(const ReplaySource& source, InputFile& file) {
  FlightInput flight(file);
  ReplayTimeline timeline;
  flight.for_each_entry([&](const FlightEntry& entry) {
    ifog_can_frame frame{};
    if (entry.head.kind == FlightKind::bytes && !entry.payload.empty()) {
      timeline.bytes.insert(timeline.bytes.end(), entry.payload.begin(), entry.payload.end());
      timeline.blocks.push_back({entry.head.time_ns, timeline.bytes.size()});
    } else if (frame_of(entry, frame)) {
      frame.arrival_ns = entry.head.time_ns;
      timeline.frames.push_back(frame);
    }
  });
  if (flight.header().carries == FlightHeader::Carries::messages)
    throw refusal("{}: is a recording of LCM messages, expected one of a device", source.path);
  const SensorConfig sensor = flight.sensor();
  if (!sensor.transport.interface.empty()) timeline.interfaces = {sensor.transport.interface};
  if (!flight.header().interface.empty()) timeline.interfaces = {flight.header().interface};
  // The recorded baud rate; without the driver, --baud is needed.
  timeline.baud = sensor.transport.serial.baud;
  if (timeline.baud == 0 && plugin_is_there(flight.header().driver))
    timeline.baud =
        flight.make_driver(source.input.driver_name(), source.input.settings()).description().baud;
  return timeline;
}

}  // namespace

ReplayTimeline read_timeline(const ReplaySource& source) {
  ReplayTimeline timeline;
  InputFile file(source.path);
  const ReadingProgress progress(file);
  switch (kind_of(source, file)) {
    case FileKind::candump:
      timeline = from_candump(source, file);
      break;
    case FileKind::bytes:
      timeline = from_bytes(source, file);
      break;
    case FileKind::capture:
      timeline = from_capture(source, file);
      break;
    case FileKind::flight:
      timeline = from_flight(source, file);
      break;
    case FileKind::lcm_log:
    case FileKind::unknown:
      throw refusal(
          "{}: neither a flight recording, a candump log, raw bytes nor a capture in columns by its name and "
          "first bytes; --format selects one",
          source.path);
  }
  if (timeline.on.empty() && !source.input.channel.empty()) timeline.interfaces = {source.input.channel};
  if (timeline.size() == 0) throw refusal("{}: nothing in it to send", source.path);
  return timeline;
}

}  // namespace ifog::tools
