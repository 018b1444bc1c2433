// SPDX-License-Identifier: Apache-2.0
// Names, options and actions of a command in plain types. Only this folder includes CLI11, because its
// headers contain the whole parser.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace ifog::tools {

// Returns "" or the error in a value.
using Complaint = std::function<std::string(const std::string& value)>;

// Decimal and finite, as in drivers/ifog/decimal.h; otherwise nullopt.
std::optional<double> number_in(const std::string& text);

// Whole and within 64 bits, signed; otherwise nullopt. (The parser would clamp larger numbers.)
std::optional<std::int64_t> whole_in(const std::string& text);

// Limits of a number, both allowed unless `without_least`, and their words in the help and in errors.
struct ValueRange {
  double least = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();
  bool without_least = false;
  std::string words{};  // "more than 0", "1 to 1000"
};
ValueRange positive();
ValueRange not_negative();
ValueRange within(double least, double most);

// Endings of the names of files of one format.
inline constexpr auto kJsonEndings = std::to_array<std::string_view>({".json", ".jsonl", ".ndjson"});
inline constexpr auto kModelEndings = std::to_array<std::string_view>({".toml"});
inline constexpr auto kPageEndings = std::to_array<std::string_view>({".html", ".htm"});
inline constexpr auto kFrameEndings = std::to_array<std::string_view>({".log", ".candump", ".txt"});
inline constexpr auto kByteEndings =
    std::to_array<std::string_view>({".bin", ".kvh", ".raw", ".dat", ".txt"});

// An option or argument that names files: they are registered before the command runs (command_files.h).
enum class FileUse { none, read, written };

// What an option allows besides the type of its variable, and how the help shows it.
struct OptionRule {
  bool required = false;
  bool shows_default = false;   // the present value of the variable
  bool one_value_each = false;  // each value needs the option again: the next word is not a value
  std::string type{};           // the value's name in the help; "": by its own name and the variable's type
  std::string group{};          // its heading in the help
  char delimiter = '\0';        // of several values in one word
  ValueRange range{};
  std::vector<std::string> choices{};  // shown as a|b instead of a value's name
  Complaint check{};                   // before the others, because its message is more specific
  FileUse file = FileUse::none;
  std::span<const std::string_view> endings{};  // of a written file of one format; empty: any
};

inline const OptionRule kReadsFile{.file = FileUse::read};
inline const OptionRule kWritesJson{.file = FileUse::written, .endings = kJsonEndings};

// Handle of a command, or of the program with its commands.
class Command {
 public:
  explicit Command(CLI::App& command) : command_(&command), files_(std::make_shared<Files>()) {}

  [[nodiscard]] Command add_subcommand(const std::string& name, const std::string& help) const;

  // `value` must outlive the parse. A name without dashes is an argument. T: the types listed in command.cpp:
  // texts, numbers, and optional or several of them.
  template <typename T>
  void add_option(const std::string& names, T& value, const std::string& help,
                  const OptionRule& rule = {}) const;
  void add_flag(const std::string& names, bool& value, const std::string& help) const;
  // Called with the value after the parse; may throw WrongUsage.
  template <typename T>
  void add_taken(const std::string& names, std::function<void(const T&)> take, const std::string& help,
                 const OptionRule& rule = {}) const;
  void add_flag_taken(const std::string& names, std::function<void()> take, const std::string& help,
                      const std::string& group) const;

  // Text after the options in the help, e.g. examples.
  void footer(const std::string& text) const;
  // Registers further files that the command reads.
  void before_run(std::function<void()> registers) const;
  // The action; may throw WrongUsage, Failed or other errors.
  void callback(std::function<void()> run) const;

 private:
  struct Files {
    std::vector<std::function<void()>> read, written;  // register them
  };
  template <typename T>
  void name_files(const std::string& names, const T& value, const OptionRule& rule) const;

  CLI::App* command_;
  std::shared_ptr<Files> files_;
};

}  // namespace ifog::tools
