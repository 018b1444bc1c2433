#include "drivers/dbc/database.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "drivers/dbc/scanner.h"

namespace ifog::dbc {
namespace {

constexpr std::uint32_t kExtendedFlag = 0x80000000U;
constexpr std::uint32_t kHighestStandard = 0x7FF;
constexpr std::uint32_t kHighestExtended = 0x1FFFFFFF;
// The pseudo message in which editors keep signals that belong to no message.
constexpr std::uint32_t kOrphans = 0xC0000000U;

// Sections that end with ';' and say nothing about where a signal lies.
constexpr std::array kSkipped{"VAL_TABLE_",
                              "CM_",
                              "BA_DEF_",
                              "BA_",
                              "VAL_",
                              "CAT_DEF_",
                              "CAT_",
                              "FILTER",
                              "BA_DEF_DEF_",
                              "EV_",
                              "EV_DATA_",
                              "ENVVAR_DATA_",
                              "SGTYPE_",
                              "SGTYPE_VAL_",
                              "BA_DEF_SGTYPE_",
                              "BA_SGTYPE_",
                              "SIG_TYPE_REF_",
                              "SIG_GROUP_",
                              "SIGTYPE_VALTYPE_",
                              "BO_TX_BU_",
                              "BA_DEF_REL_",
                              "BA_REL_",
                              "BA_DEF_DEF_REL_",
                              "BU_SG_REL_",
                              "BU_EV_REL_",
                              "BU_BO_REL_",
                              "NS_DESC_",
                              "BA_DEF_SGTYPE_REL_"};

class Parser {
 public:
  Parser(std::string_view text, const std::string& file) : in_(text, file) { out_.file = file; }

  Database parse() {
    while (!in_.at_end()) section();
    resolve_selectors();
    return std::move(out_);
  }

 private:
  void section() {
    const std::string_view keyword = in_.peek_word();
    if (keyword == "VERSION") {
      (void)in_.word("VERSION");
      (void)in_.string("the version in quotes");
    } else if (keyword == "NS_") {
      (void)in_.word("NS_");
      in_.sign(':');
      // The list names other sections' keywords, so it must not be read as sections.
      for (std::string_view name = in_.peek_word();
           !name.empty() && name != "BS_" && name != "BU_" && name != "BO_" && name != "VERSION";
           name = in_.peek_word())
        (void)in_.word("a keyword");
    } else if (keyword == "BS_" || keyword == "BU_") {
      in_.skip_line();
    } else if (keyword == "BO_") {
      message();
    } else if (keyword == "SG_") {
      signal();
    } else if (keyword == "SIG_VALTYPE_") {
      value_type();
    } else if (keyword == "SG_MUL_VAL_") {
      selected_ranges();
    } else if (std::find(kSkipped.begin(), kSkipped.end(), keyword) != kSkipped.end()) {
      in_.skip_statement();
    } else {
      in_.fail("a section of a DBC file (BO_, SG_, CM_, …)");
    }
  }

  void message() {
    Message m;
    m.line = in_.line();
    (void)in_.word("BO_");
    const auto sent = static_cast<std::uint32_t>(in_.integer("a message id", 0xFFFFFFFFU));
    m.name = in_.word("the name of a message");
    in_.sign(':');
    m.length = static_cast<std::uint32_t>(in_.integer("the length of a message in bytes", 65535));
    (void)in_.word("the node that sends the message");
    m.extended = (sent & kExtendedFlag) != 0;
    m.id = sent & ~kExtendedFlag;
    orphan_ = sent == kOrphans;
    if (!orphan_ && m.id > (m.extended ? kHighestExtended : kHighestStandard))
      refuse(m.line, "message " + m.name + " has id " + std::to_string(sent) +
                         ", expected at most 11 bits, or 29 bits and bit 31 set");
    for (const Message& other : out_.messages)
      if (!orphan_ && other.id == m.id && other.extended == m.extended)
        refuse(m.line, "message " + m.name + " has the id of " + other.name + " on line " +
                           std::to_string(other.line));
    out_.messages.push_back(std::move(m));
  }

  void signal() {
    Signal s;
    s.line = in_.line();
    if (out_.messages.empty()) in_.fail("a message (BO_) before its first signal");
    (void)in_.word("SG_");
    s.name = in_.word("the name of a signal");
    if (!in_.accept(':')) {
      multiplexing(s, in_.word("M, m and a number, or ':'"));
      in_.sign(':');
    }
    s.start_bit = static_cast<std::uint32_t>(in_.integer("the start bit of a signal", 65535));
    in_.sign('|');
    s.length = static_cast<std::uint32_t>(in_.integer("the length of a signal, 1 to 64 bits", 64));
    if (s.length == 0) refuse(s.line, "signal " + s.name + " has length 0, expected 1 to 64 bits");
    in_.sign('@');
    s.order = in_.one_of("01") == '1' ? ByteOrder::kLittle : ByteOrder::kBig;
    s.type = in_.one_of("+-") == '-' ? ValueType::kSigned : ValueType::kUnsigned;
    in_.sign('(');
    s.scale = in_.number("a factor");
    in_.sign(',');
    s.offset = in_.number("an offset");
    in_.sign(')');
    in_.sign('[');
    (void)in_.number("a minimum");
    in_.sign('|');
    (void)in_.number("a maximum");
    in_.sign(']');
    s.unit = in_.string("the unit in quotes");
    in_.skip_line();  // the receiving nodes
    Message& owner = out_.messages.back();
    for (const Signal& other : owner.signals)
      if (other.name == s.name)
        refuse(s.line, "signal " + s.name + " stands twice in message " + owner.name + ", first on line " +
                           std::to_string(other.line));
    owner.signals.push_back(std::move(s));
  }

  // "M", "m3", or "m3M" for a multiplexor that is itself multiplexed.
  void multiplexing(Signal& s, std::string_view mark) {
    const std::string_view all = mark;
    if (mark.ends_with('M')) {
      s.selects = true;
      mark.remove_suffix(1);
    }
    if (mark.empty()) return;
    std::uint64_t value = 0;
    mark.remove_prefix(all.starts_with('m') ? 1 : 0);
    if (!all.starts_with('m') || mark.empty() || mark.size() > 9)
      refuse(s.line, "signal " + s.name + " is marked '" + std::string(all) +
                         "', expected M, m and a number, or both");
    for (const char c : mark) {
      if (c < '0' || c > '9')
        refuse(s.line, "signal " + s.name + " is marked '" + std::string(all) +
                           "', expected M, m and a number, or both");
      value = value * 10 + static_cast<std::uint64_t>(c - '0');
    }
    s.selected_by.emplace_back(value, value);
  }

  void value_type() {
    (void)in_.word("SIG_VALTYPE_");
    const std::size_t line = in_.line();
    Signal* s = named_signal();
    (void)in_.accept(':');
    const std::uint64_t type = in_.integer("0 (integer), 1 (float) or 2 (double)", 2);
    in_.sign(';');
    if (s == nullptr || type == 0) return;
    s->type = type == 1 ? ValueType::kFloat : ValueType::kDouble;
    const std::uint32_t bits = type == 1 ? 32 : 64;
    if (s->length != bits)
      refuse(line, "signal " + s->name + " is a " + (type == 1 ? "float" : "double") + " of " +
                       std::to_string(s->length) + " bits, expected " + std::to_string(bits));
  }

  void selected_ranges() {
    (void)in_.word("SG_MUL_VAL_");
    Signal* s = named_signal();
    const std::size_t line = in_.line();
    const std::string selector(in_.word("the name of a multiplexor"));
    std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges;
    do {
      const std::uint64_t from = in_.integer("a multiplexor value", UINT64_MAX);
      in_.sign('-');
      const std::uint64_t to = in_.integer("a multiplexor value", UINT64_MAX);
      ranges.emplace_back(from, to);
    } while (in_.accept(','));
    in_.sign(';');
    if (s == nullptr) return;
    const std::vector<Signal>& all = named_message_->signals;
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Signal& x) { return x.name == selector; });
    if (found == all.end() || !found->selects)
      refuse(line, "'" + selector + "' is no multiplexor of message " + named_message_->name);
    s->selector = static_cast<std::size_t>(found - all.begin());
    s->selected_by = std::move(ranges);
  }

  // "ID NAME". Editors leave such lines behind when a message is deleted: null for a message that is not
  // there.
  Signal* named_signal() {
    const auto sent = static_cast<std::uint32_t>(in_.integer("a message id", 0xFFFFFFFFU));
    const std::size_t line = in_.line();
    const std::string name(in_.word("the name of a signal"));
    const bool extended = (sent & kExtendedFlag) != 0;
    named_message_ = nullptr;
    for (Message& m : out_.messages)
      if (m.id == (sent & ~kExtendedFlag) && m.extended == extended) named_message_ = &m;
    if (named_message_ == nullptr) return nullptr;
    for (Signal& s : named_message_->signals)
      if (s.name == name) return &s;
    refuse(line, "message " + named_message_->name + " has no signal '" + name + "'");
  }

  // A signal marked mN depends on the message's one multiplexor, unless SG_MUL_VAL_ named another.
  void resolve_selectors() {
    for (Message& m : out_.messages)
      for (std::size_t i = 0; i < m.signals.size(); ++i) {
        Signal& s = m.signals[i];
        if (s.selected_by.empty() || s.selector != kNone) continue;
        for (std::size_t k = 0; k < m.signals.size(); ++k) {
          if (k == i || !m.signals[k].selects || !m.signals[k].selected_by.empty()) continue;
          if (s.selector != kNone)
            refuse(s.line, "signal " + s.name + " is multiplexed, but message " + m.name +
                               " has two multiplexors and no SG_MUL_VAL_ says which");
          s.selector = k;
        }
        if (s.selector == kNone)
          refuse(s.line,
                 "signal " + s.name + " is multiplexed, but message " + m.name + " has no multiplexor (M)");
      }
  }

  [[noreturn]] void refuse(std::size_t line, const std::string& what) {
    throw std::runtime_error(out_.file + ":" + std::to_string(line) + ": " + what);
  }

  Scanner in_;
  Database out_;
  Message* named_message_ = nullptr;
  bool orphan_ = false;
};

}  // namespace

Database parse_database(std::string_view text, const std::string& file) { return Parser(text, file).parse(); }

void check_fits(const Database& database, const Message& message, const Signal& signal) {
  const auto refuse = [&](const std::string& why) {
    throw std::runtime_error(database.file + ":" + std::to_string(signal.line) + ": signal " + message.name +
                             "." + signal.name + " " + why);
  };
  constexpr std::uint32_t kLongestFrame = 64;
  if (message.length > kLongestFrame)
    refuse("is in a message of " + std::to_string(message.length) + " bytes, expected at most 64 (CAN FD)");
  // Counted from the first bit of the frame in the order in which the signal runs through it.
  const std::uint32_t first = signal.order == ByteOrder::kLittle
                                  ? signal.start_bit
                                  : signal.start_bit / 8 * 8 + (7 - signal.start_bit % 8);
  if (first + signal.length > message.length * 8)
    refuse("reaches beyond the " + std::to_string(message.length) + " bytes of its message");
  if (signal.scale == 0.0) refuse("has factor 0, expected any other number");
  // A multiplexor that depends on itself would be asked for ever.
  std::size_t depth = 0;
  for (std::size_t k = signal.selector; k != kNone; k = message.signals[k].selector)
    if (++depth > message.signals.size()) refuse("depends on multiplexors in a circle");
}

}  // namespace ifog::dbc
