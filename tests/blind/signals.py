# SPDX-License-Identifier: Apache-2.0
"""Shapes of physical quantities over time and the linear filters that act on them. Arrays have one value a sample;
dt and every time constant are in seconds."""
import numpy as np


def convolve(x, response):
    """Causal convolution, as long as x."""
    size = 1 << (2 * len(x) - 1).bit_length()
    return np.fft.irfft(np.fft.rfft(x, size) * np.fft.rfft(response[: len(x)], size), size)[: len(x)]


def lowpass(x, tau, dt):
    """First order, at rest on x[0] before the record begins."""
    if tau <= 0.2 * dt:
        return x.copy()
    a = np.exp(-dt / tau)
    return x[0] + convolve(x - x[0], (1 - a) * a ** np.arange(len(x)))


def rate(x, dt):
    return np.gradient(x, dt)


def band(x, low_hz, high_hz, dt):
    """Second-order edges: passes low_hz to high_hz."""
    for _ in range(2):
        x = x - lowpass(x, 1 / (2 * np.pi * low_hz), dt)
        x = lowpass(x, 1 / (2 * np.pi * high_hz), dt)
    return x


def ornstein(rng, n, dt, tau):
    """Stationary first-order Gauss-Markov process of unit variance."""
    a = np.exp(-dt / tau)
    drive = rng.normal(size=n) * np.sqrt(1 - a * a)
    drive[0] = rng.normal()
    return convolve(drive, a ** np.arange(n))


def into(x, limits):
    """x moved and stretched so that it fills the limits."""
    low, high = limits
    return low + (high - low) * (x - x.min()) / max(np.ptp(x), 1e-12)


def dwells(rng, n, dt, shortest, longest):
    """Values of a staircase in -1 ... 1 with dwells of random length."""
    out = np.empty(n)
    at = 0
    while at < n:
        stop = at + max(1, int(rng.uniform(shortest, longest) / dt))
        out[at:stop] = rng.uniform(-1, 1)
        at = stop
    return out


def ramps(rng, n, dt, shortest, longest):
    """Straight pieces between random levels, some of them soaks."""
    times, levels = [0.0], [rng.uniform()]
    while times[-1] < n * dt:
        times.append(times[-1] + rng.uniform(shortest, longest))
        levels.append(levels[-1] if rng.uniform() < 0.3 else rng.uniform())
    return np.interp(np.arange(n) * dt, times, levels)


def climate(rng, n, dt):
    """A temperature: a chamber's programme, a day, a box that heats itself, or weather; never only monotonous."""
    span = n * dt
    t = np.arange(n) * dt
    style = rng.choice(["chamber", "day", "self-heating", "weather"])
    wander = lowpass(ornstein(rng, n, dt, span / rng.uniform(8, 25)), span / 150, dt)
    if style == "chamber":
        x = lowpass(ramps(rng, n, dt, span / 12, span / 5), span / 60, dt)
        return x / np.ptp(x) + 0.02 * wander
    if style == "day":
        return np.sin(2 * np.pi * (t / span * rng.uniform(0.7, 2.5) + rng.uniform())) + 0.2 * wander
    if style == "self-heating":
        return 1 - np.exp(-t / (span * rng.uniform(0.08, 0.25))) + 0.12 * wander
    return wander


def play(x, width):
    """Backlash: follows x once x has moved by half a width against it (an elementary hysteresis)."""
    out = np.empty_like(x)
    y = x[0]
    for i, value in enumerate(x):
        y = min(max(y, value - width / 2), value + width / 2)
        out[i] = y
    return out


def means(x, dt, seconds=10.0):
    """Means of successive stretches; x may hold nan, and a stretch without any value is left out."""
    size = max(1, int(round(seconds / dt)))
    count = len(x) // size
    blocks = x[: count * size].reshape(count, size)
    known = np.isfinite(blocks)
    filled = np.where(known, blocks, 0.0).sum(axis=1)
    keep = known.sum(axis=1) > 0
    return filled[keep] / known.sum(axis=1)[keep]


def rms(x, dt, seconds=10.0):
    """RMS of the means about their own mean: a constant is bias and says nothing of an effect."""
    m = means(x, dt, seconds)
    return float(np.sqrt(np.mean((m - m.mean()) ** 2))) if len(m) else float("nan")
