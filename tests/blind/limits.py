# SPDX-License-Identifier: Apache-2.0
"""How well the effect in the second capture can be known from the first: the bound of Cramer and Rao for a fit that
knows the noise and the law of each effect, and has its size and constants to find."""
import numpy as np

import signals
from kinds import effect_of

STEP = 1e-3  # of a constant, for the slopes


def _slopes(world, effects):
    """One column for each size and for each real constant of the laws: the effect's change with its logarithm."""
    columns = []
    for k, law, size in effects:
        here = effect_of(k, law, size, world)
        columns.append((effect_of(k, law, size * (1 + STEP), world) - here) / STEP)
        for name, value in law.items():
            if isinstance(value, float) and value != 0.0:
                moved = dict(law, **{name: value * (1 + STEP)})
                columns.append((effect_of(k, moved, size, world) - here) / STEP)
    return columns


def second_capture(noise, worlds, effects, seconds=10.0):
    """RMS of means, rad/s, that such a fit leaves of the effects in the second capture; 0 without effects."""
    if not effects:
        return 0.0
    fit, second = worlds
    whiten = noise.whitener(fit.n)
    one = whiten(np.ones(fit.n))
    rows = []
    for slope in _slopes(fit, effects):
        white = whiten(slope - slope[0])
        rows.append(white - one * (one @ white) / (one @ one))
    rows = np.array(rows)
    covariance = np.linalg.pinv(rows @ rows.T, rcond=1e-10)
    ahead = np.array([signals.means(x, second.dt, seconds) for x in _slopes(second, effects)])
    ahead = ahead - ahead.mean(axis=1, keepdims=True)
    return float(np.sqrt(max(0.0, np.mean(np.einsum("in,ij,jn->n", ahead, covariance, ahead)))))


def from_stale_channels(world, effect, age, seconds=10.0):
    """RMS of means, rad/s, of the effect less itself `age` seconds before."""
    steps = int(round(age / world.dt))
    if steps == 0:
        return 0.0
    return signals.rms(effect[steps:] - effect[:-steps], world.dt, seconds)
