// SPDX-License-Identifier: Apache-2.0
#include "tools/report/style.h"

#include <array>
#include <string_view>
#include <utility>

namespace ifog::report {
namespace {

// What a chart is drawn with, in a page or in a picture of its own.
constexpr const char* kChartRules = R"css(
.chart text{font-size:12px;font-family:"DejaVu Sans",system-ui,"Segoe UI",Roboto,sans-serif;fill:var(--ink)}
.chart .tick{fill:var(--muted)}
.chart .heading{font-weight:bold}
.chart .grid{stroke:var(--grid);stroke-width:1;fill:none}
.chart .minor{stroke:var(--grid);stroke-width:.5;fill:none}
.chart .frame{stroke:var(--rule);stroke-width:1;fill:none}
.chart .mark{stroke:var(--muted);stroke-width:1;stroke-dasharray:2 3;fill:none}
.chart .line{fill:none;stroke-width:1.5;stroke-linejoin:round}
.chart .guide{fill:none;stroke-width:1;stroke-opacity:.5}
.chart .band{stroke:none;fill-opacity:.18}
.chart .band.before{fill:var(--before)}
.chart .band.after{fill:var(--after)}
.chart .band.fit{fill:var(--fit)}
.chart .band.second{fill:var(--second)}
.chart .band.raw{fill:var(--raw)}
.chart .band.third{fill:var(--third)}
.chart .band.fourth{fill:var(--fourth)}
.chart .word.before{fill:var(--before)}
.chart .word.after{fill:var(--after)}
.chart .word.fit{fill:var(--fit)}
.chart .word.second{fill:var(--second)}
.chart .word.raw{fill:var(--raw)}
.chart .word.third{fill:var(--third)}
.chart .word.fourth{fill:var(--fourth)}
.chart .dots{fill:none;stroke-linecap:round;stroke-width:4.2}
.chart .line.before,.chart .guide.before,.chart .dots.before{stroke:var(--before)}
.chart .line.before{stroke-width:1.1}
.chart .line.after,.chart .guide.after,.chart .dots.after{stroke:var(--after)}
.chart .line.fit,.chart .guide.fit,.chart .dots.fit{stroke:var(--fit)}
.chart .line.fit{stroke-width:2}
.chart .line.second,.chart .guide.second,.chart .dots.second{stroke:var(--second)}
.chart .line.second{stroke-dasharray:5 3}
.chart .line.raw,.chart .guide.raw,.chart .dots.raw{stroke:var(--raw)}
.chart .line.raw{stroke-width:1}
.chart .line.third,.chart .guide.third,.chart .dots.third{stroke:var(--third)}
.chart .line.third{stroke-dasharray:8 2 2 2}
.chart .line.fourth,.chart .guide.fourth,.chart .dots.fourth{stroke:var(--fourth)}
.chart .line.fourth{stroke-dasharray:2 2}
.chart .line.key{stroke-width:2.5}
.chart .dots.key{stroke-width:8}
)css";

constexpr const char* kPageRules = R"css(
:root{color-scheme:light dark;--paper:#fdfdfb;--ink:#1c2127;--muted:#5b6672;--rule:#d9dde1;--grid:#e8ebee;
 --before:#c26a1b;--after:#1a5fb4;--fit:#10151a;--second:#3f7d4e;--raw:#a3acb5;--third:#7b4ba0;--fourth:#b3263a;
 --card:#f3f5f6;--good:#1f6f3a}
@media (prefers-color-scheme:dark){:root{--paper:#14181c;--ink:#e6e9ec;--muted:#a3adb7;--rule:#39424b;--grid:#262d34;
 --before:#f0a35c;--after:#6cb0ff;--fit:#ffffff;--second:#7fcf95;--raw:#77818b;--third:#c49be8;--fourth:#ff8a94;
 --card:#1d2329;--good:#7fd79a}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
main{max-width:60rem;margin:0 auto;padding:2rem 1.25rem 4rem}
h1{font-size:1.7rem;line-height:1.25;margin:0 0 .25rem}
h1,.sub{overflow-wrap:anywhere}
h2{font-size:1.25rem;margin:2.6rem 0 .6rem;padding-top:.6rem;border-top:1px solid var(--rule)}
h3{font-size:1.05rem;margin:1.6rem 0 .4rem}
p{margin:.5rem 0;max-width:46rem}
li{max-width:44rem}
.sub{color:var(--muted);margin:0 0 1.2rem}
.account{background:var(--card);border-left:4px solid var(--after);padding:.8rem 1.1rem;border-radius:4px}
.account p{margin:.35rem 0}
.tiles{display:flex;flex-wrap:wrap;gap:.8rem;margin:1.1rem 0}
.tile{flex:1 1 11rem;background:var(--card);border-radius:6px;padding:.7rem .9rem}
.tile b{display:block;font-size:1.2rem;line-height:1.3;font-variant-numeric:tabular-nums}
.tile span{color:var(--muted);font-size:.88rem}
figure{margin:1.1rem 0;break-inside:avoid}
figcaption{color:var(--muted);font-size:.9rem;margin-top:.3rem;max-width:46rem}
svg.chart{display:block;width:100%;max-width:760px;min-width:34rem;height:auto;cursor:crosshair;touch-action:pan-x pan-y}
.chart .cursor{stroke:var(--ink);stroke-width:1;fill:none;pointer-events:none}
.chart .say{pointer-events:none}
.chart .card{fill:var(--card);stroke:var(--rule)}
.chart .shade{fill:var(--after);fill-opacity:.15;pointer-events:none}
svg.chart.small{max-width:480px;min-width:26rem}
svg.chart.narrow{display:none;max-width:480px;min-width:0}
svg.chart:focus{outline:2px solid var(--rule);outline-offset:2px}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(24rem,100%),1fr));gap:1rem}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:.94rem;font-variant-numeric:tabular-nums}
caption{text-align:left;color:var(--muted);font-size:.9rem;padding-bottom:.3rem}
th,td{padding:.35rem .7rem .35rem 0;text-align:left;border-bottom:1px solid var(--rule);vertical-align:top}
td.n,th.n{text-align:right;white-space:nowrap}
table.origin code{overflow-wrap:anywhere;font-size:.78rem}
td.better{color:var(--good)}
code,pre{font-family:ui-monospace,"DejaVu Sans Mono",Consolas,monospace;font-size:.88rem}
pre{background:var(--card);padding:.8rem 1rem;border-radius:6px;overflow-x:auto;white-space:pre-wrap;overflow-wrap:anywhere}
nav ul{list-style:none;padding:0;margin:.8rem 0;display:flex;flex-wrap:wrap;gap:.2rem 1.2rem}
a{color:var(--after)}
footer{margin-top:3rem;color:var(--muted);font-size:.88rem}
@media (max-width:37rem){svg.chart.wide{display:none}svg.chart.narrow{display:block}main{padding:1.2rem 1rem 3rem}
 h1{font-size:1.4rem}table{font-size:.8rem}th,td{padding-right:.3rem}}
@media print{:root{color-scheme:light;--paper:#fff;--ink:#000;--muted:#444;--rule:#bbb;--grid:#ddd;--before:#b55a0a;
 --after:#0b4a98;--fit:#000;--second:#2d6a3c;--raw:#999;--third:#5b2f86;--fourth:#8f1426;--card:#f4f4f4;--good:#14532d}
 main{max-width:none;padding:0}nav{display:none}h2,h3{break-after:avoid}tr{break-inside:avoid}
 .pair{grid-template-columns:1fr 1fr}}
)css";

// The page's colours in daylight, for programs that know no variables.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kDaylight{{{"--paper", "#ffffff"},
                                                                                   {"--ink", "#1c2127"},
                                                                                   {"--muted", "#4a545e"},
                                                                                   {"--rule", "#8b949d"},
                                                                                   {"--grid", "#e1e5e9"},
                                                                                   {"--before", "#c26a1b"},
                                                                                   {"--after", "#1a5fb4"},
                                                                                   {"--fit", "#10151a"},
                                                                                   {"--second", "#3f7d4e"},
                                                                                   {"--raw", "#a3acb5"},
                                                                                   {"--third", "#7b4ba0"},
                                                                                   {"--fourth", "#b3263a"}}};

}  // namespace

std::string page_style() {
  std::string rules = kPageRules;
  rules += kChartRules;
  return rules;
}

std::string picture_style() {
  std::string rules = kChartRules;
  for (const auto& [name, colour] : kDaylight) {
    const std::string use = "var(" + std::string(name) + ")";
    for (std::size_t at = rules.find(use); at != std::string::npos; at = rules.find(use, at))
      rules.replace(at, use.size(), colour);
  }
  return rules;
}

}  // namespace ifog::report
