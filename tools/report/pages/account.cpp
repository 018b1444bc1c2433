// SPDX-License-Identifier: Apache-2.0
#include "tools/report/pages/account.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "filters/effects/form.h"
#include "tools/report/pages/words.h"
#include "tools/report/text.h"

namespace ifog::report {
namespace {

double averaging_time(const std::string& key) {
  const auto at = key.find_first_of("0123456789");
  return at == std::string::npos ? 0.0 : std::strtod(key.c_str() + at, nullptr);
}

int family(const std::string& key) {
  if (key.rfind("residual", 0) == 0) return 0;
  if (key.rfind("rms", 0) == 0) return 1;
  if (key.rfind("adev", 0) == 0) return 2;
  return 3;
}

// The averaging time with the largest improvement.
std::string most_improved(const Diagnosis& d) {
  std::string best;
  double least = 1.0;
  for (const auto& [key, before] : d.before) {
    const auto after = d.after.find(key);
    if (family(key) > 1 || after == d.after.end() || !(before > 0.0)) continue;
    if (after->second / before < least) {
      least = after->second / before;
      best = key;
    }
  }
  return best;
}

std::string count_words(std::size_t count) {
  static const char* kWords[] = {"No effect",     "One effect",   "Two effects",
                                 "Three effects", "Four effects", "Five effects"};
  return count < 6 ? kWords[count] : std::to_string(count) + " effects";
}

// One entry per effect, HTML; a comb of lines is one entry.
std::vector<std::string> effects_in_words(const Diagnosis& d) {
  std::string lines;
  std::size_t line_count = 0;
  for (const FoundEffect& found : d.effects)
    if (found.effect.form == "line") {
      lines += (line_count == 0 ? "" : ", ") + number(parameter(found.effect, "frequency_hz"), 4);
      ++line_count;
    }
  std::vector<std::string> each;
  for (const FoundEffect& found : d.effects) {
    if (found.effect.form == "line" && line_count > 2) continue;
    each.push_back(escaped(sentence(effect_words(found.effect) +
                                    (found.effect.meaning.empty() ? "" : " – " + found.effect.meaning))));
  }
  if (line_count > 2) each.push_back(std::to_string(line_count) + " lines, at " + lines + " Hz.");
  return each;
}

}  // namespace

bool parts_overlap(const Diagnosis& diagnosis) {
  double sum = 0.0;
  for (const FoundEffect& found : diagnosis.effects) sum += found.variance_explained;
  return sum > 1.05;
}

std::string sentence(const std::string& text) {
  if (text.empty()) return "";
  std::string out = text;
  out[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(out[0])));
  if (out.back() != '.' && out.back() != '!' && out.back() != '?') out += '.';
  return out;
}

std::string probability(double p) { return p < 1e-6 ? "below one in a million" : number(p, 2); }

std::vector<std::string> in_reading_order(const std::map<std::string, double>& figures) {
  std::vector<std::string> keys;
  keys.reserve(figures.size());
  for (const auto& [key, value] : figures) keys.push_back(key);
  std::stable_sort(keys.begin(), keys.end(), [](const std::string& a, const std::string& b) {
    return family(a) != family(b) ? family(a) < family(b) : averaging_time(a) < averaging_time(b);
  });
  return keys;
}

std::string account_of_change(const Diagnosis& d, const std::string& key) {
  const auto before = d.before.find(key), after = d.after.find(key);
  if (before == d.before.end() || after == d.after.end()) return "";
  const Figure f = figure(key);
  const double change = after->second / before->second - 1.0;
  return "The " + f.label +
         (change < -0.005  ? " falls from "
          : change > 0.005 ? " rises from "
                           : " stays: from ") +
         number(before->second * f.scale) + " to " + number(after->second * f.scale) + " " + f.unit +
         (std::abs(change) > 0.005
              ? " (" + std::string(change > 0 ? "+" : "") + number(100.0 * change, 2) + " %)"
              : "") +
         ".";
}

std::string account(const Diagnosis& d) {
  if (d.effects.empty() && d.hysteresis) {
    return "<p><strong>Nothing was found that a correction could take away.</strong></p>\n<p>" +
           account_of_rest(d) + "</p>\n";
  }
  if (d.effects.empty()) {
    return "<p><strong>Nothing was found.</strong> No channel, and no pattern in time, explains more of this "
           "error than chance would. That is a result: a correction by them would only add to it.</p>\n<p>" +
           account_of_rest(d) + "</p>\n";
  }
  std::string out = "<p><strong>" + count_words(d.effects.size()) +
                    (d.effects.size() == 1 ? " was" : " were") + " found.</strong>";
  const std::vector<std::string> each = effects_in_words(d);
  if (each.size() == 1) {
    out += " " + each.front() + "</p>\n";
  } else {
    out += "</p>\n<ul>\n";
    for (const std::string& words : each) out += "<li>" + words + "</li>\n";
    out += "</ul>\n";
  }
  const std::string key = most_improved(d);
  if (!key.empty())
    out += "<p>The worse of full-data and held-out error: " + escaped(account_of_change(d, key)) + " " +
           (key == "residual_rms_radps" ? "" : escaped(account_of_change(d, "residual_rms_radps"))) +
           "</p>\n";
  if (!d.indistinguishable.empty())
    out += "<p>Not every name is certain: see <em>What cannot be distinguished</em>.</p>\n";
  return out + "<p>" + account_of_rest(d) + "</p>\n";
}

std::string account_of_rest(const Diagnosis& d) {
  const Unexplained& u = d.unexplained;
  if (u.kind.empty() || u.kind == "nothing") return "Nothing more is found in what remains.";
  std::string kind = u.kind;
  std::replace(kind.begin(), kind.end(), '_', ' ');
  return "Something remains unexplained: <strong>" + escaped(kind) + "</strong>, " +
         (u.fraction < 1e-3 ? "under 0.1" : number(100.0 * u.fraction, 2)) +
         " % of the variance that is neither white noise nor explained." +
         (u.hint.empty() ? "" : " " + escaped(sentence(u.hint)));
}

}  // namespace ifog::report
