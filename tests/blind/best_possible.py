#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What could be had at all: the effect that is left in the second capture by a fit which knows the law.

The form of each hidden effect is known, the noise, and how the generator draws the law's constants. What a diagnosis
would have to estimate is estimated, from the first capture alone: the size, with no idea of it, and every real
constant (place, width, time constant, phase, weights), with what its draws are like as prior. That is generalised least
squares in the true noise, by Gauss and Newton from the truth. The law is then worked out in the second capture on
the readings the daemon has, and what it leaves of the effect counted as the judge counts it (`judge.errors`).

Better than any program can be: rows of a hole and what a stuck channel was are known in the fit, a logger's delay is
known, and of two fits, one on the quantities as they were and one on the readings, that counts which does better in
the second capture. A dead zone's floor is its whole effect: what a sensor did not see nobody gives back."""
import argparse
import json
import sys
from pathlib import Path

try:
    import numpy as np
except ModuleNotFoundError:
    sys.exit("best_possible: numpy is missing for this Python; install python3-numpy")

import kinds_rate
import logger
import signals
import tables
from kinds import effect_of
from sensor import SPECIAL, make
from world import SLOW

DRAWS = 200  # of a law, for its prior
STEP = 1e-3  # of a constant's spread, for the slopes
ROUNDS = 12
KNOWN = ("start", "wrap", "seed", "late")  # what the logged column of a ramp says, or no constant of the effect


class Readings:
    """A world as its logger shows it: the same members, quantities from the columns where one is logged.
    `repaired`: what befell this record (holes, stuck stretches, glitches) is put right, what is wired is not."""

    def __init__(self, world, columns, intact, faults, repaired):
        self.plan, self.which, self.dt, self.n, self.t = world.plan, world.which, world.dt, world.n, world.t
        self.rate, self.q = world.rate, dict(world.q)
        for name in world.q:
            column = SLOW[name][6] if name in SLOW else "table_rad" if name == "angle" else name + "_mps2"
            if column in columns:
                own = [f for f in faults if f["column"] == column]
                struck = any(f["kind"] in logger.ACCIDENTS for f in own)
                x = intact[column] if repaired and struck else columns[column]
                if repaired and struck:
                    for f in own:
                        x = logger.wiring(f, x, self.dt) if f["kind"] in logger.WIRING else x
                self.q[name] = _waited_for(_held(x, world.q[name]), own, self.dt)


def _held(x, truth):
    """The last reading that can be one, as a daemon has it."""
    room = 2 * np.ptp(truth) + 1
    good = np.isfinite(x) & (np.abs(np.nan_to_num(x) - truth.mean()) < room)
    last = np.maximum.accumulate(np.where(good, np.arange(len(x)), 0))
    last[: np.argmax(good)] = np.argmax(good)
    return x[last]


def _waited_for(x, faults, dt):
    """An early channel, used when its time has come."""
    for f in faults:
        if f["kind"] == "early":
            steps = max(1, int(round(f["seconds"] / dt)))
            x = np.concatenate([np.full(steps, x[0]), x[:-steps]])
    return x


class Law:
    """Sizes and free constants of a sensor's effects as one vector."""

    def __init__(self, hidden, laws, sizes, plan):
        self.hidden, self.laws, self.sizes = hidden, laws, sizes
        self.places, self.start, self.centre, self.spread = [], list(sizes), [0.0] * len(sizes), [np.inf] * len(sizes)
        rng = np.random.default_rng(7)
        for i, (k, law) in enumerate(zip(hidden, laws)):
            drawn = [k.law(rng, plan) for _ in range(DRAWS)]
            for name, value in law.items():
                if name in KNOWN or not isinstance(value, (float, np.ndarray)):
                    continue
                for j in range(np.size(value)):
                    some = [np.ravel(d[name])[j] for d in drawn]
                    self.places.append((i, name, j))
                    self.start.append(float(np.ravel(value)[j]))
                    self.centre.append(np.mean(some))
                    self.spread.append(max(np.std(some), 1e-12))
        self.start, self.centre, self.spread = map(np.array, (self.start, self.centre, self.spread))
        self.scale = np.where(np.isfinite(self.spread), self.spread, np.abs(self.start))

    def effect(self, world, at):
        laws = [{name: np.array(v, float) if isinstance(v, np.ndarray) else v for name, v in law.items()}
                for law in self.laws]
        for (i, name, j), value in zip(self.places, at[len(self.sizes):]):
            if isinstance(laws[i][name], np.ndarray):
                laws[i][name][j] = value
            else:
                laws[i][name] = max(value, 1e-3) if name in ("tau", "width") else value
        return sum(effect_of(k, law, size, world) for k, law, size in zip(self.hidden, laws, at))


def fitted(law, world, measured, noise):
    """The constants by generalised least squares with the prior, a constant rate beside them."""
    whiten = noise.whitener(world.n)
    one = whiten(np.ones(world.n))
    one = one / np.sqrt(one @ one)

    def seen(x):
        white = whiten(x - x[0])
        return white - one * (one @ white)

    def loss(at):
        left = seen(measured - law.effect(world, at))
        prior = np.where(np.isfinite(law.spread), (at - law.centre) / law.spread, 0.0)
        return left @ left + prior @ prior, left

    at = law.start.copy()
    now, left = loss(at)
    for _ in range(ROUNDS):
        slopes = []
        for i in range(len(at)):
            moved = at.copy()
            moved[i] += STEP * law.scale[i]
            slopes.append(seen(law.effect(world, moved) - law.effect(world, at)) / STEP)
        slopes = np.array(slopes)
        tight = np.where(np.isfinite(law.spread), (law.scale / law.spread) ** 2, 0.0)
        pull = np.where(np.isfinite(law.spread), (law.centre - at) * law.scale / law.spread**2, 0.0)
        step = np.linalg.pinv(slopes @ slopes.T + np.diag(tight), rcond=1e-13) @ (slopes @ left + pull) * law.scale
        for shorter in 0.5 ** np.arange(12):
            then, left_then = loss(at + shorter * step)
            if then < now:
                break
        else:
            return at
        at, gain, now, left = at + shorter * step, now - then, then, left_then
        if gain < 1e-3:
            return at
    return at


def floor(seed, only=None):
    """What is left of the effect in the second capture, in parts of the sensor's noise there; nan where none is."""
    sensor = make(seed, only)
    made = sensor.making
    hidden = [i for i, k in enumerate(made.hidden) if k.name not in SPECIAL]
    if not hidden:
        return float("nan")
    seconds = made.worlds[0].dt if "ramp" in sensor.truth["kind"] else 10.0
    second = sensor.captures[1]
    own = signals.rms(second.own, made.worlds[1].dt, seconds)
    if any(not made.hidden[i].linear for i in hidden):
        return signals.rms(second.effect, made.worlds[1].dt, seconds) / own
    law = Law([made.hidden[i] for i in hidden], [made.laws[i] for i in hidden], [made.sizes[i] for i in hidden],
              made.worlds[0].plan)
    faults = sensor.truth["faults"]
    first, after = ((w, c.columns, i) for w, c, i in zip(made.worlds, made.uncut, made.intact))
    # the structure's motion stays in what is fitted: no instrument beside the sensor tells it
    measured = next(iter(made.uncut[0].columns.values())) - made.worlds[0].rate
    here = Readings(*after, faults, repaired=False)
    left = []
    for world in (made.worlds[0], Readings(*first, faults, repaired=True)):
        rest = made.uncut[1].effect - law.effect(here, fitted(law, world, measured, made.noise))
        left.append(signals.rms(rest[made.kept[1]], here.dt, seconds) / own)
    return min(left)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scored", nargs="+", help="JSON files that score_blind.py wrote")
    options = parser.parse_args()
    records = [r for name in options.scored for r in json.loads(Path(name).read_text())["sensors"]]
    rows = []
    for r in records:
        if tables.judged_by_error(r):
            found = floor(r["seed"])
            rows.append((tables.left_range(r), tables.relative(r), found))
            print(f"{r['seed']} {r['verdict']:9} {r['truth']['kind']} error {tables.relative(r):.3f} floor {found:.3f} "
                  f"{'outside' if rows[-1][0] else 'inside'}", flush=True)
    for name, outside in (("inside", False), ("outside", True)):
        some = np.array([(e, f) for out, e, f in rows if out == outside])
        if len(some):
            error, best = (f"{np.median(x):.3f}; {np.quantile(x, 0.9):.2f}" for x in some.T)
            print(f"{name}, {len(some)} sensors, median; 90 %: error {error}, floor {best}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
