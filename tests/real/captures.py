# SPDX-License-Identifier: Apache-2.0
"""Real captures as arrays, cut into a part to fit and a part to judge, and what ifog makes of them."""
import gzip
import json
import subprocess
from pathlib import Path

import numpy as np

# Beyond it the converter of the VG910 is at its end.
LIMITS = {"vg910_1_table": np.radians(161)}


def read(path):
    """Columns of a capture by name; an empty cell is nan."""
    with (gzip.open if path.suffix == ".gz" else open)(path, "rt") as f:
        names = next(line for line in f if not line.startswith("#")).strip().split(",")
        cells = np.genfromtxt(f, delimiter=",")
    return dict(zip(names, np.atleast_2d(cells).T))


def write(path, columns):
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", fmt="%.12g", header=",".join(columns),
               comments="")


def axes_of(columns):
    return [a for a in ("", "x_", "y_", "z_") if f"rate_{a}radps" in columns]


def load(folder, name):
    columns = read(folder / f"{name}.csv.gz" if (folder / f"{name}.csv.gz").exists() else folder / f"{name}.csv")
    if name in LIMITS:
        kept = np.abs(columns["reference_rate_radps"]) < LIMITS[name]
        columns = {k: v[kept] for k, v in columns.items()}
    return columns


def is_table(columns):
    return np.median(np.diff(columns["time_s"])) > 1 and any(c.startswith("reference_rate") for c in columns)


def parts(columns):
    """A part to fit and one to judge: of a rate table every other point, else the first and the second half."""
    rows = np.arange(len(columns["time_s"]))
    fit = rows % 2 == 0 if is_table(columns) else rows < len(rows) // 2
    return {k: v[fit] for k, v in columns.items()}, {k: v[~fit] for k, v in columns.items()}


def ifog(program, *arguments):
    """What it says on standard error where it refuses; None where it does not."""
    p = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=600)
    if p.returncode > 1 or p.returncode < 0:
        raise RuntimeError(f"{arguments[0]}: exit {p.returncode}: {p.stderr[-300:]}")
    return p.stderr.strip() if p.returncode else None


def diagnosed(program, columns, folder, *options):
    """The report and the path of the model; what it says where it refuses, and None."""
    write(folder / "fit.csv", columns)
    refused = ifog(program, "diagnose", folder / "fit.csv", "--json", folder / "d.json", "--write-model",
                   folder / "m.toml", "--quiet", *options)
    return (refused, None) if refused else (json.loads((folder / "d.json").read_text()), folder / "m.toml")


def corrected(program, columns, model, folder):
    """By axis, the rate less what the daemon's own correction takes."""
    write(folder / "next.csv", columns)
    refused = ifog(program, "denoise", folder / "next.csv", "--model", model, "--output", folder / "out.csv")
    if refused:
        raise RuntimeError(refused)
    out = read(folder / "out.csv")
    return {a: np.interp(columns["time_s"], out["time_s"], out[f"compensated_{a}radps"]) for a in axes_of(columns)}
