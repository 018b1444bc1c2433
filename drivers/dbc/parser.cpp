// SPDX-License-Identifier: Apache-2.0
// Parser behind parse_database(); reports and skips invalid statements.
#include <algorithm>
#include <map>
#include <stdexcept>

#include "drivers/dbc/database.h"
#include "drivers/dbc/scanner.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"

namespace ifog::dbc {
namespace {

constexpr std::uint32_t kExtendedFlag = 0x80000000U;
constexpr std::uint32_t kHighestStandard = 0x7FF;
constexpr std::uint32_t kHighestExtended = 0x1FFFFFFF;
// Pseudo message in which editors keep signals that belong to no message.
constexpr std::string_view kOrphans = "VECTOR__INDEPENDENT_SIG_MSG";

class Parser {
 public:
  Parser(std::string_view text, const std::string& file) : in_(text) { out_.file = file; }

  Database parse() {
    while (!in_.at_end()) section_or_warning();
    resolve_selectors();
    const bool usable =
        std::ranges::any_of(out_.messages, [](const Message& m) { return m.refused.empty(); });
    if (!usable && !out_.warnings.empty()) throw std::runtime_error(out_.warnings.front());
    return std::move(out_);
  }

 private:
  std::string warn(std::size_t line, const std::string& what) {
    std::string text = out_.file + ":" + std::to_string(line) + ": " + what;
    if (out_.warnings.size() == kMostBadLines)
      throw std::runtime_error(text + "; more than " + std::to_string(kMostBadLines) +
                               " such lines, this is no DBC file");
    out_.warnings.push_back(text);
    return text;
  }

  void refuse(Signal& signal, std::size_t line, const std::string& what) {
    signal.refused = warn(line, what);
  }

  void section_or_warning() {
    try {
      section();
    } catch (const ScanError& error) {
      const std::string text = warn(error.line, error.what());
      if (building_ != nullptr)
        building_->refused = text;
      else if (named_ != nullptr)
        named_->refused = text;
      else if (costs_message_)
        unknown_message(text);
      in_.resume();
    }
    building_ = named_ = nullptr;
  }

  // Instead of a message that cannot be read: later signals must not be added to the one before.
  void unknown_message(const std::string& why) {
    Message m;
    m.line = in_.line();
    m.refused = why;
    add(std::move(m));
  }
  void add(Message m) {
    out_.messages.push_back(std::move(m));
    names_.emplace_back();
  }
  // Signal of a message of out_; null if there is none with this name.
  Signal* signal_of(Message& message, std::string_view name) {
    const auto& names = names_[static_cast<std::size_t>(&message - out_.messages.data())];
    const auto found = names.find(name);
    return found == names.end() ? nullptr : &message.signals[found->second];
  }
  static bool like_signal(std::string_view line) {
    return line.starts_with("SG") ||
           (line.find('|') != std::string_view::npos && line.find('@') != std::string_view::npos);
  }

  void section() {
    const std::string_view keyword = in_.peek_word();
    costs_message_ = keyword == "BO_";
    if (keyword == "VERSION" || keyword == "BS_" || keyword == "BU_") {
      (void)in_.skip_statement();  // no ';' closes it
    } else if (keyword == "NS_") {
      (void)in_.word("NS_");
      in_.sign(':');
      // The list contains keywords of other sections and must be skipped.
      for (std::string_view name = in_.peek_word();
           !name.empty() && name != "BS_" && name != "BU_" && name != "BO_" && name != "VERSION";
           name = in_.peek_word())
        (void)in_.word("a keyword");
    } else if (keyword == "BO_") {
      message();
    } else if (keyword == "SG_") {
      signal();
    } else if (keyword == "SIG_VALTYPE_") {
      value_type();
    } else if (keyword == "SG_MUL_VAL_") {
      selected_ranges();
    } else if (keyword == "BA_") {
      attribute();
    } else if (carries_no_layout(keyword)) {
      const std::size_t line = in_.line();
      if (!in_.skip_statement()) open_statement(line);
    } else {
      costs_message_ = !like_signal(in_.rest_of_line());
      in_.fail("a section of a DBC file (BO_, SG_, CM_, …)");
    }
  }

  void open_statement(std::size_t line) { (void)warn(line, "a statement without its closing ';'"); }

  // The ';' may be missing at the start of the next statement or at the end of the file.
  void end_statement(std::size_t line) {
    if (in_.accept(';') || in_.at_end()) return;
    if (!in_.begins_statement()) in_.fail("';'");
    open_statement(line);
  }

  void message() {
    Message m;
    m.line = in_.line();
    (void)in_.word("BO_");
    const auto sent = static_cast<std::uint32_t>(in_.integer("a message id", 0xFFFFFFFFU));
    m.name = in_.word("the name of a message");
    in_.sign(':');
    m.length = static_cast<std::uint32_t>(in_.integer("the length of a message in bytes", 65535));
    if (!in_.peek_word().empty() && !in_.begins_statement())
      (void)in_.word("the node that sends the message");
    m.extended = (sent & kExtendedFlag) != 0;
    m.id = sent & ~kExtendedFlag;
    const bool orphans = m.name == kOrphans;
    if (!orphans && m.id > (m.extended ? kHighestExtended : kHighestStandard))
      m.refused = warn(m.line, "message " + printable(m.name) + " has id " + std::to_string(sent) +
                                   ", expected at most 11 bits, or 29 bits and bit 31 set");
    if (const auto other = by_id_.find(sent); !orphans && m.refused.empty() && other != by_id_.end()) {
      // It is ambiguous which of the two a frame is.
      Message& first = out_.messages[other->second];
      m.refused = warn(m.line, "message " + printable(m.name) + " has the id of " + printable(first.name) +
                                   " on line " + std::to_string(first.line));
      first.refused = m.refused;
    } else if (m.refused.empty()) {
      by_id_.emplace(sent, out_.messages.size());
    }
    add(std::move(m));
  }

  void signal() {
    Signal s;
    s.line = in_.line();
    (void)in_.word("SG_");
    if (out_.messages.empty())
      unknown_message(warn(s.line, "a signal, expected a message (BO_) before the first"));
    s.name = in_.word("the name of a signal");
    std::vector<Signal>& signals = out_.messages.back().signals;
    const auto [at, fresh] = names_.back().emplace(s.name, signals.size());
    if (!fresh) {
      Signal& first = signals[at->second];
      refuse(first, s.line,
             "signal " + printable(s.name) + " stands twice in message " +
                 printable(out_.messages.back().name) + ", first on line " + std::to_string(first.line));
    }
    building_ = fresh ? &signals.emplace_back(std::move(s)) : &(dropped_ = std::move(s));
    layout(*building_);
    building_ = nullptr;
    receivers();
  }

  void layout(Signal& s) {
    if (!in_.accept(':')) {
      multiplexing(s, in_.word("M, m and a number, or ':'"));
      in_.sign(':');
    }
    s.start_bit = static_cast<std::uint32_t>(in_.integer("the start bit of a signal", 65535));
    in_.sign('|');
    s.length = static_cast<std::uint32_t>(in_.integer("the length of a signal, 1 to 64 bits", 64));
    if (s.length == 0)
      refuse(s, s.line, "signal " + printable(s.name) + " has length 0, expected 1 to 64 bits");
    in_.sign('@');
    s.order = in_.one_of("01") == '1' ? ByteOrder::kLittle : ByteOrder::kBig;
    s.type = in_.one_of("+-") == '-' ? ValueType::kSigned : ValueType::kUnsigned;
    in_.sign('(');
    s.scale = in_.number("a factor");
    in_.sign(',');
    s.offset = in_.number("an offset");
    in_.sign(')');
    in_.sign('[');
    s.minimum = in_.number("a minimum");
    in_.sign('|');
    s.maximum = in_.number("a maximum");
    in_.sign(']');
    s.unit = in_.one_line_string("the unit in quotes");
  }

  // Names separated by commas or blanks, on the signal's line or, after a comma, on the next.
  void receivers() {
    std::size_t line = in_.line();
    bool goes_on = true;
    for (;;) {
      const std::string_view name = in_.peek_word();
      if (name.empty() || in_.begins_statement() || (in_.line() != line && !goes_on)) break;
      (void)in_.word("a receiving node");
      line = in_.line();
      goes_on = in_.accept(',');
    }
    if (in_.at_end() || in_.line() != line || in_.begins_statement()) return;
    try {
      in_.fail("the name of a receiving node");
    } catch (const ScanError& error) {
      (void)warn(error.line, error.what());
      in_.resume();
    }
  }

  // "M", "m3", "m3M" for a multiplexed multiplexor, or "m" if SG_MUL_VAL_ gives the values.
  void multiplexing(Signal& s, const std::string_view all) {
    std::string_view mark = all;
    if (mark.ends_with('M')) {
      s.selects = true;
      mark.remove_suffix(1);
    }
    if (mark.empty()) return;
    const bool known = mark.front() == 'm' && mark.size() <= 10 &&
                       std::all_of(mark.begin() + 1, mark.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!known)
      throw ScanError(s.line, "signal " + printable(s.name) + " is marked " + in_quotes(all) +
                                  ", expected M, m and a number, or both");
    s.selected = true;
    mark.remove_prefix(1);
    if (mark.empty()) return;
    std::uint64_t value = 0;
    for (const char c : mark) value = value * 10 + static_cast<std::uint64_t>(c - '0');
    s.selected_by.emplace_back(value, value);
  }

  void value_type() {
    const std::size_t line = in_.line();
    (void)in_.word("SIG_VALTYPE_");
    Signal* s = named_ = named_signal();
    (void)in_.accept(':');
    const std::uint64_t type = in_.integer("0 (integer), 1 (float) or 2 (double)", 2);
    end_statement(line);
    if (s == nullptr || type == 0 || !s->refused.empty()) return;
    s->type = type == 1 ? ValueType::kFloat : ValueType::kDouble;
    const std::uint32_t bits = type == 1 ? 32 : 64;
    if (s->length != bits)
      refuse(*s, line,
             "signal " + printable(s->name) + " is a " + (type == 1 ? "float" : "double") + " of " +
                 std::to_string(s->length) + " bits, expected " + std::to_string(bits));
  }

  void selected_ranges() {
    const std::size_t line = in_.line();
    (void)in_.word("SG_MUL_VAL_");
    Signal* s = named_ = named_signal();
    Message* message = named_message_;
    const std::string_view selector = in_.word("the name of a multiplexor");
    std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges;
    do {
      const std::uint64_t from = in_.integer("a multiplexor value", UINT64_MAX);
      in_.sign('-');
      const std::uint64_t to = in_.integer("a multiplexor value", UINT64_MAX);
      ranges.emplace_back(from, to);
    } while (in_.accept(','));
    end_statement(line);
    if (s == nullptr) return;
    const Signal* const found = signal_of(*message, selector);
    if (found == nullptr || !found->selects) {
      refuse(*s, line, in_quotes(selector) + " is no multiplexor of message " + printable(message->name));
      return;
    }
    s->selector = static_cast<std::size_t>(found - message->signals.data());
    s->selected = true;
    s->selected_by = std::move(ranges);
  }

  void attribute() {
    const Scanner begin = in_;
    const std::size_t line = in_.line();
    (void)in_.word("BA_");
    const std::string_view attribute = in_.string("the name of an attribute in quotes");
    const bool of_signal = attribute == "SystemSignalLongSymbol";
    if (!of_signal && attribute != "SystemMessageLongSymbol") {
      in_ = begin;
      if (!in_.skip_statement()) open_statement(line);
      return;
    }
    const std::string_view kind = in_.peek_word();
    if (kind != (of_signal ? "SG_" : "BO_")) in_.fail(of_signal ? "SG_ and a signal" : "BO_ and a message");
    (void)in_.word("SG_ or BO_");
    Signal* s = of_signal ? named_signal() : nullptr;
    if (!of_signal) named_message();
    const std::string_view name = in_.one_line_string("the long name in quotes");
    end_statement(line);
    if (of_signal && s != nullptr) s->long_name = name;
    if (!of_signal && named_message_ != nullptr) named_message_->long_name = name;
  }

  // Message of a statement; null if it does not exist (editors leave lines of deleted messages).
  void named_message() {
    const auto sent = static_cast<std::uint32_t>(in_.integer("a message id", 0xFFFFFFFFU));
    const auto found = by_id_.find(sent);
    named_message_ = found == by_id_.end() ? nullptr : &out_.messages[found->second];
  }

  // "ID NAME".
  Signal* named_signal() {
    const std::size_t line = in_.line();
    named_message();
    const std::string_view name = in_.word("the name of a signal");
    if (named_message_ == nullptr) return nullptr;
    Signal* const found = signal_of(*named_message_, name);
    if (found == nullptr)
      (void)warn(line, "message " + printable(named_message_->name) + " has no signal " + in_quotes(name));
    return found;
  }

  // A signal marked mN depends on the message's single multiplexor, unless SG_MUL_VAL_ names another one.
  void resolve_selectors() {
    for (Message& m : out_.messages) {
      std::vector<std::size_t> multiplexors;
      for (std::size_t k = 0; k < m.signals.size(); ++k)
        if (m.signals[k].selects && !m.signals[k].selected) multiplexors.push_back(k);
      for (Signal& s : m.signals) {
        if (!s.selected || s.selector != kNone || !s.refused.empty() || !m.refused.empty()) continue;
        const std::string whose = "signal " + printable(s.name) + " is multiplexed, but ";
        const std::string message = "message " + printable(m.name);
        if (s.selected_by.empty())
          refuse(s, s.line, whose + "neither a number behind its m nor SG_MUL_VAL_ says by which value");
        else if (multiplexors.empty())
          refuse(s, s.line, whose + message + " has no multiplexor (M)");
        else if (multiplexors.size() > 1)
          refuse(s, s.line, whose + message + " has two multiplexors and no SG_MUL_VAL_ says which");
        else
          s.selector = multiplexors.front();
      }
    }
  }

  Scanner in_;
  Database out_;
  std::map<std::uint32_t, std::size_t> by_id_;                          // with the flag bit, as in the file
  std::vector<std::map<std::string, std::size_t, std::less<>>> names_;  // signals of each message
  Message* named_message_ = nullptr;
  Signal* building_ = nullptr;  // signal that an error makes doubtful: the one being parsed,
  Signal* named_ = nullptr;     // or the one named in the statement
  Signal dropped_;
  bool costs_message_ = false;  // an error here is of a line that may have begun a message
};

}  // namespace

Database parse_database(std::string_view text, const std::string& file) {
  if (text.size() > kInputLimits.dbc_bytes) throw std::runtime_error(file + ": is larger than any DBC file");
  return Parser(text, file).parse();
}

}  // namespace ifog::dbc
