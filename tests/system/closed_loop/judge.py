# SPDX-License-Identifier: Apache-2.0
"""Error of the next capture before and after correction, compared with the sensor's own noise.

usage: judge.py FOLDER
"""
import csv
import json
import sys

import numpy


def columns(path):
    with open(path) as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    data = numpy.array([[float(cell) if cell else numpy.nan for cell in row] for row in rows[1:]])
    return dict(zip(rows[0], data.T))


def spread_of_means(error, dt, seconds=10.0):
    count = max(1, round(seconds / dt))
    means = error[: len(error) // count * count].reshape(-1, count).mean(axis=1)
    return means.std()


folder = sys.argv[1]
kind = json.load(open(folder + "/truth/truth.json"))["kind"]
denoised, hidden = columns(folder + "/denoised.csv"), columns(folder + "/truth/next_effect.csv")
raw, compensated = denoised["raw_radps"], denoised["compensated_radps"]
dt = numpy.median(numpy.diff(denoised["time_s"]))
before, after = spread_of_means(raw, dt), spread_of_means(compensated, dt)
own = spread_of_means(raw - hidden["rate_radps"][: len(raw)], dt)
per_hour = 180 / numpy.pi * 3600
print(f"{kind}: 10 s means of the next capture, °/h: before {before * per_hour:.4g}, after {after * per_hour:.4g}, "
      f"the sensor's own noise {own * per_hour:.4g}")
if not after < before:
    sys.exit(f"{kind}: the error is not smaller than before")
if not after < 1.1 * own:
    sys.exit(f"{kind}: more than a tenth is left above the sensor's own noise")
