// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/reading_context.h"

#include "daemon/config/table_reader.h"
#include "drivers/ifog/quoted.h"
#include "drivers/transport/serial/set_up_dialogue.h"

namespace ifog {
namespace {

SerialSettings read_serial(TableReader& in) {
  SerialSettings out;
  out.device = in.required_text("device", "the path of a serial device, \"/dev/ttyUSB0\"");
  take(in.integer("baud", 50, 20'000'000), out.baud);
  take(in.integer("data_bits", 5, 8), out.data_bits);
  if (const auto parity = in.choice("parity", {"none", "even", "odd"}))
    out.parity = *parity == "even"  ? SerialSettings::Parity::even
                 : *parity == "odd" ? SerialSettings::Parity::odd
                                    : SerialSettings::Parity::none;
  take(in.integer("stop_bits", 1, 2), out.stop_bits);
  take(in.integer("baud_base", 1, 100'000'000), out.baud_base);
  take(in.texts("set_up"), out.set_up);
  for (const std::string& line : out.set_up)
    if (const std::string expected = SetUpDialogue::complaint(line); !expected.empty())
      in.complain("set_up", " = [" + in_quotes(line) + "]: " + expected);
  return out;
}

// Errors of key combinations come from the transport; not checked after an error of a single key.
void check_network(TableReader& in, const std::string& complaint, std::size_t errors_before,
                   const ReadingContext& context) {
  if (complaint.empty() || context.errors.size() != errors_before) return;
  const std::string key = complaint.substr(0, complaint.find_first_of(" :"));
  in.complain(key, complaint.substr(key.size()));
}

UdpSettings read_udp(TableReader& in, const ReadingContext& context) {
  const std::size_t errors_before = context.errors.size();
  UdpSettings out;
  take(in.required_integer("port", 1, 65535), out.port);
  take(in.text("bind"), out.bind);
  take(in.text("group"), out.group);
  take(in.text("interface"), out.interface);
  take(in.text("host"), out.host);
  take(in.integer("host_port", 1, 65535), out.host_port);
  check_network(in, udp_complaint(out), errors_before, context);
  return out;
}

TcpSettings read_tcp(TableReader& in, const ReadingContext& context) {
  const std::size_t errors_before = context.errors.size();
  TcpSettings out;
  out.host = in.required_text("host", "the sensor's numeric address, \"192.168.1.20\"");
  take(in.required_integer("port", 1, 65535), out.port);
  check_network(in, tcp_complaint(out), errors_before, context);
  return out;
}

FileSettings read_file(TableReader& in, const ReadingContext& context) {
  FileSettings out;
  out.path = context.absolute(in.required_text("path", "a file or FIFO, \"-\" for the standard input"));
  if (in.choice("format", {"bytes", "candump"}) == "candump") out.format = FileSettings::Format::candump;
  if (in.choice("pace", {"free", "recorded"}) == "recorded") out.pace = FileSettings::Pace::recorded;
  take(in.number("speed", {1e-3, 1e6}), out.speed);
  take(in.number("bytes_per_second", {1.0, 1e9}), out.bytes_per_second);
  take(in.integer("block_bytes", 1, 65'536), out.block_bytes);
  take(in.boolean("await_writer"), out.await_writer);
  if (out.pace == FileSettings::Pace::recorded && out.format == FileSettings::Format::bytes &&
      !in.has("bytes_per_second"))
    in.complain("pace", " = \"recorded\": raw bytes carry no times; expected bytes_per_second as well");
  return out;
}

}  // namespace

TransportConfig read_transport(const toml::table& table, ReadingContext& context) {
  TableReader in(table, "sensor.transport", context.file, context.errors);
  TransportConfig out;
  const auto type = in.required_choice("type", {"serial", "can", "udp", "tcp", "file"});
  if (!type) return out;
  if (*type == "serial") {
    out.kind = TransportConfig::Kind::serial;
    out.serial = read_serial(in);
  } else if (*type == "can") {
    out.kind = TransportConfig::Kind::can;
    out.interface = in.required_text("interface", "a CAN interface, \"can0\"");
  } else if (*type == "udp") {
    out.kind = TransportConfig::Kind::udp;
    out.udp = read_udp(in, context);
  } else if (*type == "tcp") {
    out.kind = TransportConfig::Kind::tcp;
    out.tcp = read_tcp(in, context);
  } else {
    out.kind = TransportConfig::Kind::file;
    out.file = read_file(in, context);
    take(in.text("interface"), out.interface);
  }
  in.refuse_the_rest();
  return out;
}

}  // namespace ifog
