// SPDX-License-Identifier: Apache-2.0
// The findings in plain language.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"

namespace ifog::report {

std::string account(const Diagnosis& diagnosis);          // HTML paragraphs
std::string account_of_rest(const Diagnosis& diagnosis);  // what stays unexplained; HTML
// "falls from 1.2 °/h to 0.4 °/h": plain text.
std::string account_of_change(const Diagnosis& diagnosis, const std::string& key);

// Keys of before/after as a person reads down them: single samples, then longer and longer means.
std::vector<std::string> in_reading_order(const std::map<std::string, double>& figures);

// Parts that run against each other may each be as large as the error and more: their shares are no parts of
// one whole, and both the page and the console say so.
bool parts_overlap(const Diagnosis& diagnosis);

std::string sentence(const std::string& text);  // first letter large, full stop at the end
std::string probability(double p);              // "0.003", "below 1 in a million"

}  // namespace ifog::report
