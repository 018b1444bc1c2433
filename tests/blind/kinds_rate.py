# SPDX-License-Identifier: Apache-2.0
"""Kinds of effects that need rotation: scale factor, misalignment, dead zone, the feedback ramp; and lines."""
import numpy as np

import signals
from kinds import RATE, STILL, TABLE, kind, middle, span
from world import THERMOMETERS


@kind("scale factor", "linear", "design", TABLE, ("temperature",), (RATE,))
def _(w, c):
    return w.rate.copy()


@kind("scale factor over temperature", "product", "design", TABLE, ("temperature",), (RATE, THERMOMETERS))
def _(w, c):
    return w.rate * (w.q["temperature"] - 25)


@kind("scale factor over the coil's temperature", "product", "grammar", TABLE, ("temperature",),
      (RATE, THERMOMETERS), lambda rng, plan: {"tau": rng.uniform(60, 300)})
def _(w, c):
    return w.rate * (signals.lowpass(w.q["temperature"], c["tau"], w.dt) - 25)


@kind("scale factor, cubic", "cubic", "design", TABLE, ("temperature",), (RATE,))
def _(w, c):
    return (w.rate / w.plan.top_rate) ** 3


@kind("scale factor, another one backwards", "|reference|", "grammar", TABLE, ("temperature",), (RATE,))
def _(w, c):
    return np.abs(w.rate)


@kind("dead zone", "none", "none", TABLE, ("temperature",), (RATE,), linear=False)
def _(w, c):
    return np.where(np.abs(w.rate) < c["size"], -w.rate, 0.0)


@kind("saturation", "none", "none", TABLE, ("temperature",), (RATE,), linear=False)
def _(w, c):
    """A soft limit: the larger the size, the earlier it sets in."""
    limit = w.plan.top_rate / max(c["size"], 1e-12)
    return limit * np.tanh(w.rate / limit) - w.rate


@kind("misalignment", "cross-axis", "grammar", TABLE, ("temperature",),
      (("rate_y_radps", "reference_rate_y_radps"),), flags=frozenset(["three axes"]))
def _(w, c):
    return w.q["turn_y"].copy()


@kind("once a turn", "lookup", "design", TABLE, ("angle", "temperature"), (("table_rad",),),
      lambda rng, plan: {"phase": rng.uniform(0, 6), "second": rng.uniform(0, 0.7)})
def _(w, c):
    """The laboratory's field, seen once a turn, and a part of it twice."""
    a = w.q["angle"]
    return np.cos(a + c["phase"]) + c["second"] * np.cos(2 * a)


def _ramp_law(rng, plan):
    return {"wrap": 1.3e-5 * rng.uniform(0.7, 1.6), "start": rng.uniform(0, 1, 2),
            "sizes": rng.normal(size=4) / np.arange(1, 5), "phases": rng.uniform(0, 6, 4),
            "flyback": rng.choice([0.0, 1.0])}


def ramp_phase(w, c):
    """Turns of the feedback ramp: proportional to the angle turned."""
    return np.cumsum(w.rate) * w.dt / c["wrap"] + c["start"][w.which]


def _ramp_error(w, c):
    """Rate of an angle error that is a function of the ramp's phase; with a flyback that is not 2 pi a jump."""
    phase = ramp_phase(w, c)
    error = sum(s * np.sin(2 * np.pi * (k + 1) * phase + p)
                for k, (s, p) in enumerate(zip(c["sizes"], c["phases"])))
    error = error + c["flyback"] * np.mod(phase, 1.0)
    return np.diff(error, prepend=error[0]) / w.dt


@kind("feedback ramp", "lookup", "design", ("ramp logger",), ("temperature",), (("ramp_counts",),), _ramp_law,
      flags=frozenset(["ramp"]))
def _(w, c):
    return _ramp_error(w, c)


@kind("feedback ramp, not logged", "rebuilt ramp", "grammar", ("ramp logger",), ("temperature",), (), _ramp_law,
      flags=frozenset(["descriptive"]))
def _(w, c):
    return _ramp_error(w, c)


@kind("electronic line", "line", "design", STILL + ("shaker",), ("temperature",), ((),),
      lambda rng, plan: {"hz": rng.uniform(0.03, 0.45) * plan.rate_hz, "phase": rng.uniform(0, 6, 2)},
      flags=frozenset(["descriptive"]))
def _(w, c):
    return np.cos(2 * np.pi * c["hz"] * w.t + c["phase"][w.which])


@kind("reference logged late", "delay", "logger", TABLE, ("temperature",), (),
      lambda rng, plan: {"late": float(np.ceil(rng.uniform(0.5, 6)))}, flags=frozenset(["late reference"]))
def _(w, c):
    return np.zeros(w.n)  # the gyro is right


@kind("scale factor, another supply", "product", "design", TABLE, ("supply", "temperature"), (RATE, ("supply_V",)),
      lambda rng, plan: {"at": middle(plan, "supply") + rng.uniform(-0.3, 0.3) * span(plan, "supply")})
def _(w, c):
    return w.rate * (w.q["supply"] - c["at"])
