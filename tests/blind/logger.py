# SPDX-License-Identifier: Apache-2.0
"""How loggers fail. A fault acts on a column (name -> series, nan for an empty cell) or on the rows. What is a
property of the wiring (late, early because the gyro's own data are buffered, polled, coarse) is the same in both
captures; what befalls a record (holes, stuck stretches, sentinels, glitches) strikes each anew."""
import numpy as np

WIRING = ("late", "early", "polled, held", "polled, empty", "coarse")
ACCIDENTS = ("hole", "stuck", "sentinel", "glitch", "empty cells")
SLOW_COLUMNS = ("temperature_degC", "temperature_coil_degC", "supply_V", "laser_mA", "pressure_hPa",
                "humidity_percent", "magnetic_x_uT", "magnetic_y_uT")
SLOWEST_COLUMNS = ("temperature_degC", "temperature_coil_degC", "pressure_hPa", "humidity_percent")


def draw(rng, columns, causal):
    """One or two faults for a sensor, seven times in ten on the column that matters: [{kind, column, ...}]."""
    out = []
    for _ in range(2 if rng.uniform() < 0.25 else 1):
        able = [c for c in causal if c in columns]
        column = str(rng.choice(able)) if able and rng.uniform() < 0.7 else str(rng.choice(list(columns)))
        choice = list(ACCIDENTS) + (list(WIRING) if column in SLOW_COLUMNS else [])
        name = str(rng.choice(choice))
        if column == "heater_on" and name in ("sentinel", "glitch"):
            name = "hole"
        fault = {"kind": name, "column": None if name == "hole" else column}
        if name in ("late", "early"):
            most = 50 if column in SLOWEST_COLUMNS or name == "early" else 5
            fault["seconds"] = float(np.exp(rng.uniform(np.log(2), np.log(most))))
        if name.startswith("polled"):
            fault["seconds"] = float(rng.choice([2, 5, 10, 20]))
        if name == "coarse":
            fault["step"] = _step(column)
        if all(fault["column"] != f["column"] or f["kind"] != name for f in out):
            out.append(fault)
    return out


def _step(column):
    for unit, step in (("degC", 0.5), ("_V", 0.05), ("mA", 0.2), ("hPa", 0.5), ("percent", 1.0)):
        if column.endswith(unit):
            return step
    return 1.0


def apply(rng, faults, columns, t, accidents):
    """Damages the columns in place; returns which rows stay. `accidents`: whether those strike this capture."""
    keep = np.ones(len(t), bool)
    dt = t[1] - t[0]
    for f in faults:
        x = columns.get(f["column"])
        if f["kind"] in ACCIDENTS and not accidents:
            continue
        if f["kind"] == "hole":
            length = min(rng.uniform(60, 400), 0.08 * t[-1])
            start = rng.uniform(0.1, 0.85) * t[-1]
            keep &= (t < start) | (t > start + length)
        elif f["kind"] in ACCIDENTS:
            _accident(rng, f["kind"], x, f["column"], dt)
        else:
            columns[f["column"]] = wiring(f, x, dt)
    return keep


def _accident(rng, name, x, column, dt):
    n = len(x)
    if name == "stuck":
        start = int(rng.uniform(0.1, 0.8) * n)
        x[start : start + int(rng.uniform(0.04, 0.12) * n)] = x[start]
    elif name == "sentinel":
        value = rng.choice([85.0, -127.0, -999.0]) if column.endswith("degC") else rng.choice([-999.0, 9999.0])
        for _ in range(rng.integers(1, 6)):
            start = int(rng.uniform(0.05, 0.95) * n)
            x[start : start + max(1, int(rng.uniform(2, 20) / dt))] = value
    elif name == "glitch":
        x[int(rng.uniform(0.1, 0.9) * n)] = rng.choice([1e30, -1e6, 4e9])
    else:
        for _ in range(rng.integers(5, 40)):
            start = int(rng.uniform(0, 0.99) * n)
            x[start : start + int(rng.integers(1, 6))] = np.nan


def wiring(f, x, dt):
    if f["kind"] == "coarse":
        return np.round(x / f["step"]) * f["step"]
    steps = max(1, int(round(f["seconds"] / dt)))
    if f["kind"] == "early":
        return np.concatenate([x[steps:], np.full(steps, x[-1])])
    if f["kind"] == "late":
        return np.concatenate([np.full(steps, x[0]), x[:-steps]])
    index = np.arange(len(x))
    if f["kind"] == "polled, held":
        return x[index - index % steps]
    return np.where(index % steps == 0, x, np.nan)


def staleness(faults, columns):
    """Seconds by which the columns that matter are old at the worst: what no causal correction can make up for."""
    return max([f["seconds"] * (1.0 if f["kind"] == "late" else 0.5) for f in faults
                if f["column"] in columns and f["kind"] in ("late", "polled, held", "polled, empty")], default=0.0)
