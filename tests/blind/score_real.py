#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Scores `ifog diagnose` on the noise of real sensors at rest, with channels borrowed from other captures.

Controls have no effect in these channels: each that is named is a false alarm. Into the others an effect of one channel is
implanted, linear, its rate or lagged, of 12 to 80 standard errors by white noise, flicker and random walk fitted to that piece.
FOLDER holds the measured captures (DATA of the other benches); a number makes its trial again."""
import argparse
import collections
import csv
import gzip
import json
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
except ModuleNotFoundError:
    sys.exit("score_real: numpy is missing for this Python; install python3-numpy")

import signals
from make_blind import write_csv
from noise import Noise

STEP_S = 0.5
MOST = 5000  # samples of a piece
FORMS = ("linear", "rate", "lagged")
SIZES = ((20, "12 to 20 sigma"), (40, "20 to 40 sigma"), (np.inf, "40 to 80 sigma"))


def read(folder, name):
    """Columns of a capture; an empty cell is nan."""
    with gzip.open(Path(folder) / f"{name}.csv.gz", "rt") as f:
        rows = list(csv.reader(line for line in f if not line.startswith("#")))
    table = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows[1:]])
    return dict(zip(rows[0], table.T))


def means(folder, name):
    """The same as means over STEP_S, the value before where a step has none."""
    columns = read(folder, name)
    t = columns.pop("time_s")
    step = ((t - t[0]) / STEP_S).astype(int)
    out = {}
    for column, x in columns.items():
        good = np.isfinite(x)
        count = np.bincount(step[good], minlength=step[-1] + 1)[: step[-1]]
        total = np.bincount(step[good], x[good], minlength=step[-1] + 1)[: step[-1]]
        held = np.maximum.accumulate(np.where(count > 0, np.arange(len(count)), 0))
        out[column] = (total / np.maximum(count, 1))[held]
    return out


def recordings(folder):
    """Rates of sensors at rest by name, and channels to borrow as (name, capture, series). Without a reference no channel of
    motion explains a rate, so accelerations are offered as pressures and rates as flows."""
    bridge, vehicle, mems, turned = (means(folder, name) for name in (
        "blueseis_bridge_rbam2", "rlg_vehicle", "adis16405_imu1", "kvh1750_direct_imu_rate"))
    table = read(folder, "fog_rate_table")  # a row each 16 s
    sway = next(x for name, x in bridge.items() if name.startswith("rate_"))
    sources = {"blueseis_bridge_rbam2": sway,
               "adis16405_imu1": next(x for name, x in mems.items() if name.startswith("rate_"))}
    sources.update({f"rlg_vehicle {axis}": vehicle[f"rate_{axis}_radps"][1100:] for axis in "xyz"})
    channels = [(f"flow_{name.split('_')[1]}_lpm", "kvh1750", x) for name, x in turned.items()
                if name.startswith("rate_")]
    for name, x in vehicle.items():
        if not name.startswith("rate_"):
            channels.append((f"pressure_{name.split('_')[1]}_Pa" if name.startswith("accel_") else name, "rlg_vehicle", x))
    channels.append(("temperature_degC", "fog_rate_table", table["temperature_degC"]))
    channels.append(("flow_lpm", "fog_rate_table", table["reference_rate_radps"]))
    channels.append(("flow_other_lpm", "blueseis_bridge_rbam2", signals.lowpass(sway, 60.0, STEP_S)))
    return sources, channels


def borrowed(rng, x, n):
    """A random part of x, stretched to n samples, backwards in every other trial."""
    length = len(x) * rng.uniform(0.3, 1.0)
    start = rng.uniform(0, len(x) - length)
    share = np.arange(n) / n
    at = start + (1 - share if rng.uniform() < 0.5 else share) * (length - 1)
    return np.interp(at, np.arange(len(x)), x)


def fitted_noise(x):
    """White noise, flicker and walk of greatest likelihood over a grid of their ratios."""
    best, least = None, np.inf
    impulse = np.zeros(len(x))
    impulse[0] = 1.0
    for crossing_s in (30.0, 100.0, 300.0, 1000.0, 1e4, 1e6):
        for flicker_s in (20.0, 60.0, 200.0, 1000.0, 1e6):
            B, K = 1 / (0.664 * np.sqrt(flicker_s)), np.sqrt(3.0) / crossing_s
            whiten = Noise.known(STEP_S, 1.0, B, K).whitener(len(x))
            size = np.sqrt(np.mean(whiten(x - np.mean(x)) ** 2))
            cost = np.log(size) - np.log(whiten(impulse)[0])
            if cost < least:
                best, least = Noise.known(STEP_S, size, B * size, K * size), cost
    return best


def effect_of(rng, form, x):
    """A lag is settled at the beginning of the record, so that the first value's noise does not decay like a warm-up."""
    if form == "linear":
        return x
    tau = np.exp(rng.uniform(np.log(60.0), np.log(300.0)))
    before = np.mean(x[: int(tau / STEP_S)])
    slow = signals.lowpass(np.concatenate([[before], x]), tau, STEP_S)[1:]
    return (x - slow) / tau if form == "rate" else slow


def trial(ifog, number, implanted, sources, channels, folder):
    """What one trial was and what became of it."""
    rng = np.random.default_rng([number, 77])
    name = list(sources)[number % len(sources)]
    x = sources[name]
    n = min(len(x), MOST)
    start = int(rng.uniform(0, len(x) - n))
    rate = x[start : start + n].copy()
    columns = {c: borrowed(rng, y, n) for c, capture, y in channels if not name.startswith(capture)}
    out = {"number": number, "source": name, "form": None, "channel": None, "sigma": 0.0}
    if implanted:
        out["form"], out["channel"] = str(rng.choice(FORMS)), str(rng.choice(list(columns)))
        effect = effect_of(rng, out["form"], columns[out["channel"]])
        out["sigma"] = float(np.exp(rng.uniform(np.log(12.0), np.log(80.0))))
        rate += effect * out["sigma"] / fitted_noise(rate).sigma(effect)
    write_csv(folder / "piece.csv", {"time_s": STEP_S * np.arange(n), "rate_radps": rate, **columns})
    subprocess.run([ifog, "diagnose", folder / "piece.csv", "--quiet", "--json", folder / "d.json"], check=True,
                   stdout=subprocess.DEVNULL)
    claims = [e for e in json.loads((folder / "d.json").read_text())["effects"] if e.get("channel")]
    here = [e for e in claims if e["channel"] == out["channel"] and not e.get("with") and not e.get("minus_channel")]
    out.update(found=bool(here), named=any(e["form"] == out["form"] for e in here), others=len(claims) > len(here),
               claims=[f"{e['form']} {e['channel']}" for e in claims])
    return out


def tables(trials):
    controls = [t for t in trials if not t["form"]]
    implanted = [t for t in trials if t["form"]]
    out = ["| real noise, foreign channels | trials | explained by a channel |", "|---|---|---|"]
    for name, some in [*grouped(controls, lambda t: t["source"]), ("all", controls)]:
        out.append(f"| {name} | {len(some)} | {sum(t['others'] for t in some)} |")
    out += ["", "| implanted | trials | channel found | form too | another channel besides |", "|---|---|---|---|---|"]
    for key in (lambda t: t["form"], lambda t: next(name for most, name in SIZES if t["sigma"] < most),
                lambda t: t["source"], lambda t: "all"):
        for name, some in grouped(implanted, key):
            out.append(f"| {name} | {len(some)} | " + " | ".join(
                str(sum(t[what] for t in some)) for what in ("found", "named", "others")) + " |")
    return "\n".join(out)


def grouped(trials, key):
    groups = collections.defaultdict(list)
    for t in trials:
        groups[key(t)].append(t)
    return sorted(groups.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="of the measured captures")
    parser.add_argument("--ifog", required=True, help="the program")
    parser.add_argument("--first", type=int, default=0, help="number")
    parser.add_argument("--count", type=int, default=20, help="of controls, and of implanted effects")
    options = parser.parse_args()
    sources, channels = recordings(options.folder)
    trials = []
    with tempfile.TemporaryDirectory() as scratch:
        for number in range(options.first, options.first + options.count):
            for implanted in (False, True):
                t = trial(options.ifog, number, implanted, sources, channels, Path(scratch))
                trials.append(t)
                if t["others"] or (implanted and not t["found"]):
                    print(f"{number} {t['source']}: {t['form'] or 'nothing'} {t['channel'] or 'implanted'}, "
                          f"{t['sigma']:.0f} sigma; found: {', '.join(t['claims']) or 'nothing'}", flush=True)
    print(tables(trials))
    return 0


if __name__ == "__main__":
    sys.exit(main())
