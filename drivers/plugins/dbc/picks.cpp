// SPDX-License-Identifier: Apache-2.0
#include "drivers/plugins/dbc/picks.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <numbers>
#include <string_view>

#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"
#include "drivers/units/units.h"

namespace ifog::dbc {
namespace {

constexpr std::array kOptions{
    ifog_option{"dbc", IFOG_OPTION_FILE, nullptr, "Vector DBC file that describes the bus"},
    ifog_option{"signal", "[MESSAGE.]SIGNAL", "", "what a single-axis sensor measures; instead of x, y, z"},
    ifog_option{"x", "[MESSAGE.]SIGNAL", "", "what the sensor measures about its x axis"},
    ifog_option{"y", "[MESSAGE.]SIGNAL", "", "about its y axis"},
    ifog_option{"z", "[MESSAGE.]SIGNAL", "", "about its z axis"},
    ifog_option{"kind", "rate | delta | angle", "rate", "what these signals are"},
    ifog_option{"unit", "auto | rad | deg | arcsec | mrad | urad | rev, for a rate also UNIT/s, /min or /h",
                "auto", "unit of the signals; auto takes the one the DBC file states"},
    ifog_option{"sign", "auto | none", "auto",
                "auto: an unsigned signal is negative where a bit of its message is 1 that has its name with "
                "Sign or VZ in it"},
    ifog_option{"wrap", "auto | none | a number > 0 in the signal's unit", "auto",
                "an angle starts again at this; auto: an integer signal's range, one turn for a float"},
    ifog_option{"counter", "[MESSAGE.]SIGNAL", "",
                "sample counter; a bare name is looked for in every axis's message"},
    ifog_option{"counter_modulus", "auto | a whole number > 1", "auto",
                "auto: from the counter's bit length"},
    ifog_option{"status", "[MESSAGE.]SIGNAL", "", "status word, passed on as sent"},
    ifog_option{"status_mask", "a whole number, also as 0x…", "0xFFFFFFFF",
                "bits of the status word that count"},
    ifog_option{"status_good", "any | a whole number, also as 0x…", "any",
                "the sample is valid when the masked status word is this"},
    ifog_option{"time", "[MESSAGE.]SIGNAL", "",
                "the device's clock; its unit in the DBC file is s, ms, us or ns"},
    ifog_option{"environment", "COLUMN=[MESSAGE.]SIGNAL, …", "",
                "environment channels by capture column, in its unit, e.g. temperature_degC=Box.Temperature"},
    ifog_option{"rate_hz", "a number >= 0", "0", "samples a second; 0: unknown"},
    ifog_option{nullptr, nullptr, nullptr, nullptr}};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::string file_text(const plugin::Options& options) {
  const std::string path(options.text("dbc"));
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
    options.fail("dbc", "a regular file");
  std::ifstream file(path, std::ios::binary);
  if (!file) options.fail("dbc", "a DBC file that can be read");
  std::string text;
  std::vector<char> block(1U << 16U);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(file.gcount()));
    if (text.size() > kInputLimits.dbc_bytes) options.fail("dbc", "a DBC file of at most 64 MiB");
  }
  if (file.bad() || text.empty()) options.fail("dbc", "a DBC file that can be read and is not empty");
  return text;
}

std::string shown(const Pick& pick) {
  return printable(display_name(*pick.message) + "." + display_name(*pick.signal), 2 * kLongestQuote);
}

// In lower case, without '_' and without these words.
std::string plain(std::string_view name, std::initializer_list<std::string_view> words = {}) {
  std::string out;
  for (const char c : name)
    if (c != '_') out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const std::string_view word : words)
    if (const std::size_t at = out.find(word); at != std::string::npos) out.erase(at, word.size());
  return out;
}

std::optional<std::uint64_t> whole_number(std::string_view text) {
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    text.remove_prefix(2);
    base = 16;
  }
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

class Reader {
 public:
  Reader(const plugin::Options& options, Picks& out) : options_(options), out_(out) {}

  void read() {
    out_.database = parse_database(file_text(options_), std::string(options_.text("dbc")));
    out_.kind = options_.choice<ifog_kind>(
        "kind", {{"rate", IFOG_RATE}, {"delta", IFOG_DELTA_ANGLE}, {"angle", IFOG_ANGLE}});
    axes();
    if (out_.kind == IFOG_ANGLE) wrap();
    counter();
    status();
    time();
    environments();
    out_.rate_hz = options_.number("rate_hz", 0.0, 1e6, "a number >= 0, at most 1000000");
    remark_bad_lines();
  }

 private:
  std::vector<Pick> find(std::string_view name) const { return find_signals(out_.database, name); }

  // written: a name that is none of them.
  std::string known_signals(std::string_view written = "") const {
    constexpr std::size_t kShown = 12;
    const bool with_message = written.find('.') != std::string_view::npos;
    std::string list;
    std::vector<std::string> names;
    std::vector<Pick> all;
    for (const Message& m : out_.database.messages)
      for (const Signal& s : m.signals) all.push_back({&m, &s});
    // A file of a whole car has thousands; angular rates come first.
    std::stable_partition(all.begin(), all.end(), [&](const Pick& each) {
      return angle_unit(each.signal->unit, out_.kind == IFOG_RATE, false).has_value();
    });
    for (const Pick& each : all) {
      if (names.size() < kShown) list += (names.empty() ? "" : ", ") + shown(each);
      names.push_back(with_message ? shown(each) : printable(display_name(*each.signal), kLongestQuote));
    }
    list += names.size() > kShown ? ", … (" + std::to_string(names.size()) + " in all)" : "";
    list += did_you_mean(written, names);
    // It may be on a line that could not be parsed.
    const std::vector<std::string>& bad = out_.database.warnings;
    if (!bad.empty())
      list += "; " + std::to_string(bad.size()) + " bad lines in it, the first: " + bad.front();
    return list;
  }

  Pick one(std::string_view key, std::string_view name) const {
    const std::vector<Pick> found = find(name);
    if (found.empty()) options_.fail(key, "a signal of " + out_.database.file + ": " + known_signals(name));
    if (found.size() > 1)
      options_.fail(key, "one signal, with its message before a dot; " + in_quotes(name) + " may be " +
                             shown(found[0]) + " or " + shown(found[1]));
    check_fits(out_.database, *found[0].message, *found[0].signal);
    return found[0];
  }

  // Files of whole cars have many bad lines, mostly of other messages.
  void remark_bad_lines() {
    constexpr std::size_t kShown = 3;
    const std::vector<std::string>& bad = out_.database.warnings;
    const std::size_t shown = std::min(kShown, bad.size());
    if (bad.size() > shown)
      out_.remarks.insert(out_.remarks.begin(), std::to_string(bad.size() - shown) +
                                                    " more bad lines, of signals that are not used");
    out_.remarks.insert(out_.remarks.begin(), bad.begin(), bad.begin() + static_cast<std::ptrdiff_t>(shown));
  }

  // Sign and modulus apart, as VW sends them: Yaw_Rate and Yaw_Rate_Sign, ESP_Gierrate and ESP_VZ_Gierrate.
  const Signal* sign_of(const Pick& pick) {
    const bool never = options_.choice<bool>("sign", {{"auto", false}, {"none", true}});
    const Signal& value = *pick.signal;
    if (never || value.type != ValueType::kUnsigned || value.offset < 0.0) return nullptr;
    for (const Signal& bit : pick.message->signals) {
      if (bit.length != 1 || !bit.refused.empty() || bit.selector != kNone || &bit == &value) continue;
      if (plain(bit.name, {"vorzeichen", "sign", "vz"}) != plain(value.name)) continue;
      out_.remarks.push_back(shown(pick) + " is negative where " + display_name(bit) +
                             " is 1; option sign = none takes it as it is");
      return &bit;
    }
    return nullptr;
  }

  void axes() {
    const bool single = options_.given("signal");
    for (const std::string_view key : {"signal", "x", "y", "z"}) {
      if (!options_.given(key)) continue;
      if (single && key != "signal")
        options_.fail(key, "nothing with 'signal': a sensor has either one axis without a name or x, y, z");
      Axis axis;
      axis.name = single ? "" : key;
      axis.pick = one(key, options_.text(key));
      const bool automatic = options_.text("unit") == "auto";
      const std::string unit(automatic ? std::string_view(axis.pick.signal->unit) : options_.text("unit"));
      const std::optional<double> scale = angle_unit(unit, out_.kind == IFOG_RATE, !automatic);
      if (!scale)
        options_.fail(
            "unit",
            "a unit of " +
                std::string(out_.kind == IFOG_RATE ? "angular rate (rad/s, deg/s, deg/h, …)"
                                                   : "angle (rad, deg, arcsec, …)") +
                (automatic ? ", as the DBC file gives " + in_quotes(unit) + " for " + shown(axis.pick) : ""));
      axis.si_per_unit = *scale;
      axis.sign = sign_of(axis.pick);
      out_.axes.push_back(std::move(axis));
    }
    if (out_.axes.empty()) options_.fail("signal", "a signal here, or in x, y, z: " + known_signals());
  }

  void wrap() {
    const std::string_view word = options_.text("wrap");
    if (word == "none") return;
    for (const Axis& axis : out_.axes) {
      const Signal& s = *axis.pick.signal;
      double here = 2.0 * std::numbers::pi;
      if (word != "auto")
        here = options_.number("wrap", 1e-12, 1e12, "auto, none or a number > 0") * axis.si_per_unit;
      else if (is_integer(s.type))
        here = std::ldexp(std::abs(s.scale), static_cast<int>(s.length)) * axis.si_per_unit;
      if (out_.angle_wrap_rad != 0.0 && out_.angle_wrap_rad != here)
        options_.fail("wrap", "a number: the axes' signals have different ranges");
      out_.angle_wrap_rad = here;
    }
  }

  void counter() {
    if (!options_.given("counter")) return;
    const std::string_view name = options_.text("counter");
    if (name.find('.') == std::string_view::npos) {
      for (const Pick& pick : find(name))
        if (std::ranges::any_of(out_.axes,
                                [&](const Axis& axis) { return axis.pick.message == pick.message; }))
          out_.counter.push_back(pick);
    }
    if (out_.counter.empty()) out_.counter.push_back(one("counter", name));
    for (const Pick& pick : out_.counter) {
      if (std::ranges::none_of(out_.axes,
                               [&](const Axis& axis) { return axis.pick.message == pick.message; }))
        options_.fail("counter",
                      "a signal in a message that carries an axis; " + shown(pick) + " is in none");
      check_fits(out_.database, *pick.message, *pick.signal);
      if (!is_integer(pick.signal->type)) options_.fail("counter", "an integer signal");
      if (pick.signal->length != out_.counter.front().signal->length)
        options_.fail("counter", "counters of one length in all messages");
    }
    const std::uint32_t bits = std::min<std::uint32_t>(out_.counter.front().signal->length, 31);
    out_.counter_modulus = std::uint32_t{1} << bits;
    if (options_.text("counter_modulus") == "auto") return;
    const std::optional<std::uint64_t> modulus = whole_number(options_.text("counter_modulus"));
    if (!modulus || *modulus < 2 || *modulus > out_.counter_modulus)
      options_.fail("counter_modulus",
                    "auto or a whole number from 2 to " + std::to_string(out_.counter_modulus));
    out_.counter_modulus = static_cast<std::uint32_t>(*modulus);
  }

  std::uint32_t word(std::string_view key, const std::string& expected) const {
    const std::optional<std::uint64_t> value = whole_number(options_.text(key));
    if (!value || *value > 0xFFFFFFFFU) options_.fail(key, expected);
    return static_cast<std::uint32_t>(*value);
  }

  void status() {
    if (options_.given("status")) {
      out_.status = one("status", options_.text("status"));
      if (out_.status->signal->length > 32) options_.fail("status", "a signal of at most 32 bits");
    }
    out_.status_mask = word("status_mask", "a whole number of at most 32 bits");
    if (options_.text("status_good") == "any") return;
    if (!out_.status) options_.fail("status_good", "any, as no 'status' is given");
    out_.status_good = word("status_good", "any or a whole number of at most 32 bits");
  }

  void time() {
    if (!options_.given("time")) return;
    out_.time = one("time", options_.text("time"));
    const std::optional<double> unit = time_unit(out_.time->signal->unit);
    if (!unit)
      options_.fail("time", "a signal whose unit in the DBC file is s, ms, us or ns; it is " +
                                in_quotes(out_.time->signal->unit));
    out_.seconds_per_unit = *unit;
  }

  void environments() {
    std::string_view rest = options_.text("environment");
    while (!rest.empty()) {
      const std::size_t comma = rest.find(',');
      const std::string_view item = trimmed(rest.substr(0, comma));
      rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
      if (item.empty()) continue;
      const std::size_t equals = item.find('=');
      const std::string_view column = trimmed(item.substr(0, equals));
      if (equals == std::string_view::npos || column.empty() || column.size() >= IFOG_NAME_LENGTH)
        options_.fail("environment",
                      "COLUMN=SIGNAL, several separated by commas; " + in_quotes(item) + " is not");
      for (const Environment& other : out_.environments)
        if (other.column == column) options_.fail("environment", "each column once");
      if (out_.environments.size() == IFOG_MAX_ENVIRONMENT)
        options_.fail("environment", "at most " + std::to_string(IFOG_MAX_ENVIRONMENT) + " channels");
      const Pick pick = one("environment", trimmed(item.substr(equals + 1)));
      std::string remark;
      out_.environments.push_back(
          {std::string(column), pick, convert_to_column(pick.signal->unit, column, remark)});
      if (!remark.empty()) out_.remarks.push_back("environment: " + remark);
    }
  }

  const plugin::Options& options_;
  Picks& out_;
};

}  // namespace

void read_picks(const plugin::Options& options, Picks& out) { Reader(options, out).read(); }

const ifog_option* option_list() { return kOptions.data(); }

}  // namespace ifog::dbc
