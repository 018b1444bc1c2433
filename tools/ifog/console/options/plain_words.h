// SPDX-License-Identifier: Apache-2.0
// What an option takes, in the words of people instead of a programming language's types: of help, manual
// pages and completion alike, for all are made of the command line itself.
#pragma once

namespace CLI {
class App;
}

namespace ifog::tools {

// What is a number is held to it from then on, decimal, finite and in its range (checked_values.h), and a
// value that is not what the help says is refused by the same words.
//
// Rewrites the types of every option, once all commands are there: FILE, NAME, NUMBER or N for a type that nobody has
// named, a|b for a choice, and a range as the end of the help: "more than 0", "1 to 1000".
void in_plain_words(CLI::App& app);

}  // namespace ifog::tools
