# SPDX-License-Identifier: Apache-2.0
"""A gyro with an undeclared temperature effect."""

CYCLE_S = 2700  # of the temperature


def scenario(hertz, duration_s, coefficient=2.0e-8):
    return f"""
name = "undeclared"
sample_rate_hz = {hertz}
duration_s = {duration_s}
bias_radps = 5.0e-5
[noise]
N = 2.5e-8
B = 2.0e-9
[[channel]]
name = "temperature_degC"
shape = "cycle"
level = 27.0
amplitude = 4.0
period_s = {CYCLE_S}
noise = 0.02
resolution = 0.01
every_s = 1.0
[[effect]]
form = "linear"
channel = "temperature_degC"
coefficient = {coefficient}
reference = 25.0
"""
