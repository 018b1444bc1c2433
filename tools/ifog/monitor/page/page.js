// SPDX-License-Identifier: Apache-2.0
// Asks once a second, draws, and shows nothing as of now that is not. Whatever it receives is text: names come from the network.
'use strict';
const DEGREE = Math.PI / 180, HOURLY = DEGREE / 3600, STALE_S = 3;
let chosen = '', answer = null, answered = -Infinity;
const $ = id => document.getElementById(id);
const colour = name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
const axisColour = name => colour(['x', 'y', 'z'].includes(name) ? name : 'x');

function add(parent, tag, text = '', kind = '') {
  const made = Object.assign(document.createElement(tag), { textContent: text, className: kind });
  parent.append(made);
  return made;
}

// °/h for a rate that people call slow, else °/s; of the figures and the picture alike.
function unitOf(values) {
  const most = values.reduce((m, v) => v === null ? m : Math.max(m, Math.abs(v)), 0);
  return most < 0.1 * DEGREE ? { is: HOURLY, name: '°/h', digits: 4 } : { is: DEGREE, name: '°/s', digits: 5 };
}
const number = (value, unit) => typeof value === 'number' ? (value / unit.is).toFixed(unit.digits) : '–';

// The step of a scale with at most so many: 1, 2 or 5 times a power of ten.
function stepOf(span, most) {
  const raw = span / most, ten = 10 ** Math.floor(Math.log10(raw));
  return ten * [1, 2, 5, 10].find(n => n * ten >= raw * 0.999);
}

// A canvas as wide as it is shown, in CSS pixels, emptied.
function sheet(canvas) {
  const box = canvas.getBoundingClientRect(), dense = window.devicePixelRatio || 1;
  canvas.width = Math.round(box.width * dense);
  canvas.height = Math.round(box.height * dense);
  const pen = canvas.getContext('2d');
  pen.scale(dense, dense);
  pen.font = '12px system-ui, "DejaVu Sans", sans-serif';
  return { pen, width: box.width, height: box.height };
}

function grid(pen, from, to, text, at) {
  line(pen, [from, to], colour('grid'), 1);
  pen.fillStyle = colour('faint');
  pen.fillText(text, ...at);
}

function line(pen, points, of, wide = 2) {
  pen.strokeStyle = of;
  pen.lineWidth = wide;
  pen.beginPath();
  let down = false;
  for (const point of points) {
    if (point) down ? pen.lineTo(...point) : pen.moveTo(...point);
    down = Boolean(point);
  }
  pen.stroke();
}

// The last two minutes: raw from the least to the greatest of each second, denoised as a line. A second without samples stays empty.
function drawMinutes(canvas, axis) {
  const { pen, width, height } = sheet(canvas), seen = axis.seconds.flat().filter(v => v !== null), MOST = 120;
  if (!seen.length) return;
  const unit = unitOf(seen), least = Math.min(...seen) / unit.is, most = Math.max(...seen) / unit.is;
  const room = Math.max((most - least) * 0.06, Math.abs(most) * 1e-6, 1e-9), low = least - room, high = most + room;
  const step = stepOf(high - low, height / 36), digits = Math.max(0, Math.min(9, -Math.floor(Math.log10(step) + 1e-9)));
  const labels = [];
  for (let v = Math.ceil(low / step) * step; v <= high; v += step) labels.push([v, v.toFixed(digits)]);
  const left = Math.max(...labels.map(([, text]) => pen.measureText(text).width), 20) + 8, foot = height - 18, bar = (width - left) / MOST;
  const x = i => width - (axis.seconds.length - i - 0.5) * bar, y = v => foot - (v / unit.is - low) / (high - low) * (foot - 8);
  for (const [v, text] of labels) grid(pen, [left, y(v * unit.is)], [width, y(v * unit.is)], text, [0, y(v * unit.is) + 4]);
  for (const ago of [120, 90, 60, 30, 0]) {
    const at = width - ago * bar, text = ago ? `−${ago} s` : 'now', wide = pen.measureText(text).width;
    grid(pen, [at, foot], [at, foot + 4], text, [Math.min(Math.max(at - wide / 2, left), width - wide), height - 3]);
  }
  pen.fillStyle = colour('raw');
  axis.seconds.forEach(([from, to], i) => from !== null && pen.fillRect(x(i) - bar / 2, y(to), bar + 0.5, Math.max(1, y(from) - y(to))));
  line(pen, axis.seconds.map(([, , v], i) => v === null ? null : [x(i), y(v)]), axisColour(axis.name));
  return unit;
}

function drawAllan(sensor) {
  const curves = sensor.axes.map(axis => ({ name: axis.name, points: axis.allan.map((v, k) => [sensor.allan_tau0_s * 2 ** k, v / HOURLY])
    .filter(([tau, v]) => tau > 0 && v > 0) })).filter(curve => curve.points.length);
  $('allan').hidden = !curves.length;
  if (!curves.length) return;
  const { pen, width, height } = sheet($('allan').querySelector('canvas')), all = curves.flatMap(curve => curve.points);
  const ends = k => [Math.floor(Math.min(...all.map(p => Math.log10(p[k])))), Math.ceil(Math.max(...all.map(p => Math.log10(p[k]))) + 1e-9)];
  const [[left10, right10], [low10, high10]] = [ends(0), ends(1)], left = 52, foot = height - 20;
  const x = tau => left + (Math.log10(tau) - left10) / (right10 - left10) * (width - left - 16), y = v => foot - (Math.log10(v) - low10) / (high10 - low10) * (foot - 8);
  const name = k => k < -3 || k > 4 ? `1e${k}` : String(Number((10 ** k).toPrecision(1)));
  for (let k = low10; k <= high10; ++k) grid(pen, [left, y(10 ** k)], [width, y(10 ** k)], name(k), [0, y(10 ** k) + 4]);
  for (let k = left10; k <= right10; ++k) grid(pen, [x(10 ** k), 8], [x(10 ** k), foot], name(k), [x(10 ** k) - 8, height - 4]);
  for (const { name: axis, points } of curves) {
    line(pen, points.map(([tau, v]) => [x(tau), y(v)]), axisColour(axis));
    pen.fillStyle = axisColour(axis);
    for (const [tau, v] of points) pen.fillRect(x(tau) - 2, y(v) - 2, 4, 4);
    const [tau, v] = points.at(-1);
    pen.fillText(axis === 'rate' ? '' : axis, x(tau) + 5, y(v) + 4);
  }
}

function drawAxes(sensor, stale) {
  const place = $('axes');
  while (place.children.length > sensor.axes.length) place.lastChild.remove();
  while (place.children.length < sensor.axes.length) {
    const made = add(place, 'section');
    add(made, 'p', '', 'figures');
    add(made, 'canvas').setAttribute('role', 'img');
    add(made, 'p', '', 'legend');
  }
  sensor.axes.forEach((axis, a) => {
    const [figures, canvas, legend] = place.children[a].children, now = stale ? {} : axis;
    const unit = unitOf([now.rate_radps ?? 0]), picture = drawMinutes(canvas, axis);
    figures.replaceChildren();
    add(figures, 'b', `${axis.name} ${number(now.rate_radps, unit)} ${unit.name}`).style.color = axisColour(axis.name);
    const noise = unitOf([now.raw_noise_radps ?? 0]);
    add(figures, 'span', `noise ${number(now.noise_radps, noise)} (raw ${number(now.raw_noise_radps, noise)}) ${noise.name}`);
    add(figures, 'span', `angle ${number(now.angle_rad, { is: DEGREE, digits: 6 })}°`);
    legend.textContent = picture ? `last two minutes, ${picture.name}: denoised (line), raw from its least to its greatest` : 'no samples in the last two minutes';
    canvas.setAttribute('aria-label', `${axis.name}: ${legend.textContent}`);
  });
}

function show() {
  const silent_s = (performance.now() - answered) / 1000, stale = silent_s > STALE_S || (answer && answer.age_s > STALE_S);
  document.body.classList.toggle('stale', Boolean(stale));
  const now = $('now');
  now.className = stale ? 'bad' : '';
  if (!answer) return void (now.textContent = stale && silent_s !== Infinity ? 'no answer from ifog monitor' : 'connecting');
  now.textContent = silent_s > STALE_S ? `no answer from ifog monitor for ${Math.round(silent_s)} s: what stands here is old` :
    stale ? `ifog monitor is delayed by ${Math.round(answer.age_s)} s` : answer.waiting;
  const sensor = answer.sensor;
  $('sensors').replaceChildren();
  for (const [name, tone, shown] of answer.sensors) {
    const button = add($('sensors'), 'button', shown, stale ? 'plain' : tone);
    button.setAttribute('aria-pressed', String(name === answer.chosen));
    button.onclick = () => { chosen = name; ask(); };
  }
  if (!sensor) return;
  drawAxes(sensor, stale);
  drawAllan(sensor);
  $('lines').replaceChildren();
  if (!stale) for (const [tone, text] of sensor.lines) add($('lines'), 'p', text.trim(), tone);
}

async function ask() {
  try {
    const got = await fetch('data?sensor=' + encodeURIComponent(chosen), { signal: AbortSignal.timeout(2500) });
    if (!got.ok) throw new Error(got.statusText);
    answer = await got.json();
    answered = performance.now();
  } catch { /* show() says since when */ }
  show();
}

async function keepAsking() {
  await ask();
  setTimeout(keepAsking, 1000);
}
document.addEventListener('visibilitychange', show);
window.addEventListener('resize', show);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', show);
keepAsking();
