# SPDX-License-Identifier: Apache-2.0
"""What an engineer fits in an afternoon: bias, scale factor, cross axes, temperature to the second order and its
rate, by ordinary least squares of single samples."""
import numpy as np


def regressors(columns, axis):
    t = columns["time_s"]
    found = [np.ones(len(t))]
    found += [columns[f"reference_rate_{a}radps"] for a in ("", "x_", "y_", "z_")
              if f"reference_rate_{a}radps" in columns and (f"reference_rate_{axis}radps" in columns)]
    for name in columns:
        if name.endswith("_degC"):
            c = np.interp(t, t[np.isfinite(columns[name])], columns[name][np.isfinite(columns[name])]) - 25
            found += [c, c**2, np.gradient(c, t)]
    return np.column_stack(found)


def error_of(columns, axis):
    return columns[f"rate_{axis}radps"] - columns.get(f"reference_rate_{axis}radps", 0.0)


def plain_fit(fit, judge, axis):
    """What stays of the error of `judge`."""
    x, y = regressors(fit, axis), error_of(fit, axis)
    there = np.isfinite(x).all(1) & np.isfinite(y)
    scale = np.maximum(np.abs(x[there]).max(0), 1e-300)
    coefficients = np.linalg.lstsq(x[there] / scale, y[there], rcond=None)[0] / scale
    return error_of(judge, axis) - regressors(judge, axis) @ coefficients
