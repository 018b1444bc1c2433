#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rotation that is put into real captures, and seen there by channels of motion, stays in the rate.

    rotation.py --ifog build/release/tools/ifog/ifog --data ../shared/data [--check]

A sway, a surface wave and a ride of five times the rate's own scatter, each seen by an accelerometer that tilts, a
seismometer, a wheel, another gyro and an attitude: of the rotation the model may take 1 % (by least squares of the
correction on it), and --check exits 1 where it takes more. A capture that is refused keeps its rotation."""
import argparse
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
except ModuleNotFoundError:
    sys.exit(77)

import captures
from real_table import NAMES

MOST_ROWS = 4000
LONGEST_STEP = 0.8  # s, of a sway of 2 s
SPEED, GRAVITY = 900.0, 9.80665  # of the surface wave, m/s
PERIODS = {"sway": (2.0, 6.0), "wave": (15.0, 60.0), "ride": (40.0, 200.0)}  # s


def band(rng, t, periods):
    """Noise of unit variance between the periods."""
    dt = (t[-1] - t[0]) / (len(t) - 1)
    f = np.fft.rfftfreq(len(t), dt)
    spectrum = np.fft.rfft(rng.normal(size=len(t))) * ((f > 1 / periods[1]) & (f < 1 / periods[0]))
    x = np.fft.irfft(spectrum, len(t))
    return x / max(x.std(), 1e-300)


def moved(columns, kind, rng):
    """The capture with a rotation and what senses it; the rotation."""
    t = columns["time_s"]
    axis = captures.axes_of(columns)[0]
    rate = columns[f"rate_{axis}radps"]
    w = 5 * np.nanstd(np.diff(rate)) * band(rng, t, PERIODS[kind])
    angle = np.cumsum(w) * np.gradient(t)

    def seen(x):
        return x + 0.02 * x.std() * rng.normal(size=len(x))
    out = {k: v + w if k in (f"rate_{axis}radps", f"reference_rate_{axis}radps") else v for k, v in columns.items()}
    out["tilt_mps2"] = seen(GRAVITY * np.sin(angle))
    out["ground_mps2"] = seen(2 * SPEED * w)
    out["ground_mps"] = seen(2 * SPEED * angle)
    out["wheel_rpm"] = seen(1e3 * w)
    out["attitude_rad"] = seen(angle)
    out["gyro_b_radps"] = seen(w)
    return out, w, axis


def shortened(columns):
    """Means of rows and then a stretch of them, so that the search takes seconds and a sway is still one."""
    rows = len(columns["time_s"])
    m = min(-(-rows // MOST_ROWS), max(1, int(LONGEST_STEP / np.median(np.diff(columns["time_s"])))))
    kept = min(rows // m, MOST_ROWS)
    return {k: v[: kept * m].reshape(-1, m).mean(1) for k, v in columns.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ifog", required=True)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--only", nargs="*", default=[n for n in NAMES if "table" not in n] + ["kvh1750_direct_imu_rate"])
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    if not options.data.exists():
        print(f"skipped: {options.data} is not there")
        return 77
    worst = 0.0
    print("| capture | motion | removed | effects |\n|---|---|---|---|")
    for name in options.only:
        columns = shortened(captures.load(options.data, name))
        for k, kind in enumerate(PERIODS):
            with tempfile.TemporaryDirectory() as work:
                rng = np.random.default_rng([k, len(name)])
                turned, w, axis = moved(columns, kind, rng)
                report, model = captures.diagnosed(options.ifog, turned, Path(work),
                                                   *(["--axis", axis.strip("_")] if axis else []))
                if model is None:
                    print(f"| {name} | {kind} | refused | {report} |", flush=True)
                    continue
                left = captures.corrected(options.ifog, turned, model, Path(work))[axis]
            taken = turned[f"rate_{axis}radps"] - left
            there = np.isfinite(taken)
            share = abs(np.dot(taken[there], w[there]) / np.dot(w[there], w[there]))
            worst = max(worst, share)
            claims = ", ".join(f"{e['form']} of {e['channel']}" for e in report["effects"])
            print(f"| {name} | {kind} | {100 * share:.2f} % | {claims} |", flush=True)
    return 1 if options.check and worst > 0.01 else 0


if __name__ == "__main__":
    sys.exit(main())
