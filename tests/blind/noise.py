# SPDX-License-Identifier: Apache-2.0
"""Noise of a fibre-optic gyro after IEEE Std 952, motion of the structure it stands on, and the whitening filter
that knows all of it.

Allan variance 3 Q^2/tau^2 + N^2/tau + (2 ln 2/pi) B^2 + K^2 tau/3; two-sided spectra N^2, B^2/(2 pi f),
K^2/(2 pi f)^2. Flicker is a sum of Gauss-Markov processes, the same one in the drawing and in the filter."""
import numpy as np

from signals import convolve

DEGREE_HOUR = np.pi / 180 / 3600  # rad/s
FLICKER_RATIO = 4.0  # between the correlation times of neighbouring Gauss-Markov parts

# angle random walk deg/sqrt(h), bias instability deg/h, rate random walk deg/h/sqrt(h): data sheets' classes
GRADES = {
    "tactical": ((0.04, 0.1), (0.2, 1.0), (0.2, 1.5)),
    "high tactical": ((0.008, 0.02), (0.02, 0.1), (0.02, 0.2)),
    "navigation": ((0.0008, 0.003), (0.002, 0.01), (0.002, 0.02)),
    "observatory": ((0.0001, 0.0006), (0.0002, 0.001), (0.0002, 0.002)),
}


class Noise:
    """N rad/s/sqrt(Hz), B rad/s, K rad/s/sqrt(s), Q rad; sways and lines as (Hz, damping, RMS rad/s)."""

    def __init__(self, rng, grade, dt):
        angle, bias, walk = ([np.exp(rng.uniform(np.log(a), np.log(b))) for a, b in GRADES[grade]])
        self.N = angle * np.pi / 180 / 60
        self.B = bias * DEGREE_HOUR
        self.K = walk * DEGREE_HOUR / 60
        # a third of them quantise: angle noise as loud as the white noise at about one sample
        self.Q = self.N * np.sqrt(dt / 3) * rng.uniform(0.3, 1.5) if rng.uniform() < 0.33 else 0.0
        self.sways, self.lines = [], []
        self.dt = dt

    @classmethod
    def known(cls, dt, N, B, K):
        """White noise, flicker and walk of these sizes."""
        noise = cls.__new__(cls)
        noise.dt, noise.N, noise.B, noise.K, noise.Q, noise.sways, noise.lines = dt, N, B, K, 0.0, [], []
        return noise

    def flicker_times(self, n):
        count = int(np.ceil(np.log(20.0 * n) / np.log(FLICKER_RATIO)))
        return 0.5 * self.dt * FLICKER_RATIO ** np.arange(count)

    def draw(self, rng, n):
        """Own noise of the sensor, the structure's motion, and electronic lines: three series, rad/s."""
        dt = self.dt
        own = rng.normal(size=n) * self.N / np.sqrt(dt) + np.cumsum(rng.normal(size=n)) * self.K * np.sqrt(dt)
        angle = rng.normal(size=n + 1) * self.Q
        own += np.diff(angle) / dt
        part = self.B * np.sqrt(np.log(FLICKER_RATIO) / np.pi)
        for tau in self.flicker_times(n):
            a = np.exp(-dt / tau)
            drive = rng.normal(size=n) * np.sqrt(1 - a * a)
            drive[0] = rng.normal()
            own += part * convolve(drive, a ** np.arange(n))
        motion = sum((self._resonance(rng, n, *sway) for sway in self.sways), np.zeros(n))
        lines = sum((self._resonance(rng, n, *line) for line in self.lines), np.zeros(n))
        return own, motion, lines

    def _resonance(self, rng, n, hz, damping, size):
        """A damped oscillator, both of its states shaken by white noise, started long before the record."""
        w = 2 * np.pi * hz * self.dt
        before = min(int(4 / (damping * w)) + 1, 4 * n)
        k = np.arange(before + n)
        decay = np.exp(-damping * w * k)
        x = convolve(rng.normal(size=before + n), decay * np.cos(w * k))
        x += convolve(rng.normal(size=before + n), decay * np.sin(w * k))
        return x[before:] * size / np.sqrt(np.sum(decay**2))

    def _states(self, n):
        """Transition F, driving covariance D and measurement row H, in units of the white noise of a sample."""
        dt, white = self.dt, self.N / np.sqrt(self.dt)
        blocks = [(np.eye(1), np.array([[(self.K * np.sqrt(dt) / white) ** 2]]), [1.0])]
        part = (self.B / white) ** 2 * np.log(FLICKER_RATIO) / np.pi
        for tau in self.flicker_times(n):
            a = np.exp(-dt / tau)
            blocks.append((np.array([[a]]), np.array([[part * (1 - a * a)]]), [1.0]))
        for hz, damping, size in self.sways + self.lines:
            w = 2 * np.pi * hz * dt
            turn = np.exp(-damping * w) * np.array([[np.cos(w), -np.sin(w)], [np.sin(w), np.cos(w)]])
            drive = (size / white) ** 2 * (1 - np.exp(-2 * damping * w))
            blocks.append((turn, drive * np.eye(2), [1.0, 0.0]))
        if self.Q:
            loud = (self.Q / dt / white) ** 2
            blocks.append((np.array([[0.0, 0.0], [1.0, 0.0]]), np.diag([loud, 0.0]), [1.0, -1.0]))
        size = sum(len(b[2]) for b in blocks)
        F, D, H, at = np.zeros((size, size)), np.zeros((size, size)), np.zeros((1, size)), 0
        for f, d, h in blocks:
            stop = at + len(h)
            F[at:stop, at:stop], D[at:stop, at:stop], H[0, at:stop] = f, d, h
            at = stop
        return F, D, H

    def whitener(self, n):
        """Function that turns a series into innovations of unit variance under this noise (steady filter)."""
        F, D, H = self._states(n)
        P = _riccati(F, D, H)
        variance = float(H @ P @ H.T) + 1.0
        gain = F @ P @ H.T / variance
        closed = F - gain @ H
        length = 256
        rows = np.empty((length, F.shape[0]))
        rows[0] = H[0]
        for i in range(1, length):
            rows[i] = rows[i - 1] @ closed
        far = np.linalg.matrix_power(closed, length)
        state, response = gain[:, 0], [1.0]
        while len(response) < n:
            response.extend(-(rows @ state))
            state = far @ state
        scale = np.sqrt(variance) * self.N / np.sqrt(self.dt)
        response = np.array(response[:n])
        return lambda x: convolve(x, response) / scale

    def sigma(self, effect):
        """How many standard deviations a fit that knows this noise and the effect's shape sees of its size, beside
        a free constant."""
        whiten = self.whitener(len(effect))
        e = whiten(effect - effect[0])
        one = whiten(np.ones(len(effect)))
        e = e - one * (one @ e) / (one @ one)
        return float(np.sqrt(e @ e))


def _riccati(F, D, H):
    """Steady prediction covariance for unit measurement noise, by structure-preserving doubling."""
    A, G, P = F.T.copy(), H.T @ H, D.copy()
    for _ in range(60):
        solve = np.linalg.inv(np.eye(len(A)) + G @ P)
        step = A.T @ P @ solve @ A
        G = G + A @ solve @ G @ A.T
        A = A @ solve @ A
        P = P + step
        if np.abs(step).max() <= 1e-13 * np.abs(P).max():
            break
    return (P + P.T) / 2
