# SPDX-License-Identifier: Apache-2.0
"""Where a sensor stands: the physical quantities of two captures, the second inside or outside the first one's
ranges, and the columns a logger would take. A quantity is exact; its column has a thermometer's or a transducer's
noise and resolution."""
import numpy as np

import signals

EARTH = 7.292115e-5  # rad/s
GRAVITY = 9.80665

# sample rates Hz, durations s
PLATFORMS = {
    "laboratory": ((1, 2, 5), (5400, 7200, 10800)),
    "structure": ((5, 10), (3600, 5400)),
    "sled": ((5, 10), (1800, 3600)),
    "rate table": ((10, 20), (1200, 1800)),
    "shaker": ((50, 100), (600, 900)),
    "ramp logger": ((200,), (200, 300)),
    "tilting pier": ((5, 10), (1800, 3600)),
}

# quantity: lowest value from, to; span from, to; noise and resolution of its column; column name
SLOW = {
    "temperature": (-15, 40, 4, 25, 0.004, 0.01, "temperature_degC"),
    "coil": (-15, 40, 4, 25, 0.004, 0.01, "temperature_coil_degC"),
    "supply": (11.2, 12.1, 0.2, 1.0, 0.0005, 0.001, "supply_V"),
    "laser": (60, 140, 2, 10, 0.002, 0.005, "laser_mA"),
    "pressure": (960, 1010, 2, 15, 0.01, 0.02, "pressure_hPa"),
    "humidity": (20, 60, 5, 30, 0.05, 0.1, "humidity_percent"),
    "field_x": (-40, 20, 10, 60, 0.05, 0.02, "magnetic_x_uT"),
    "field_y": (-40, 20, 10, 60, 0.05, 0.02, "magnetic_y_uT"),
    "switch": (0, 0, 1, 1, 0.0, 0.0, "heater_on"),
}
THERMOMETERS = ("temperature_degC", "temperature_coil_degC")


class Plan:
    """What both captures of a sensor share: the place, its clock, the ranges of each quantity in each capture."""

    def __init__(self, rng, platform, outside, confounded=False):
        rates, spans = PLATFORMS[platform]
        self.platform, self.outside, self.confounded = platform, outside, confounded
        self.rate_hz = float(rng.choice(rates))
        self.dt = 1 / self.rate_hz
        self.n = int(rng.choice(spans) * self.rate_hz)
        self.limits = {}
        for name, (low_from, low_to, span_from, span_to, *_) in SLOW.items():
            low, span = rng.uniform(low_from, low_to), rng.uniform(span_from, span_to)
            self.limits[name] = [(low, low + span), _other_range(rng, low, span, outside)]
        self.limits["switch"] = [(0.0, 1.0)] * 2
        growth = rng.uniform(1.4, 2.0) if outside else rng.uniform(0.6, 0.95)
        self.strength = [1.0, growth]  # of what swings about zero: rate, acceleration, vibration
        self.top_rate = np.exp(rng.uniform(np.log(0.02), np.log(1.5)))
        self.top_accel = rng.uniform(1.0, 5.0)
        self.vibration = rng.uniform(0.5, 8.0)
        self.tones = np.sort(rng.uniform(0.08, 0.4, 2)) * self.rate_hz
        self.latitude = np.radians(rng.uniform(20, 65))
        self.headings = rng.uniform(0, 2 * np.pi, 2)
        self.coil_tau = rng.uniform(60, 400)


def _other_range(rng, low, span, outside):
    """Most of the first range, or a range that lies half to wholly beyond one of its ends."""
    if outside:
        shift = rng.choice([-1, 1]) * rng.uniform(0.5, 1.0) * span
        return low + shift, low + shift + span * rng.uniform(0.7, 1.2)
    width = span * rng.uniform(0.6, 0.95)
    start = low + rng.uniform(0, span - width)
    return start, start + width


class World:
    """One capture: t, dt, `q` the quantities by name, `rate` the true rotation about the sensor's axis."""

    def __init__(self, rng, plan, which):
        self.plan, self.which, self.dt, self.n = plan, which, plan.dt, plan.n
        self.t = np.arange(self.n) * self.dt
        self.q = {}
        self._slow(rng)
        rest = EARTH * np.sin(plan.latitude)
        self.rate = np.full(self.n, rest)
        if plan.platform == "sled":
            self._sled(rng)
        elif plan.platform == "rate table":
            self._table(rng)
        elif plan.platform == "shaker":
            self._shaker(rng)
        elif plan.platform == "tilting pier":
            self._pier(rng)
        elif plan.platform == "ramp logger":
            self.rate = rest * (1 + 0.3 * np.cos(plan.headings[which])) + 2e-8 * signals.ornstein(
                rng, self.n, self.dt, 30.0)

    def _slow(self, rng):
        span, n, dt = self.n * self.dt, self.n, self.dt

        def wander(part):
            return signals.lowpass(signals.ornstein(rng, n, dt, span / part), 2 * dt, dt)

        shapes = {
            "temperature": signals.climate(rng, n, dt),
            "supply": signals.dwells(rng, n, dt, span / 40, span / 8) + 0.3 * wander(20) - 0.5 * self.t / span,
            "laser": wander(rng.uniform(4, 15)) + 0.5 * signals.dwells(rng, n, dt, span / 12, span / 4),
            "pressure": signals.lowpass(wander(6), span / 100, dt),
            "humidity": wander(8),
            "field_x": wander(25) + 1.5 * signals.lowpass(signals.dwells(rng, n, dt, span / 60, span / 10), 3.0, dt),
            "field_y": wander(25) + 1.5 * signals.lowpass(signals.dwells(rng, n, dt, span / 60, span / 10), 3.0, dt),
        }
        self.q["hidden"] = signals.into(wander(12), (-1, 1))
        if self.plan.confounded and self.which == 0:  # in the first capture alone the laser follows the hidden cause
            shapes["laser"] = self.q["hidden"] + 0.06 * wander(30)
        for name, x in shapes.items():
            self.q[name] = signals.into(x, self.plan.limits[name][self.which])
        self.q["switch"] = (signals.dwells(rng, n, dt, span / 25, span / 8) > 0).astype(float)
        # the coil lags the case and has a heater, a draught, of its own
        case = self.q["temperature"]
        own = 0.12 * np.ptp(case) * signals.lowpass(signals.ornstein(rng, n, dt, span / 10), span / 100, dt)
        self.q["coil"] = signals.lowpass(case, self.plan.coil_tau, dt) + own

    def _sled(self, rng):
        for axis in "xyz":
            drive = signals.dwells(rng, self.n, self.dt, 5, 60)
            drive *= self.plan.top_accel * self.plan.strength[self.which]
            self.q["accel_" + axis] = signals.lowpass(drive, 1.0, self.dt) + (GRAVITY if axis == "z" else 0.0)

    def _table(self, rng):
        """Three axes of a table: staircases, sines and turns; the sensor's own is x."""
        for axis in "xyz":
            style = rng.choice(["staircase", "sine", "turns"])
            if style == "staircase":
                x = signals.dwells(rng, self.n, self.dt, 10, 60)
            elif style == "sine":
                size = 0.3 + 0.7 * np.abs(signals.dwells(rng, self.n, self.dt, 100, 300))
                x = size * np.sin(2 * np.pi * self.t / rng.uniform(15, 120) + rng.uniform(0, 6))
            else:
                x = signals.dwells(rng, self.n, self.dt, 4, 20)
                x = x * (signals.dwells(rng, self.n, self.dt, 10, 40) > 0.0)
            x = signals.lowpass(signals.lowpass(x, 0.3, self.dt), 0.3, self.dt)
            self.q["turn_" + axis] = self.plan.top_rate * self.plan.strength[self.which] * x
        self.rate = self.q["turn_x"]
        self.q["angle"] = np.mod(np.cumsum(self.rate) * self.dt, 2 * np.pi)

    def _pier(self, rng):
        """Tilts about the level y axis: x turns against the vertical, and with it the Earth's rate."""
        tilt = signals.lowpass(signals.dwells(rng, self.n, self.dt, 40, 200), 8.0, self.dt)
        self.q["tilt"] = tilt * np.radians(4) * self.plan.strength[self.which]
        self.q["accel_x"] = GRAVITY * np.sin(self.q["tilt"])
        self.q["accel_z"] = GRAVITY * np.cos(self.q["tilt"])

    def _shaker(self, rng):
        """Two machines with tones of their own run up and down, over broad-band noise."""
        total = 0.02 * rng.normal(size=self.n)
        for k, hz in enumerate(self.plan.tones):
            level = np.abs(signals.ornstein(rng, self.n, self.dt, rng.uniform(20, 60)))
            level = level * (0.3 + (signals.dwells(rng, self.n, self.dt, 20, 80) > 0))
            phase = 2 * np.pi * hz * self.t + 3 * signals.ornstein(rng, self.n, self.dt, 20.0)
            tone = self.plan.vibration * self.plan.strength[self.which] * level * np.sin(phase)
            self.q[f"tone_{k}"] = tone
            total = total + tone
        self.q["accel_x"] = total
        for axis in "yz":
            self.q["accel_" + axis] = 0.3 * self.plan.vibration * rng.normal(size=self.n) + (
                GRAVITY if axis == "z" else 0.0)

    def columns(self, rng, wanted):
        """The logger's columns for the quantities wanted, in that order: name -> series."""
        out = {}
        for name in wanted:
            x = self.q[name]
            if name in SLOW:
                noise, step, column = SLOW[name][4:]
            elif name.startswith("accel"):
                noise, step, column = 2e-3, 1e-4, name + "_mps2"
            elif name == "angle":
                noise, step, column = 1e-6, 1e-6, "table_rad"
            else:
                raise KeyError(f"no column is known for {name}")
            x = x + noise * rng.normal(size=self.n)
            out[column] = np.round(x / step) * step if step else x
        return out
