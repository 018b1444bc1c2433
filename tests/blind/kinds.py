# SPDX-License-Identifier: Apache-2.0
"""Kinds of effects, from the physics of the instrument. Each is a law (constants drawn once for a sensor) and a
shape: the effect's rate in a capture for a size of one. `cover` says who could describe it:
  design   the forms that section "Effects" of the design names, on one channel or a product of two
  grammar  needs a difference of like channels, another axis' rate, |reference|, a switch, a delay, two band edges,
           or a channel rebuilt from the angle
  none     no form can: it must be left alone, and reported as unexplained
`channels`: any one of each group must be named; a form without a channel has the group ()."""
from dataclasses import dataclass, field
from typing import Callable

import numpy as np

import signals
from world import EARTH, THERMOMETERS

RATE = ("reference_rate_radps", "reference_rate_x_radps", "rate_x_radps", "rate_radps")


@dataclass
class Kind:
    name: str
    form: str
    cover: str
    platforms: tuple
    quantities: tuple  # columns that must be logged
    channels: tuple  # groups of column names
    law: Callable  # rng, plan -> constants
    shape: Callable  # world, constants -> series
    linear: bool = True  # effect is size x shape; else shape takes the size as constants["size"]
    flags: frozenset = field(default_factory=frozenset)


KINDS = {}


def kind(name, form, cover, platforms, quantities, channels, law=lambda rng, plan: {}, **more):
    def keep(shape):
        KINDS[name] = Kind(name, form, cover, platforms, quantities, channels, law, shape, **more)
        return shape
    return keep


def effect_of(k, law, size, world):
    """Rate of the effect in a capture, rad/s; motion is none."""
    if "motion" in k.flags:
        return np.zeros(world.n)
    return size * k.shape(world, law) if k.linear else k.shape(world, dict(law, size=size))


STILL = ("laboratory", "structure", "laboratory", "sled")
TABLE = ("rate table",)
THERMAL = (THERMOMETERS,)


def middle(plan, name):
    low, high = plan.limits[name][0]
    return low + 0.5 * (high - low)


def span(plan, name):
    low, high = plan.limits[name][0]
    return high - low


# --- temperature -------------------------------------------------------------------------------------------------
@kind("bias over temperature", "linear", "design", STILL, ("temperature",), THERMAL)
def _(w, c):
    return w.q["temperature"] - 25


@kind("turning point over temperature", "quadratic", "design", STILL, ("temperature",), THERMAL,
      lambda rng, plan: {"at": middle(plan, "temperature") + rng.uniform(-0.4, 0.4) * span(plan, "temperature")})
def _(w, c):
    return (w.q["temperature"] - c["at"]) ** 2


@kind("polarisation step over temperature", "lookup", "design", STILL, ("temperature",), THERMAL,
      lambda rng, plan: {"at": middle(plan, "temperature") + rng.uniform(-0.2, 0.2) * span(plan, "temperature"),
                         "width": rng.uniform(0.1, 0.25) * span(plan, "temperature")})
def _(w, c):
    return np.tanh((w.q["temperature"] - c["at"]) / c["width"])


@kind("Shupe, one time constant", "rate", "design", STILL, ("temperature",), THERMAL,
      lambda rng, plan: {"tau": np.exp(rng.uniform(np.log(15), np.log(300)))})
def _(w, c):
    return signals.rate(signals.lowpass(w.q["temperature"], c["tau"], w.dt), w.dt)


@kind("Shupe, heat through the layers", "rate", "design", STILL, ("temperature",), THERMAL,
      lambda rng, plan: {"tau": rng.uniform(40, 250), "weights": rng.uniform(0.2, 1.0, 4)})
def _(w, c):
    """Diffusion into a slab: modes 1, 3, 5, 7 with time constants tau / m^2 and amplitudes 1 / m^2."""
    out = np.zeros(w.n)
    for weight, m in zip(c["weights"], (1, 3, 5, 7)):
        out += weight / m**2 * signals.rate(signals.lowpass(w.q["temperature"], c["tau"] / m**2, w.dt), w.dt)
    return out


@kind("Shupe, gradient of two thermometers", "difference", "grammar", STILL, ("temperature", "coil"), THERMAL)
def _(w, c):
    return w.q["temperature"] - w.q["coil"]


@kind("coil lags the thermometer", "lagged", "design", STILL, ("temperature",), THERMAL,
      lambda rng, plan: {"tau": np.exp(rng.uniform(np.log(150), np.log(1200)))})
def _(w, c):
    return signals.lowpass(w.q["temperature"], c["tau"], w.dt)


@kind("hysteresis over temperature", "none", "none", ("laboratory",), ("temperature",), THERMAL,
      lambda rng, plan: {"width": rng.uniform(0.3, 0.6) * span(plan, "temperature")})
def _(w, c):
    return signals.play(w.q["temperature"], c["width"]) - w.q["temperature"]


@kind("warm-up", "warm_up", "design", STILL, ("temperature",), ((), ),
      lambda rng, plan: {"tau": rng.uniform(0.04, 0.15) * plan.n * plan.dt, "second": rng.uniform(0, 0.6)},
      flags=frozenset(["same start only"]))
def _(w, c):
    if w.which == 1 and w.plan.outside:
        return np.zeros(w.n)  # switched on long before: there is nothing left to warm up
    return np.exp(-w.t / c["tau"]) + c["second"] * np.exp(-w.t / (0.2 * c["tau"]))


# --- electronics -------------------------------------------------------------------------------------------------
@kind("supply", "linear", "design", STILL, ("supply",), (("supply_V",),))
def _(w, c):
    return w.q["supply"] - 12


@kind("supply, squared", "quadratic", "design", STILL, ("supply",), (("supply_V",),),
      lambda rng, plan: {"at": middle(plan, "supply") + rng.uniform(-0.3, 0.3) * span(plan, "supply")})
def _(w, c):
    return (w.q["supply"] - c["at"]) ** 2


@kind("laser current", "linear", "design", STILL, ("laser",), (("laser_mA",),))
def _(w, c):
    return w.q["laser"]


@kind("pressure in the housing, through a leak", "lagged", "design", ("laboratory",), ("pressure",),
      (("pressure_hPa",),), lambda rng, plan: {"tau": rng.uniform(30, 300)})
def _(w, c):
    return signals.lowpass(w.q["pressure"], c["tau"], w.dt)


@kind("heater current's field", "linear", "design", STILL, ("switch",), (("heater_on",),))
def _(w, c):
    return w.q["switch"]


@kind("temperature bias while the heater is on", "product", "grammar", STILL, ("switch", "temperature"),
      (("heater_on",), THERMOMETERS),
      lambda rng, plan: {"at": middle(plan, "temperature") + rng.uniform(-0.3, 0.3) * span(plan, "temperature")})
def _(w, c):
    return w.q["switch"] * (w.q["temperature"] - c["at"])


@kind("supply through temperature", "product", "design", STILL, ("supply", "temperature"),
      (("supply_V",), THERMOMETERS))
def _(w, c):
    return (w.q["supply"] - 12) * (w.q["temperature"] - 25)


# --- magnetic field ----------------------------------------------------------------------------------------------
@kind("Faraday, one axis", "linear", "design", STILL, ("field_x", "field_y"), (("magnetic_x_uT",),))
def _(w, c):
    return w.q["field_x"]


@kind("Faraday, across two axes", "linear", "design", STILL, ("field_x", "field_y"),
      (("magnetic_x_uT",), ("magnetic_y_uT",)), lambda rng, plan: {"angle": rng.uniform(0.6, 1.0)})
def _(w, c):
    return np.cos(c["angle"]) * w.q["field_x"] + np.sin(c["angle"]) * w.q["field_y"]


# --- acceleration and vibration ----------------------------------------------------------------------------------
@kind("acceleration", "linear", "design", ("sled",), ("accel_x", "accel_y", "accel_z"), (("accel_x_mps2",),))
def _(w, c):
    return w.q["accel_x"]


@kind("acceleration, squared", "quadratic", "design", ("sled",), ("accel_x", "accel_y", "accel_z"),
      (("accel_y_mps2",),))
def _(w, c):
    return w.q["accel_y"] ** 2


@kind("vibration rectification", "band_power", "design", ("shaker",), ("accel_x", "accel_y", "accel_z"),
      (("accel_x_mps2",),), lambda rng, plan: {"tau": rng.uniform(0.3, 2.0)})
def _(w, c):
    x = w.q["accel_x"]
    return signals.lowpass((x - signals.lowpass(x, 1.0, w.dt)) ** 2, c["tau"], w.dt)


@kind("vibration rectification in a band", "band_power", "grammar", ("shaker",), ("accel_x", "accel_y", "accel_z"),
      (("accel_x_mps2",),), lambda rng, plan: {"tau": rng.uniform(0.3, 2.0), "tone": int(rng.integers(2))})
def _(w, c):
    hz = w.plan.tones[c["tone"]]
    return signals.lowpass(signals.band(w.q["accel_x"], 0.8 * hz, 1.25 * hz, w.dt) ** 2, c["tau"], w.dt)


# --- without a channel -------------------------------------------------------------------------------------------
@kind("step of the bias", "step", "design", STILL, ("temperature",), ((),),
      lambda rng, plan: {"at": rng.uniform(0.25, 0.75)}, flags=frozenset(["first capture only"]))
def _(w, c):
    return (w.t > c["at"] * w.t[-1]).astype(float) if w.which == 0 else np.zeros(w.n)


@kind("bias that ages", "rate_ramp", "design", ("laboratory", "structure"), ("temperature",), ((),))
def _(w, c):
    return w.t / 3600


@kind("bias with two states", "none", "none", STILL, ("temperature",), (),
      lambda rng, plan: {"seed": int(rng.integers(1 << 30)), "dwell": rng.uniform(0.03, 0.12)})
def _(w, c):
    rng = np.random.default_rng([c["seed"], w.which])
    whole = w.n * w.dt
    length = rng.exponential(c["dwell"] * whole, 400)
    return np.searchsorted(np.cumsum(length), w.t) % 2 * 1.0


@kind("hidden cause", "none", "none", STILL, ("temperature", "supply"), (),
      lambda rng, plan: {"seed": int(rng.integers(1 << 30))})
def _(w, c):
    rng = np.random.default_rng([c["seed"], w.which])
    return signals.lowpass(signals.ornstein(rng, w.n, w.dt, w.n * w.dt / 15), 30.0, w.dt)


@kind("confounder", "none", "none", ("laboratory",), ("laser",), (), flags=frozenset(["confounded"]))
def _(w, c):
    return w.q["hidden"]


@kind("Earth's rate while tilting", "earth_rate", "motion", ("tilting pier",), ("accel_x", "accel_z"), (),
      flags=frozenset(["motion"]))
def _(w, c):
    """Rotation, no error: the part of the Earth's rate that turns into the axis."""
    heading, latitude = w.plan.headings[w.which], w.plan.latitude
    tilt = w.q["tilt"]
    return EARTH * (np.cos(latitude) * np.cos(heading) * np.cos(tilt) + np.sin(latitude) * np.sin(tilt))
