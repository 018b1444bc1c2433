#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes two captures of a gyro with an effect that nobody declared, and what was hidden into a folder of its own.

OUTPUT/capture1.csv is to be diagnosed, OUTPUT/next.csv to be corrected with the model found. TRUTH/truth.json names
the kind, its channels and its visibility in sigma; TRUTH/capture1_effect.csv and next_effect.csv hold, row by row of
the capture, the effect's rate and the true rotation."""
import argparse
import json
import sys
from pathlib import Path

try:
    import numpy as np
except ModuleNotFoundError:
    sys.exit("make: numpy is missing for this Python; install python3-numpy")

from kinds import KINDS
from sensor import make


def write_csv(path, columns):
    """Full precision for the clock and rates; an empty cell for nan."""
    table = [np.char.mod("%.12g", x) for x in columns.values()]
    for cells, x in zip(table, columns.values()):
        cells[np.isnan(x)] = ""
    with open(path, "w") as f:
        f.write(",".join(columns) + "\n")
        f.writelines(",".join(row) + "\n" for row in zip(*table))


def write(sensor, output, truth):
    output, truth = Path(output), Path(truth)
    output.mkdir(parents=True, exist_ok=True)
    truth.mkdir(parents=True, exist_ok=True)
    for name, c in zip(("capture1", "next", "capture2"), sensor.captures):
        write_csv(output / f"{name}.csv", {"time_s": c.t, **c.columns})
        write_csv(truth / f"{name}_effect.csv", {"time_s": c.t, "rate_radps": c.effect, "true_rate_radps": c.rate})
    (truth / "truth.json").write_text(json.dumps(sensor.truth, indent=1) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--kind", choices=list(KINDS), help="whatever this seed's turn is")
    parser.add_argument("--output", required=True, help="folder for the captures")
    parser.add_argument("--truth", required=True, help="folder for what was hidden")
    options = parser.parse_args()
    write(make(options.seed, options.kind), options.output, options.truth)


if __name__ == "__main__":
    main()
