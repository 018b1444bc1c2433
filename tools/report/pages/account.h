// SPDX-License-Identifier: Apache-2.0
// The findings in plain language.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"

namespace ifog::report {

std::string account(const Diagnosis& diagnosis);          // HTML paragraphs
std::string account_of_rest(const Diagnosis& diagnosis);  // the unexplained part; HTML
// "falls from 1.2 °/h to 0.4 °/h": plain text.
std::string account_of_change(const Diagnosis& diagnosis, const std::string& key);

// Keys of before/after in reading order: single samples, then means by increasing length.
std::vector<std::string> in_reading_order(const std::map<std::string, double>& figures);

// True if effects cancel each other: then their shares of the error do not add up to one, which page and
// console note.
bool parts_overlap(const Diagnosis& diagnosis);

std::string sentence(const std::string& text);  // first letter in upper case, full stop at the end
std::string probability(double p);              // "0.003", "below 1 in a million"

}  // namespace ifog::report
