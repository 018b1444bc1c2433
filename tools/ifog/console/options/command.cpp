// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/options/command.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <utility>

namespace ifog::tools {

Option Option::required() const { return Option(*option_->required()); }

Option Option::type_name(const std::string& word) const { return Option(*option_->type_name(word)); }

Option Option::shows_default() const { return Option(*option_->capture_default_str()); }

Option Option::group(const std::string& heading) const { return Option(*option_->group(heading)); }

Option Option::delimiter(char between) const { return Option(*option_->delimiter(between)); }

Option Option::one_value_each() const { return Option(*option_->allow_extra_args(false)); }

Option Option::positive() const { return Option(*option_->check(CLI::PositiveNumber)); }

Option Option::not_negative() const { return Option(*option_->check(CLI::NonNegativeNumber)); }

Option Option::within(double least, double most) const {
  return Option(*option_->check(CLI::Range(least, most)));
}

Option Option::within(int least, int most) const { return Option(*option_->check(CLI::Range(least, most))); }

Option Option::within(std::size_t least, std::size_t most) const {
  return Option(*option_->check(CLI::Range(least, most)));
}

Option Option::one_of(const std::vector<std::string>& words) const {
  return Option(*option_->check(CLI::IsMember(words)));
}

Option Option::check(Complaint complaint) const { return Option(*option_->check(std::move(complaint))); }

bool Option::given() const { return option_->count() > 0; }

Command Command::add_subcommand(const std::string& name, const std::string& help) const {
  return Command(*command_->add_subcommand(name, help));
}

template <typename T>
Option Command::add_option(const std::string& names, T& value, const std::string& help) const {
  return Option(*command_->add_option(names, value, help));
}

template <typename T>
Option Command::add_taken(const std::string& names, std::function<void(const T&)> take,
                          const std::string& help) const {
  return Option(*command_->add_option_function<T>(names, take, help));
}

Option Command::add_flag(const std::string& names, bool& value, const std::string& help) const {
  return Option(*command_->add_flag(names, value, help));
}

Option Command::add_flag_taken(const std::string& names, std::function<void()> take,
                               const std::string& help) const {
  return Option(*command_->add_flag_callback(names, std::move(take), help));
}

void Command::footer(const std::string& text) const { command_->footer(text); }

void Command::callback(std::function<void()> run) const { command_->callback(std::move(run)); }

// What commands take.
template Option Command::add_option(const std::string&, std::string&, const std::string&) const;
template Option Command::add_option(const std::string&, double&, const std::string&) const;
template Option Command::add_option(const std::string&, int&, const std::string&) const;
template Option Command::add_option(const std::string&, unsigned&, const std::string&) const;
template Option Command::add_option(const std::string&, std::uint64_t&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<double>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<std::uint64_t>&,
                                    const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<double>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<std::string>&, const std::string&) const;
template Option Command::add_taken(const std::string&, std::function<void(const double&)>,
                                   const std::string&) const;
template Option Command::add_taken(const std::string&, std::function<void(const std::int64_t&)>,
                                   const std::string&) const;
template Option Command::add_taken(const std::string&, std::function<void(const std::string&)>,
                                   const std::string&) const;
template Option Command::add_taken(const std::string&, std::function<void(const std::vector<double>&)>,
                                   const std::string&) const;

}  // namespace ifog::tools
