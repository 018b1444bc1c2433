# SPDX-License-Identifier: Apache-2.0
"""Simulated gyros of one type: most are sensitive to the temperature, with about five standard errors, some are not."""
import subprocess

COEFFICIENT = 6.0e-9  # rad/s per degC
WITH = [f"G{i:02}" for i in range(1, 13)]
CLEAN = [f"G{i:02}" for i in range(13, 17)]
SCENARIO = """
seed = 1
sample_rate_hz = {hertz}
duration_s = {seconds}
bias_radps = 5.0e-5
[noise]
N = 2.5e-8
B = 1.0e-8
K = 1.0e-10
[[channel]]
name = "temperature_degC"
shape = "cycle"
level = 27.0
amplitude = 3.0
period_s = 200
noise = 0.02
resolution = 0.01
every_s = 1.0
[[channel]]
name = "supply_V"
shape = "gauss_markov"
level = 12.0
sigma = 0.2
correlation_s = 60
"""
EFFECT = f"""
[[effect]]
form = "linear"
channel = "temperature_degC"
coefficient = {COEFFICIENT}
reference = 25.0
"""


def make(ifog, folder, seconds=600, gyros=WITH + CLEAN, hertz=10):
    """SERIAL.csv of each, and lot.toml."""
    (folder / "with.scenario").write_text(SCENARIO.format(seconds=seconds, hertz=hertz) + EFFECT)
    (folder / "clean.scenario").write_text(SCENARIO.format(seconds=seconds, hertz=hertz))
    manifest = 'type = "T1"\n'
    for seed, serial in enumerate(gyros, 1):
        scenario = "with" if serial in WITH else "clean"
        subprocess.run([ifog, "simulate", f"{scenario}.scenario", "--seed", str(seed), "--output", f"{serial}.csv"], cwd=folder, check=True, capture_output=True)
        manifest += f'[[gyro]]\nserial = "{serial}"\ncaptures = ["{serial}.csv"]\n'
    (folder / "lot.toml").write_text(manifest)
