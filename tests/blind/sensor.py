# SPDX-License-Identifier: Apache-2.0
"""A sensor from its seed: noise, place, hidden effects, faults of the logger, two captures and the truth."""
from dataclasses import dataclass

import numpy as np

import kinds_rate
import limits
import logger
from kinds import KINDS, effect_of
from noise import GRADES, Noise
from world import EARTH, SLOW, Plan, World

VISIBLE, FAINT = (12.0, 80.0), (1.0, 3.0)  # GLS visibility, sigma
SPECIAL = {"reference logged late", "Earth's rate while tilting"}  # nothing is wrong with these gyros


@dataclass
class Capture:
    t: np.ndarray
    columns: dict  # name -> series, the rate first
    effect: np.ndarray  # rad/s, what a perfect correction takes away
    parts: list  # of each effect, in the order of the truth
    rate: np.ndarray  # true rotation about the sensor's axis, sway included
    own: np.ndarray  # the sensor's noise
    accidents: bool = False  # whether holes, glitches and the like struck it


@dataclass
class Making:
    """What a sensor was made of, for whoever asks what could be known of it."""
    hidden: list  # kinds of the effects
    laws: list
    sizes: list
    noise: Noise
    worlds: list
    intact: list  # of each capture the columns before a logger's faults
    uncut: list  # captures with the faults, before rows are cut
    kept: list  # which rows are in the capture


@dataclass
class Sensor:
    truth: dict
    captures: list
    making: Making


def draw_role(rng, seed, only):
    """Kind names of the hidden effects and their visibility; kinds go in turn, so that each gets its share."""
    names = list(KINDS)
    name = only or names[seed % len(names)]
    role = rng.choice(["clean", "faint", "visible"], p=[0.2, 0.08, 0.72])
    if name in SPECIAL:
        return "visible", [name]
    if role == "clean":
        return "clean", []
    chosen = [name]
    if role == "visible" and rng.uniform() < 0.12:
        here = KINDS[name]
        others = [k for k in names if k not in SPECIAL and k != name and KINDS[k].cover == "design"
                  and KINDS[k].linear and not KINDS[k].flags and set(KINDS[k].platforms) & set(here.platforms)
                  and not set(sum(map(list, KINDS[k].channels), [])) & set(sum(map(list, here.channels), []))]
        if here.cover == "design" and not here.flags and others:
            chosen.append(str(rng.choice(others)))
    return str(role), chosen


def make(seed, only=None, several=False):
    """The sensor of a seed; `only`: of this kind, whatever its turn; `several`: with a capture more to diagnose, last,
    in the environment of the second one and with surroundings of its own."""
    rng = np.random.default_rng([seed, 0x1F06])
    role, names = draw_role(rng, seed, only)
    # a clean sensor stands where a sensor with this seed's kind would stand
    hosts = [KINDS[k] for k in (names or [only or list(KINDS)[seed % len(KINDS)]])]
    platforms = set(hosts[0].platforms).intersection(*(h.platforms for h in hosts))
    platform = str(rng.choice(sorted(platforms)))
    outside = bool(rng.uniform() < 0.5)
    flags = frozenset().union(*(h.flags for h in hosts))
    plan = Plan(rng, platform, outside, confounded="confounded" in flags)
    noise = Noise(rng, str(rng.choice(list(GRADES))), plan.dt)
    _surroundings(rng, noise, plan)
    hidden = [KINDS[k] for k in names]
    laws = [k.law(rng, plan) for k in hidden]
    host_law = laws[0] if laws else hosts[0].law(rng, plan)
    worlds = [World(rng, plan, which) for which in (0, 1)]
    sizes, sigmas = _sizes(rng, role, hidden, laws, worlds[0], noise)
    wanted = _columns(rng, hosts, platform)
    intact = [_record(rng, w, noise, hidden, laws, sizes, wanted, flags, host_law) for w in worlds]
    if role == "clean":
        _unrest(rng, noise, intact[0])
    if rng.uniform() < 0.15:
        for capture in intact:  # a logger without real-time clock
            capture.t = capture.t + rng.uniform(-0.05, 0.05, len(capture.t)) * plan.dt
    causal = [c for h in hosts for group in h.channels for c in group]
    faults = _faults(rng, intact[0], causal, flags)
    limit = limits.second_capture(noise, worlds, [(k, law, size) for k, law, size in zip(hidden, laws, sizes)
                                                  if k.name not in SPECIAL])
    truth = _truth(seed, role, hidden, laws, plan, noise, sizes, sigmas, faults, intact)
    truth["limit_radps"] = limit
    truth["stale_radps"] = limits.from_stale_channels(worlds[1], intact[1].effect, logger.staleness(faults, causal))
    columns = [{name: x.copy() for name, x in capture.columns.items()} for capture in intact]
    captures, kept = zip(*(_damage(rng, w, capture, faults) for w, capture in zip(worlds, intact)))
    captures = list(captures)
    if several:
        again = np.random.default_rng([seed, 0x1F06, 2])
        world = World(again, plan, 1)
        extra = _record(again, world, noise, hidden, laws, sizes, wanted, flags, host_law)
        captures.append(_damage(again, world, extra, faults)[0])
    truth["samples"], truth["accidents"] = len(captures[0].t), [c.accidents for c in captures]
    return Sensor(truth, captures, Making(hidden, laws, sizes, noise, worlds, columns, intact, list(kept)))


def _surroundings(rng, noise, plan):
    """A structure that sways and lines, in parts of the white noise of one sample."""
    white = noise.N / np.sqrt(plan.dt)
    chance = {"structure": 0.8, "laboratory": 0.25, "sled": 0.25}.get(plan.platform, 0.0)
    if plan.rate_hz >= 2 and rng.uniform() < chance:
        for _ in range(rng.integers(1, 3)):
            hz = rng.uniform(0.25, min(1.5, 0.4 * plan.rate_hz))
            noise.sways.append((hz, rng.uniform(0.002, 0.02), white * np.exp(rng.uniform(0, np.log(50)))))
    if rng.uniform() < 0.25 and plan.platform != "rate table":
        noise.lines.append((rng.uniform(0.05, 0.45) * plan.rate_hz, 1e-5, white * rng.uniform(0.1, 1.0)))


def _unrest(rng, noise, capture):
    """Clean sensors are no textbook either: a louder stretch, or a few blows."""
    own, white, n = np.zeros(len(capture.own)), noise.N / np.sqrt(noise.dt), len(capture.own)
    kind = rng.choice(["none", "louder", "blows"], p=[0.7, 0.15, 0.15])
    if kind == "louder":
        start = int(rng.uniform(0, 0.6) * n)
        stop = start + int(rng.uniform(0.1, 0.3) * n)
        own[start:stop] = rng.uniform(1, 3) * white * rng.normal(size=stop - start)
    elif kind == "blows":
        own[rng.integers(0, n, rng.integers(1, 12))] = white * rng.uniform(10, 60)
    capture.own = capture.own + own
    rate = next(iter(capture.columns))
    capture.columns[rate] = capture.columns[rate] + own


def _sizes(rng, role, hidden, laws, world, noise):
    low, high = FAINT if role == "faint" else VISIBLE
    sizes, sigmas = [], []
    for k, law in zip(hidden, laws):
        if k.name in SPECIAL:
            sizes.append(1.0)
            sigmas.append(noise.sigma(k.shape(world, law)) if "motion" in k.flags else 0.0)
            continue
        sigma = float(np.exp(rng.uniform(np.log(low), np.log(high))))
        if k.linear:
            sizes.append(sigma / noise.sigma(k.shape(world, law)))
        else:
            sizes.append(_size_of(k, law, world, noise, sigma))
        sigmas.append(noise.sigma(effect_of(k, law, sizes[-1], world)))
    return sizes, sigmas


def _size_of(k, law, world, noise, sigma):
    """Size of an effect that is not in proportion to it, by halving its logarithm."""
    low, high = -9.0, 2.0
    for _ in range(22):
        at = (low + high) / 2
        found = noise.sigma(effect_of(k, law, world.plan.top_rate * 10**at if k.name == "dead zone" else 10**at, world))
        low, high = (at, high) if found < sigma else (low, at)
    return world.plan.top_rate * 10**at if k.name == "dead zone" else 10**at


def _columns(rng, hosts, platform):
    need = [q for h in hosts for q in h.quantities]
    pool = [q for q in SLOW if q not in ("switch", "coil")]
    extra = [str(q) for q in rng.permutation(pool)[: rng.integers(2, 6)]]
    if rng.uniform() < 0.3:
        extra.append("coil" if "coil" not in need else "laser")
    if rng.uniform() < 0.15:
        extra.append("switch")
    if platform == "ramp logger":
        extra = extra[:2]
    return list(dict.fromkeys(need + extra))


def _record(rng, w, noise, hidden, laws, sizes, wanted, flags, host_law):
    own, motion, lines = noise.draw(rng, w.n)
    parts = [effect_of(k, law, size, w) for k, law, size in zip(hidden, laws, sizes)]
    effect = sum(parts, np.zeros(w.n))
    rate = w.rate + motion
    if "motion" in flags and hidden:
        rate = hidden[0].shape(w, laws[0]) + motion
    measured = rate + own + lines + effect
    axis = "x_" if "three axes" in flags else ""
    columns = {f"rate_{axis}radps": measured}
    if axis:
        for other in "yz":
            columns[f"rate_{other}_radps"] = w.q["turn_" + other] + noise.draw(rng, w.n)[0]
    if w.plan.platform == "rate table":
        encoder = 0.1 * noise.N / np.sqrt(w.dt)
        late = int(host_law["late"]) if "late reference" in flags and hidden else 0
        reference = np.concatenate([np.full(late, rate[0]), rate[: w.n - late]])
        columns[f"reference_rate_{axis}radps"] = reference + encoder * rng.normal(size=w.n)
        if axis:
            for other in "yz":
                columns[f"reference_rate_{other}_radps"] = w.q["turn_" + other] + encoder * rng.normal(size=w.n)
    if "ramp" in flags:
        phase = kinds_rate.ramp_phase(w, host_law)
        columns["ramp_counts"] = np.floor(np.mod(phase, 1.0) * 32768)
    columns.update(w.columns(rng, wanted))
    return Capture(w.t, columns, effect, parts, rate, own + lines)


def _faults(rng, capture, causal, flags):
    if rng.uniform() > 0.35 or flags & {"late reference", "ramp", "three axes"}:
        return []
    channels = {c: 0 for c in capture.columns if "rate_" not in c}
    return logger.draw(rng, channels, causal) if channels else []


def _damage(rng, w, capture, faults):
    """Rows cut, columns spoilt, and which rows stayed; accidents befall the second capture only one time in four."""
    struck = w.which == 0 or bool(rng.uniform() < 0.25)
    keep = logger.apply(rng, faults, capture.columns, w.t, struck)
    cut = {name: x[keep] for name, x in capture.columns.items()}
    struck = struck and any(f["kind"] in logger.ACCIDENTS for f in faults)
    return Capture(capture.t[keep], cut, capture.effect[keep], [p[keep] for p in capture.parts], capture.rate[keep],
                   capture.own[keep], struck), keep


def _share_outside(captures, column):
    first, second = (c.columns[column] for c in captures)
    return float(np.mean((second < first.min()) | (second > first.max())))


def _truth(seed, role, hidden, laws, plan, noise, sizes, sigmas, faults, captures):
    effects = []
    for i, (k, size, sigma) in enumerate(zip(hidden, sizes, sigmas)):
        named = [c for group in k.channels for c in group if c in captures[0].columns]
        effects.append({
            "kind": k.name, "form": k.form, "channel": named[0] if named else None, "cover": k.cover,
            "channels": [[c for c in group if c in captures[0].columns] for group in k.channels],
            "flags": sorted(k.flags), "size": float(size), "sigma": float(sigma),
            "outside_share": max((_share_outside(captures, c) for c in named), default=0.0),
            "rms_radps": [float(np.std(c.parts[i])) for c in captures]})
    line = next((law["hz"] for k, law in zip(hidden, laws) if k.form == "line"), None)
    return {"schema": "ifog.blind/1", "line_hz": line, "seed": seed, "role": role, "platform": plan.platform,
            "kind": " + ".join(k.name for k in hidden) or "nothing", "outside": plan.outside,
            "sample_rate_hz": plan.rate_hz, "earth_radps": float(EARTH),
            "noise": {"N": noise.N, "B": noise.B, "K": noise.K, "Q": noise.Q, "sways": noise.sways,
                      "lines": noise.lines},
            "faults": faults, "effects": effects}
