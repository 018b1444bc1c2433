#include "tools/report/style.h"

namespace ifog::report {

const char* const kStyle = R"css(
:root{color-scheme:light dark;--paper:#fdfdfb;--ink:#1c2127;--muted:#5b6672;--rule:#d9dde1;--grid:#e8ebee;
 --before:#c26a1b;--after:#1a5fb4;--fit:#10151a;--second:#3f7d4e;--card:#f3f5f6;--good:#1f6f3a}
@media (prefers-color-scheme:dark){:root{--paper:#14181c;--ink:#e6e9ec;--muted:#a3adb7;--rule:#39424b;--grid:#262d34;
 --before:#f0a35c;--after:#6cb0ff;--fit:#ffffff;--second:#7fcf95;--card:#1d2329;--good:#7fd79a}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
main{max-width:60rem;margin:0 auto;padding:2rem 1.25rem 4rem}
h1{font-size:1.7rem;line-height:1.25;margin:0 0 .25rem}
h2{font-size:1.25rem;margin:2.6rem 0 .6rem;padding-top:.6rem;border-top:1px solid var(--rule)}
h3{font-size:1.05rem;margin:1.6rem 0 .4rem}
p{margin:.5rem 0;max-width:46rem}
.sub{color:var(--muted);margin:0 0 1.2rem}
.account{background:var(--card);border-left:4px solid var(--after);padding:.8rem 1.1rem;border-radius:4px}
.account p{margin:.35rem 0}
.tiles{display:flex;flex-wrap:wrap;gap:.8rem;margin:1.1rem 0}
.tile{flex:1 1 11rem;background:var(--card);border-radius:6px;padding:.7rem .9rem}
.tile b{display:block;font-size:1.2rem;line-height:1.3;font-variant-numeric:tabular-nums}
.tile span{color:var(--muted);font-size:.88rem}
figure{margin:1.1rem 0;break-inside:avoid}
figcaption{color:var(--muted);font-size:.9rem;margin-top:.3rem;max-width:46rem}
svg.chart{display:block;width:100%;height:auto}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(24rem,100%),1fr));gap:1rem}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:.94rem;font-variant-numeric:tabular-nums}
caption{text-align:left;color:var(--muted);font-size:.9rem;padding-bottom:.3rem}
th,td{padding:.35rem .7rem .35rem 0;text-align:left;border-bottom:1px solid var(--rule);vertical-align:top}
td.n,th.n{text-align:right;white-space:nowrap}
td.better{color:var(--good)}
code,pre{font-family:ui-monospace,"DejaVu Sans Mono",Consolas,monospace;font-size:.88rem}
pre{background:var(--card);padding:.8rem 1rem;border-radius:6px;overflow-x:auto;white-space:pre-wrap;overflow-wrap:anywhere}
nav ul{list-style:none;padding:0;margin:.8rem 0;display:flex;flex-wrap:wrap;gap:.2rem 1.2rem}
a{color:var(--after)}
.chart text{font:12px system-ui,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;fill:var(--ink)}
.chart .tick{fill:var(--muted)}
.chart .grid{stroke:var(--grid);stroke-width:1;fill:none}
.chart .mark{stroke:var(--muted);stroke-width:1;stroke-dasharray:2 3;fill:none}
.chart .line{fill:none;stroke-width:1.5;stroke-linejoin:round}
.chart .key{stroke-width:2.5}
.chart .dots{fill:none;stroke-linecap:round;stroke-width:4.2}
.chart .dots.key{stroke-width:8}
.chart .before{stroke:var(--before)}
.chart .line.before{stroke-width:1.1}
.chart .after{stroke:var(--after)}
.chart .fit{stroke:var(--fit);stroke-width:2}
.chart .second{stroke:var(--second);stroke-dasharray:5 3}
footer{margin-top:3rem;color:var(--muted);font-size:.88rem}
@media print{:root{color-scheme:light;--paper:#fff;--ink:#000;--muted:#444;--rule:#bbb;--grid:#ddd;--before:#b55a0a;
 --after:#0b4a98;--fit:#000;--second:#2d6a3c;--card:#f4f4f4;--good:#14532d}
 main{max-width:none;padding:0}nav{display:none}h2,h3{break-after:avoid}tr{break-inside:avoid}
 .pair{grid-template-columns:1fr 1fr}}
)css";

}  // namespace ifog::report
