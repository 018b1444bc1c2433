// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/capture_output.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "drivers/capture/candump/candump.h"
#include "drivers/capture/capture_encoder.h"
#include "drivers/capture/files/output_file.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/table/column_writer.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/progress.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

// Writes the encoder's bytes or frames, a block of them as `text_of` makes it, and returns their number.
template <typename Part, typename TextOf>
std::size_t write_encoded(CaptureEncoder& encoder, std::size_t rows, const std::string& to,
                          const TextOf& text_of) {
  std::vector<Part> block;
  std::size_t count = 0;
  Progress progress("encoding", rows);
  OutputFile file(to);
  const auto write = [&] {
    file.write(text_of(block));
    count += block.size();
    block.clear();
    progress.at(encoder.rows_done());
  };
  while (encoder.next(block))
    if (encoder.rows_done() % RowBatch::kRows == 0) write();
  write();
  file.finish();
  return count;
}

std::string bytes_in(const std::vector<std::uint8_t>& block) { return {block.begin(), block.end()}; }

std::string candump_lines(const std::vector<ifog_can_frame>& block, const std::string& interface) {
  std::string text;
  std::array<char, kCandumpLineMax> line{};
  for (const ifog_can_frame& frame : block)
    text.append(line.data(), format_candump_line(frame, interface, line.data()));
  return text;
}

}  // namespace

void expect_capture_name(const std::string& option, const std::string& path, const CaptureInput* encoding) {
  const FileKind kind = file_kind(path);
  const bool sent = encoding != nullptr && (kind == FileKind::bytes || kind == FileKind::candump ||
                                            (kind == FileKind::unknown && encoding->has_driver()));
  expect_ending(
      option, path, kind == FileKind::capture || sent,
      std::string(kColumnEndings) + (encoding != nullptr ? "; through a driver in .bin, .kvh or .log" : ""));
}

void write_columns(const LongTable& table, const std::string& from, const std::string& to) {
  const CaptureShape shape = capture_shape(table.names(), from, table);
  // In the order of a capture: rates, references, channels.
  std::vector<std::size_t> order(table.columns.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {},
                    [&](std::size_t c) { return std::pair(shape.places[c].kind, shape.places[c].at); });
  std::vector<std::string> names{"time_s"};
  std::vector<std::span<const double>> columns{table.time_s};
  for (const std::size_t c : order) {
    names.push_back(table.columns[c].name);
    columns.emplace_back(table.columns[c].values);
  }
  ColumnWriter file(to, table.comments, names);
  Progress progress("writing " + std::filesystem::path(to).filename().string(), table.size());
  file.rows(columns, table.origin, [&](std::size_t done) { progress.at(done); });
  file.finish();
}

void write_recording(const LongTable& table, const std::string& from, const std::string& to,
                     const CaptureInput& input, const std::string& axis) {
  const CaptureView capture = view_of(table, from);
  if (!input.has_driver())
    throw WrongUsage(to, "is no .csv or .h5, expected --driver NAME (or --dbc FILE) to encode it with");
  const auto plugin = find_plugin(input.driver_name(), plugin_folders());
  DriverInstance driver(plugin, with_rate(capture, *plugin, input.settings()));
  const bool log = is_standard_output(to) ? driver.takes_can() : file_kind(to) == FileKind::candump;
  if (log != driver.takes_can())
    throw WrongUsage(to, "driver " + input.driver_name() + " speaks " +
                             (driver.takes_can() ? "CAN, expected a name ending in .log"
                                                 : "bytes, expected a name ending in .bin or .kvh"));
  try {
    CaptureEncoder encoder(capture, driver, axis);
    for (const std::string& notice : encoder.notices()) warn("{}: {}\n", from, notice);
    if (log) {
      const std::string interface = input.channel.empty() ? "vcan0" : input.channel;
      const std::size_t frames = write_encoded<ifog_can_frame>(
          encoder, table.size(), to, [&](const auto& block) { return candump_lines(block, interface); });
      say("{}: {} samples in {} frames on {}\n", to, table.size() - encoder.rows_left_out(), frames,
          interface);
    } else {
      const std::size_t bytes = write_encoded<std::uint8_t>(encoder, table.size(), to, bytes_in);
      say("{}: {} samples, {} bytes\n", to, table.size() - encoder.rows_left_out(), bytes);
    }
    if (encoder.rows_left_out() != 0)
      warn("{}: {} rows without a rate are dropped: the format cannot say so\n", from,
           encoder.rows_left_out());
    if (const double lost_s = encoder.time_lost_s();
        std::abs(lost_s) > std::max(1.5 / encoder.rate_hz(), 1e-3 * encoder.elapsed_s()))
      warn(
          "{}: its {:.6g} s become {:.6g} s: the format has no clock, and whoever reads it counts {:g} "
          "samples a second\n",
          from, encoder.elapsed_s(), encoder.elapsed_s() - lost_s, encoder.rate_hz());
    if (encoder.rows_at_full_scale() != 0)
      warn(
          "{}: {} samples at or beyond the sensor's full scale, which every reader of the frames takes for "
          "missing\n",
          from, encoder.rows_at_full_scale());
  } catch (const std::runtime_error& error) {
    const std::string line = error.what();
    throw std::runtime_error(line.starts_with(from) || line.starts_with(to) ? line : from + ": " + line);
  }
  if (driver.description().nominal_rate_hz > 0.0 && input.settings().count("rate_hz") == 0)
    say("to decode it again, add --option rate_hz={:.7g}\n", driver.description().nominal_rate_hz);
}

}  // namespace ifog::tools
