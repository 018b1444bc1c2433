#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Real captures on data held out of the fit: raw, a plain engineer's fit, and ifog's own.

    real_table.py --ifog build/release/tools/ifog/ifog --data ../shared/data [--more FOLDER] [--check]

RMS of 1 s means (of points, of a rate table), deg/h; with a reference the mean counts, without one it does not. Exits
1 with --check where ours is above 1.1 of a plain fit that gains more than a tenth, or above 1.02 of raw elsewhere."""
import argparse
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
except ModuleNotFoundError:
    sys.exit(77)

import captures
from plain_fit import error_of, plain_fit

NAMES = ("mems_with_fog_reference", "fog_rate_table", "vg910_1_table", "sub_tilt_y", "ln100_x_up", "adis16405_imu3_1hz",
         "adis16405_imu5_1hz", "rlg_vehicle", "blueseis_bs1_ramp", "adis16405_imu1", "blueseis_bridge_rbam2")


def size(error, columns, axis):
    t = columns["time_s"]
    m = 1 if captures.is_table(columns) else max(1, round(1.0 / np.median(np.diff(t))))
    n = len(error) // m
    means = np.nanmean(error[: n * m].reshape(n, m), axis=1)
    means = means[np.isfinite(means)]
    if f"reference_rate_{axis}radps" not in columns:
        means = means - means.mean()
    return np.degrees(np.sqrt(np.mean(means**2))) * 3600


def rows_of(program, folder, name):
    columns = captures.load(folder, name)
    fit, judge = captures.parts(columns)
    with tempfile.TemporaryDirectory() as work:
        report, model = captures.diagnosed(program, fit, Path(work))
        ours = captures.corrected(program, judge, model, Path(work)) if model else None
    for axis in captures.axes_of(columns):
        reference = judge.get(f"reference_rate_{axis}radps", 0.0)
        raw, plain = error_of(judge, axis), plain_fit(fit, judge, axis)
        left = ours[axis] - reference if ours else raw
        claims = [e["form"] + (" of " + e["channel"] if e["channel"] else "") for e in report["effects"]
                  if e.get("axis", "") + "_" == axis or axis == ""] if ours else [report]
        yield name, axis.strip("_"), *(size(e, judge, axis) for e in (raw, plain, left)), ", ".join(claims)


def good(raw, plain, ours):
    return ours <= 1.1 * plain if plain < 0.9 * raw else ours <= 1.02 * raw


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ifog", required=True)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--more", type=Path, help="a folder of further captures, such as robot_*.csv")
    parser.add_argument("--only", nargs="*", default=NAMES)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    if not options.data.exists():
        print(f"skipped: {options.data} is not there")
        return 77
    jobs = [(options.data, name) for name in options.only]
    if options.more:
        jobs += [(options.more, f.name.split(".")[0]) for f in sorted(options.more.glob("*.csv*"))]
    missed = 0
    print("| capture | axis | raw | plain fit | ours | | effects |\n|---|---|---|---|---|---|---|")
    for folder, name in jobs:
        for name, axis, raw, plain, ours, claims in rows_of(options.ifog, folder, name):
            fine = good(raw, plain, ours)
            missed += not fine
            print(f"| {name} | {axis} | {raw:.4g} | {plain:.4g} | {ours:.4g} | {'' if fine else 'missed'} | {claims} |",
                  flush=True)
    return 1 if options.check and missed else 0


if __name__ == "__main__":
    sys.exit(main())
