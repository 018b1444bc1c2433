// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/reading_context.h"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>

#include "daemon/config/lcm_field_name.h"
#include "daemon/config/table_reader.h"
#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"
#include "filters/chain/plausibility.h"

namespace ifog {
namespace {

// Channels are columns of captures besides time and rates, so they must not have these names; and their unit
// must be in the name, for captures and models.
void check_name(TableReader& in, const std::string& name, const ReadingContext& context) {
  std::string axis;
  if (name == "time_s" || axis_of(name, "rate", axis) || axis_of(name, "reference_rate", axis)) {
    in.complain("name",
                " = " + in_quotes(name) + ": expected another name, captures call their time or a rate so");
    return;
  }
  if (context.recorded) return;
  const std::size_t line = name.rfind('_');
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isgraph(c) != 0 &&
           std::string_view(",;\"'[]").find(static_cast<char>(c)) == std::string_view::npos;
  });
  if (!plain || line == std::string::npos || line == 0 || line + 1 == name.size())
    in.complain("name", " = " + in_quotes(name) +
                            ": expected NAME_UNIT without blanks, commas, quotes and brackets, "
                            "\"temperature_degC\"");
}

// Rejects limits that exclude all values possible in the unit.
void check_unit(TableReader& in, const ChannelConfig& channel) {
  const Measurable can_be = measurable(channel.name);
  std::ostringstream words;
  words << ": expected limits within " << can_be.least << " ... " << can_be.most << ", what "
        << in_quotes(channel.name) << " can be";
  if (channel.limits.minimum > can_be.most) in.complain("minimum", words.str());
  if (channel.limits.maximum < can_be.least) in.complain("maximum", words.str());
}

void read_lcm(TableReader& in, ChannelConfig& out) {
  out.source = ChannelConfig::Source::lcm;
  out.lcm_channel = in.required_text(
      "lcm_channel", "an LCM channel that carries ifog.channel_t, ifog.rate_t or ifog.status_t");
  out.field = in.text("field").value_or("");
  if (!LcmFieldName::parse(out.field))
    in.complain("field", " = " + in_quotes(out.field) + ": expected " + kLcmFieldExpected);
}

}  // namespace

Limits read_limits(TableReader& in, double most, const ReadingContext& context) {
  Limits out;
  take(in.number("minimum", {-most, most}), out.minimum);
  take(in.number("maximum", {-most, most}), out.maximum);
  take(in.number("max_step", {0.0, 2.0 * most, !context.recorded}), out.max_step);
  if (!(out.minimum < out.maximum)) in.complain("maximum", ": not above minimum; expected minimum < maximum");
  return out;
}

ChannelConfig read_channel(const toml::table& table, ReadingContext& context) {
  TableReader in(table, "sensor.channel", context.file, context.errors);
  ChannelConfig out;
  out.name = in.required_text("name", "a channel's name with its unit, \"temperature_degC\"");
  take(in.number("max_age_s", kNotNegative), out.max_age_s);
  out.limits = read_limits(in, kMostChannel, context);
  const auto source = in.required_choice("source", {"frame", "can", "lcm", "file"});
  if (!source) return out;
  if (*source == "frame") {
    out.source = ChannelConfig::Source::frame;
  } else {
    take(in.number("scale", {-kMostChannel, kMostChannel}), out.scale);
    take(in.number("offset", {-kMostChannel, kMostChannel}), out.offset);
    if (out.scale == 0.0 && !context.recorded)
      in.complain("scale", " = 0: expected a number other than 0, of which every value would be the offset");
    if (!out.name.empty()) check_name(in, out.name, context);
  }
  if (*source == "can") {
    out.source = ChannelConfig::Source::can;
    out.interface = in.required_text("interface", "a CAN interface, \"can0\"");
    out.dbc = context.absolute(in.required_text("dbc", "a DBC file"));
    out.signal = in.required_text("signal", "a signal of the DBC file, \"SIGNAL\" or \"MESSAGE.SIGNAL\"");
  } else if (*source == "lcm") {
    read_lcm(in, out);
  } else if (*source == "file") {
    out.source = ChannelConfig::Source::file;
    out.path = context.absolute(in.required_text("path", "a file that holds one number"));
    take(in.number("period_s", {1e-3, 3600.0}), out.period_s);
    if (out.max_age_s > 0.0 && out.period_s > out.max_age_s && !context.recorded)
      in.complain(in.has("period_s") ? "period_s" : "max_age_s",
                  ": read every " + shortest(out.period_s) +
                      " s with max_age_s = " + shortest(out.max_age_s) +
                      ": expected more often, every value would be stale before the next");
  }
  if (!context.recorded) check_unit(in, out);
  in.refuse_the_rest();
  return out;
}

}  // namespace ifog
