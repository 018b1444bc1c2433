// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/undeclared/tally.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace ifog::undeclared {
namespace {

bool effect_free(const Score& s) { return s.kind == Kind::kNothing || s.kind == Kind::kLookalike; }

double quantile(std::vector<double> x, double q) {
  if (x.empty()) return std::nan("");
  std::sort(x.begin(), x.end());
  const double at = q * static_cast<double>(x.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, x.size() - 1);
  return x[low] + (at - static_cast<double>(low)) * (x[high] - x[low]);
}

template <typename... Args>
void line(std::ostream& out, const char* format, Args... args) {
  char text[1024];
  std::snprintf(text, sizeof text, format, args...);
  out << text << '\n';
}

double percent(int part, int whole) { return whole == 0 ? 0.0 : 100.0 * part / whole; }

void print_row(std::ostream& out, const char* name, const std::vector<Score>& scores) {
  int right = 0, exact = 0, extra = 0;
  std::vector<double> error;
  for (const Score& s : scores) {
    right += s.right() ? 1 : 0;
    exact += s.exact == s.hidden ? 1 : 0;
    extra += s.extra > 0 ? 1 : 0;
    if (s.transferable) error.push_back(s.effect_error);
  }
  const auto n = static_cast<int>(scores.size());
  line(out, "%-24s %7d %7d %7d %7d %7d   %8.3f %8.3f", name, n, right, exact, n - right, extra,
       quantile(error, 0.5), quantile(error, 0.9));
}

void print_coverage(std::ostream& out, const std::vector<Score>& scores) {
  std::map<std::string, std::pair<int, int>> by_name;
  for (const Score& s : scores)
    for (const Parameter& p : s.parameters) {
      auto& [inside, all] = by_name[p.name];
      inside += std::abs(p.error_in_sigma) <= 1.96 ? 1 : 0;
      ++all;
    }
  out << "\n95 % intervals that hold the truth\n";
  for (const auto& [name, count] : by_name)
    line(out, "  %-58s %5d of %5d  %5.1f %%", name.c_str(), count.first, count.second,
         percent(count.first, count.second));
}

}  // namespace

Totals total(const std::vector<Score>& scores) {
  Totals t;
  std::vector<double> error, shape, width;
  int inside = 0;
  for (const Score& s : scores) {
    t.seconds_each += s.seconds / static_cast<double>(scores.size());
    t.contradictory += s.contradictions.empty() ? 0 : 1;
    if (s.heading_square) {
      t.heading_square += *s.heading_square;
      t.heading_within += *s.heading_square <= 1.96 * 1.96 ? 1.0 : 0.0;
      ++t.headings;
      if (!s.right() || s.extra > 0) {
        ++t.headings_wrong;
      } else {
        t.heading_square_right += *s.heading_square;
      }
      if (effect_free(s)) {
        t.heading_square_free += *s.heading_square;
        ++t.headings_free;
      }
    }
    for (const Parameter& p : s.parameters) {
      inside += std::abs(p.error_in_sigma) <= 1.96 ? 1 : 0;
      ++t.intervals;
      if (p.width > 0.0) width.push_back(p.width);
    }
    if (effect_free(s)) {
      ++t.effect_free;
      t.false_alarms += s.extra > 0 ? 1 : 0;
      continue;
    }
    t.extra += s.extra > 0 ? 1 : 0;
    t.completed += s.completed > 0 ? 1 : 0;
    if (s.kind == Kind::kUncovered) {
      ++t.uncovered;
      t.uncovered_said += s.right() ? 1 : 0;
      t.made_worse += s.shape_error > 1.02 * s.effect_size ? 1 : 0;
      continue;
    }
    ++t.sensors;
    t.right += s.right() ? 1 : 0;
    t.exact += s.exact == s.hidden ? 1 : 0;
    t.missed += s.right() ? 0 : 1;
    if (s.transferable) {
      error.push_back(s.effect_error);
      shape.push_back(s.shape_error);
    }
  }
  t.error_median = quantile(error, 0.5);
  t.error_p90 = quantile(error, 0.9);
  t.shape_error_median = quantile(shape, 0.5);
  t.shape_error_p90 = quantile(shape, 0.9);
  t.coverage = t.intervals == 0 ? std::nan("") : static_cast<double>(inside) / t.intervals;
  t.interval_width = quantile(width, 0.5);
  t.heading_square = t.headings == 0 ? std::nan("") : t.heading_square / t.headings;
  t.heading_within = t.headings == 0 ? std::nan("") : t.heading_within / t.headings;
  const int right = t.headings - t.headings_wrong;
  t.heading_square_right = right == 0 ? std::nan("") : t.heading_square_right / right;
  t.heading_square_free = t.headings_free == 0 ? std::nan("") : t.heading_square_free / t.headings_free;
  return t;
}

void print(std::ostream& out, const std::vector<Score>& scores) {
  out << "hidden effect            sensors   right   exact  missed   extra   effect error on another "
         "capture\n"
         "                                                                 (x own noise, 10 s means) median, "
         "90 %\n";
  std::map<Kind, std::vector<Score>> by_kind;
  std::map<int, std::vector<Score>> by_size;
  for (const Score& s : scores) {
    by_kind[s.kind].push_back(s);
    if (!effect_free(s) && s.kind != Kind::kUncovered)
      by_size[static_cast<int>(std::round(s.sigma))].push_back(s);
  }
  for (const auto& [kind, part] : by_kind) print_row(out, name_of(kind), part);
  if (by_size.size() > 1) {
    out << "\nby visibility, sigma\n";
    std::map<int, std::vector<Score>> bins;
    for (const auto& [sigma, part] : by_size) {
      const int bin = sigma < 12 ? sigma : sigma < 20 ? 12 : sigma < 40 ? 20 : 40;
      bins[bin].insert(bins[bin].end(), part.begin(), part.end());
    }
    for (const auto& [bin, part] : bins)
      print_row(out, (bin < 12 ? std::to_string(bin) : "from " + std::to_string(bin)).c_str(), part);
  }
  print_coverage(out, scores);

  const Totals t = total(scores);
  out << "\n";
  if (t.sensors > 0) {
    line(out, "right            %5d of %5d  %5.1f %%   (target >= 97; by the hidden name %d)", t.right,
         t.sensors, percent(t.right, t.sensors), t.exact);
    line(out, "extra effects    %5d of %5d  %5.1f %%   (target <= 3)", t.extra, t.sensors + t.uncovered,
         percent(t.extra, t.sensors + t.uncovered));
    line(out, "   besides, the hidden law's own second term, within 3 sigma of what it is: %d", t.completed);
    line(out, "effect's error   median %.3f (target <= 0.06), 90 %% %.3f (target <= 0.2)", t.error_median,
         t.error_p90);
    line(out, "   without mean  median %.3f, 90 %% %.3f", t.shape_error_median, t.shape_error_p90);
  }
  if (t.effect_free > 0)
    line(out, "false alarms     %5d of %5d  %5.2f %%  (target <= 1)", t.false_alarms, t.effect_free,
         percent(t.false_alarms, t.effect_free));
  if (t.uncovered > 0)
    line(out, "not covered      %5d, called unexplained %d, made worse %d (target 0)", t.uncovered,
         t.uncovered_said, t.made_worse);
  line(out, "contradictions   %5d of %5zu  reports say something against themselves (target 0)",
       t.contradictory, scores.size());
  if (t.intervals > 0)
    line(out, "95 %% intervals  hold %.1f %% of %d (target 93 to 97), median width %.2f of the oracle's",
         100.0 * t.coverage, t.intervals, t.interval_width);
  if (t.headings > 0) {
    line(out,
         "heading error    (found / predicted)^2 on the next capture: mean %.3f over %d (target 0.9 to 1.1)",
         t.heading_square, t.headings);
    line(out,
         "                 where the diagnosis was right %.3f, wrong in %d; effect-free %.3f; within 1.96 "
         "sigma %.1f %%",
         t.heading_square_right, t.headings_wrong, t.heading_square_free, 100.0 * t.heading_within);
  }
  line(out, "%.2f s a sensor", t.seconds_each);
}

void print_failures(std::ostream& out, const std::vector<Score>& scores) {
  for (const Score& s : scores) {
    const bool worse = s.kind == Kind::kUncovered && s.shape_error > 1.02 * s.effect_size;
    for (const std::string& each : s.contradictions)
      line(out, "seed %-8llu contradicts itself: %s", static_cast<unsigned long long>(s.seed), each.c_str());
    if (s.right() && s.extra == 0 && !worse) continue;
    line(out, "seed %-8llu %-22s %5.1f sigma  missed %d extra %d%s  error %.3f  found: %s",
         static_cast<unsigned long long>(s.seed), name_of(s.kind), s.sigma, s.missed, s.extra,
         worse ? " MADE WORSE" : "", s.effect_error, s.names.empty() ? "nothing" : s.names.c_str());
  }
}

void print_promises(std::ostream& out, const std::vector<Score>& scores) {
  for (const Score& s : scores) {
    std::string text;
    for (const Parameter& p : s.parameters) {
      char part[160];
      std::snprintf(part, sizeof part, "  %s %+.2f (%.2f)", p.name.c_str(), p.error_in_sigma, p.width);
      text += part;
    }
    line(out, "seed %-8llu %-22s %5.1f sigma  error %7.3f  heading %7.3f%s",
         static_cast<unsigned long long>(s.seed), name_of(s.kind), s.sigma, s.effect_error,
         s.heading_square ? std::sqrt(*s.heading_square) : std::nan(""), text.c_str());
  }
}

}  // namespace ifog::undeclared
