// SPDX-License-Identifier: Apache-2.0
// What a page does under the pointer: values at a place, a closer look at a stretch. It works on every chart that
// carries data-plot (Chart::svg); nothing is fetched, and without it the page shows the same pictures.
//
// data-plot: {frame: [left, right, top, bottom] px, x, y: {log, low, high, label, names},
// series: [{style, name, kind, x, y, high}]}: float32, base64; x may be the index of a series that has the
// same. One for a telephone has data-frame and takes the rest from the chart before it. The dash of a number
// is the true minus, as everywhere in the page.
(() => {
const floats = t => new Float32Array(Uint8Array.from(atob(t), c => c.charCodeAt(0)).buffer);
const text = (v, digits = 5) => String(Number(v.toPrecision(digits))).replace('-', '\u2212');
// At an axis: as many digits as neighbours need to differ.
const beside = (v, all) => text(v, all.length < 2 ? 4 : Math.min(15, Math.max(1, 1 + Math.ceil(Math.log10(Math.abs(v) / Math.abs(all[1] - all[0]) + 1e-9)))));
const make = (parent, name, attributes, content) => {
  const e = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) e.setAttribute(key, value);
  if (content !== undefined) e.textContent = content;
  parent.append(e);
  return e;
};
function scale(axis, low, high, from, to) {
  const value = axis.log ? Math.log10 : v => v, a = value(low), b = value(high);
  return {px: v => from + (value(v) - a) / (b - a) * (to - from),
          at: px => { const v = a + (px - from) / (to - from) * (b - a); return axis.log ? 10 ** v : v; },
          drawn: v => isFinite(v) && (!axis.log || v > 0)};
}
function ticks(axis, low, high, wanted) {
  const out = [];
  if (axis.log && high / low > 8) {
    const all = high / low < 2e3 ? [1, 2, 5] : [1];
    for (let d = Math.floor(Math.log10(low)); d <= Math.log10(high); ++d)
      for (const m of all) if (m * 10 ** d >= low && m * 10 ** d <= high) out.push(m * 10 ** d);
    return out;
  }
  for (let k = Math.max(1, Math.ceil(low)); k <= Math.min(axis.names.length, high); ++k) out.push(k);
  if (axis.names.length) return out.filter((v, i) => i % Math.ceil(out.length / (wanted + 1)) === 0);
  const rough = (high - low) / wanted, decade = 10 ** Math.floor(Math.log10(rough));
  const step = decade * (rough / decade < 1.5 ? 1 : rough / decade < 3.5 ? 2 : rough / decade < 7.5 ? 5 : 10);
  const first = Math.ceil(low / step), count = Math.min(50, Math.floor(high / step) - first + 1);
  for (let k = 0; k < count; ++k) out.push((first + k) * step);
  return out;
}
for (const chart of document.querySelectorAll('svg[data-plot],svg[data-frame]')) {
  const plot = JSON.parse((chart.dataset.plot ? chart : chart.previousElementSibling).dataset.plot);
  const [left, right, top, bottom] = chart.dataset.plot ? plot.frame : JSON.parse(chart.dataset.frame);
  for (const s of plot.series) {
    s.x = typeof s.x === 'number' ? plot.series[s.x].x : floats(s.x);
    s.y = floats(s.y);
    if (s.high) s.high = floats(s.high);
  }
  const still = chart.querySelector('g.scale'), curves = chart.querySelector('svg.curves');
  const as_drawn = curves.innerHTML, moving = make(chart, 'g', {class: 'scale'});
  chart.insertBefore(moving, still);
  const over = make(chart, 'g', {class: 'over'}), shade = make(over, 'rect', {class: 'shade', y: top, height: bottom - top, width: 0});
  const cursor = make(over, 'path', {class: 'cursor', d: 'M0 0'}), say = make(over, 'g', {class: 'say'});
  let view = [plot.x.low, plot.x.high], sx, sy, from = null;

  // What is packed has seven digits: a closer look than that shows nothing.
  function look(a, b) {
    const least = 1e-6 * Math.max(Math.abs(a), Math.abs(b), plot.x.high - plot.x.low);
    if (plot.x.log ? !(b / a > 1 + 1e-6) : !(b - a > least)) return;
    view = [a, b];
    draw();
  }

  function heights() {
    if (view[0] === plot.x.low && view[1] === plot.x.high) return [plot.y.low, plot.y.high];
    let low = Infinity, high = -Infinity;
    for (const s of plot.series) for (let i = 0; i < s.x.length; ++i)
      if (s.x[i] >= view[0] && s.x[i] <= view[1])
        for (const v of s.high ? [s.y[i], s.high[i]] : [s.y[i]])
          if (isFinite(v) && (!plot.y.log || v > 0)) { low = Math.min(low, v); high = Math.max(high, v); }
    if (!(high > low)) return [plot.y.low, plot.y.high];
    return plot.y.log ? [low / (high / low) ** .05, high * (high / low) ** .05] : [low - .05 * (high - low), high + .05 * (high - low)];
  }
  function path(s) {
    if (s.kind === 'band') {
      let there = '', back = '';
      for (let i = 0; i < s.x.length; ++i) if (sx.drawn(s.x[i]) && sy.drawn(s.y[i]) && sy.drawn(s.high[i])) {
        const x = sx.px(s.x[i]).toFixed(1);
        there += (there ? 'L' : 'M') + x + ' ' + sy.px(s.high[i]).toFixed(1);
        back = 'L' + x + ' ' + sy.px(s.y[i]).toFixed(1) + back;
      }
      return there && there + back + 'Z';
    }
    let d = '', down = false;
    for (let i = 0; i < s.x.length; ++i) {
      const near = sx.drawn(s.x[i]) && sy.drawn(s.y[i]) && s.x[Math.min(i + 1, s.x.length - 1)] >= view[0] && s.x[Math.max(i - 1, 0)] <= view[1];
      if (near) d += (down && s.kind !== 'points' ? 'L' : 'M') + sx.px(s.x[i]).toFixed(1) + ' ' + sy.px(s.y[i]).toFixed(1) + (s.kind === 'points' ? 'h0' : '');
      down = near;
    }
    return d;
  }
  function draw() {
    const whole = view[0] === plot.x.low && view[1] === plot.x.high, [low, high] = heights();
    sx = scale(plot.x, ...view, left, right);
    sy = scale(plot.y, low, high, bottom, top);
    still.style.display = whole ? '' : 'none';
    moving.replaceChildren();
    if (whole) { curves.innerHTML = as_drawn; return; }
    const along = ticks(plot.x, ...view, Math.max(3, Math.round((right - left) / 90))), up = ticks(plot.y, low, high, 6);
    for (const v of along) {
      make(moving, 'path', {class: 'grid', d: `M${sx.px(v)} ${top}V${bottom}`});
      make(moving, 'text', {class: 'tick', x: sx.px(v), y: bottom + 16, 'text-anchor': 'middle'}, plot.x.names[v - 1] ?? beside(v, along));
    }
    for (const v of up) {
      make(moving, 'path', {class: 'grid', d: `M${left} ${sy.px(v)}H${right}`});
      make(moving, 'text', {class: 'tick', x: left - 7, y: sy.px(v) + 4, 'text-anchor': 'end'}, beside(v, up));
    }
    curves.replaceChildren();
    for (const s of plot.series) make(curves, 'path', {class: s.style, d: path(s)});
  }
  function place(event) {
    const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(chart.getScreenCTM().inverse());
    return Math.min(right, Math.max(left, p.x));
  }
  function nearest(s, x) {
    let best = -1, far = Infinity;
    for (let i = 0; i < s.x.length; ++i) {
      const away = Math.abs(sx.px(s.x[i]) - sx.px(x));
      if (away < far && sy.drawn(s.y[i])) { far = away; best = i; }
    }
    return best;
  }
  function tell(px) {
    const x = sx.at(px), lines = [];
    let at = x;
    for (const s of plot.series) {
      const i = s.name ? nearest(s, x) : -1;
      if (i < 0) continue;
      if (!lines.length) at = s.x[i];
      lines.push(s.name + ' ' + text(s.y[i], 4) + (s.kind === 'points' ? ' at ' + (plot.x.names[s.x[i] - 1] ?? text(s.x[i], 4)) : ''));
    }
    if (!lines.length) return;
    lines.unshift(plot.x.label.replace(/ \(.*/, '') + ' ' + (plot.x.names[Math.round(at) - 1] ?? text(at, 6)));
    cursor.setAttribute('d', `M${px} ${top}V${bottom}`);
    say.replaceChildren();
    const box = make(say, 'rect', {class: 'card', rx: 4}), flip = px > (left + right) / 2;
    let width = 0;
    lines.forEach((line, i) => {
      const t = make(say, 'text', {x: 0, y: top + 17 + 16 * i}, line);
      width = Math.max(width, t.getComputedTextLength());
    });
    const x0 = Math.max(0, Math.min(right + 4 - width, flip ? px - width - 20 : px + 8));
    for (const t of say.querySelectorAll('text')) t.setAttribute('x', x0 + 6);
    for (const [key, value] of Object.entries({x: x0, y: top + 2, width: width + 12, height: 16 * lines.length + 6})) box.setAttribute(key, value);
  }
  function forget() { cursor.setAttribute('d', 'M0 0'); say.replaceChildren(); }
  chart.setAttribute('tabindex', '0');
  chart.addEventListener('pointerdown', e => {
    if (e.button === 0 && e.pointerType !== 'touch') { from = place(e); chart.setPointerCapture(e.pointerId); e.preventDefault(); chart.focus({preventScroll: true}); }
    tell(place(e));
  });
  chart.addEventListener('pointermove', e => {
    const at = place(e);
    if (from !== null) { shade.setAttribute('x', Math.min(at, from)); shade.setAttribute('width', Math.abs(at - from)); }
    tell(at);
  });
  chart.addEventListener('pointerup', e => {
    const at = place(e);
    if (from !== null && Math.abs(at - from) > 5) { look(sx.at(Math.min(at, from)), sx.at(Math.max(at, from))); forget(); }
    from = null;
    shade.setAttribute('width', 0);
  });
  chart.addEventListener('pointerleave', forget);
  const whole = () => { view = [plot.x.low, plot.x.high]; draw(); forget(); };
  chart.addEventListener('dblclick', whole);
  let held = null;
  chart.addEventListener('keydown', e => {
    held ??= (left + right) / 2;
    const step = (right - left) / 100, zoom = f => { const a = sx.px(view[0]), b = sx.px(view[1]);
      look(...[sx.at(held - (held - a) * f), sx.at(held + (b - held) * f)].map(v => Math.min(plot.x.high, Math.max(plot.x.low, v)))); };
    if (e.key === 'ArrowLeft' || e.key === 'ArrowRight') held = Math.min(right, Math.max(left, held + (e.key === 'ArrowLeft' ? -step : step)));
    else if (e.key === '+') zoom(.5);
    else if (e.key === '-') zoom(2);
    else if (e.key === 'Escape') { whole(); return; }
    else return;
    e.preventDefault();
    tell(held);
  });
  draw();
}
})();
