# SPDX-License-Identifier: Apache-2.0
"""Captures for measurements from fixed seeds, each made once in a folder, by its number of rows."""
import math
import os
import random
import struct
import subprocess
import sys
from pathlib import Path

HEADER = ("time_s,rate_x_radps,rate_y_radps,rate_z_radps,temperature_degC,temperature_board_degC,accel_x_mps2,"
          "accel_y_mps2,accel_z_mps2,supply_V,field_x_uT,field_y_uT")
MESSAGES = Path(__file__).resolve().parents[3] / "msgs"
POOL = 1 << 16        # pool of random rows
SHIFTED = 0.05        # K per 1000 s of temperature


def apart(make):
    """In a separate process, because the peak memory of a child begins with that of its parent."""
    def made_apart(folder, rows):
        child = os.fork()
        if child == 0:
            make(folder, rows)
            os._exit(0)
        if os.waitpid(child, 0)[1] != 0:
            sys.exit(f"run: no capture of {rows} rows in {folder}")
        return capture_of(make, folder, rows)
    return made_apart


def capture_of(make, folder, rows):
    if make.__name__ == "lcm_log":
        return lcm_log_of(folder, rows)
    return folder / f"{'narrow' if make.__name__ == 'narrow' else 'gyro'}_{rows}.csv"


@apart
def made(folder, rows):
    """A capture with this number of rows; the first rows of a longer one are equal."""
    capture = folder / f"gyro_{rows}.csv"
    if capture.exists():
        return
    draw = random.Random(20)
    pool = [",".join(f"{draw.gauss(7.3e-5, 2e-5):.9e}" for _ in range(3)) for _ in range(POOL)]
    rest = [",".join((f"{draw.gauss(30, 0.01):.3f}", f"{draw.gauss(0.05, 0.02):.4f}", f"{draw.gauss(0, 0.02):.4f}",
                      f"{draw.gauss(9.81, 0.02):.4f}", f"{draw.gauss(5, 0.002):.4f}", f"{draw.gauss(20, 0.1):.2f}",
                      f"{draw.gauss(-3, 0.1):.2f}")) + "\n" for _ in range(POOL)]
    part = capture.with_suffix(".part")
    with open(part, "w") as out:
        out.write(HEADER + "\n")
        step = 100000
        for first in range(0, rows, step):
            n = min(step, rows - first)
            warm = [f",{25 + 5 * math.sin(t * 1e-4) + SHIFTED * t * 1e-3:.3f}," for t in range(first // 1000, first // 1000 + 101)]
            out.write("".join(f"{i // 1000}.{i % 1000:03d},{a}{warm[(i - first) // 1000]}{b}" for i, a, b in zip(
                range(first, first + n), draw.choices(pool, k=n), draw.choices(rest, k=n))))
    part.rename(capture)


@apart
def narrow(folder, rows):
    """One axis and a temperature, for inputs that are only read as text."""
    capture = folder / f"narrow_{rows}.csv"
    draw = random.Random(21)
    pool = [f",{draw.gauss(7.3e-5, 2e-5):.6e},{draw.gauss(30, 0.01):.3f}\n" for _ in range(POOL)]
    with open(capture, "w") as out:
        out.write("time_s,rate_radps,temperature_degC\n")
        step = 100000
        for first in range(0, rows, step):
            out.write("".join(f"{i // 1000}.{i % 1000:03d}{a}" for i, a in zip(
                range(first, min(first + step, rows)), draw.choices(pool, k=step))))


@apart
def lcm_log(folder, rows):
    """One axis and a temperature in a separate message at intervals, as written by lcm-logger."""
    subprocess.run(["lcm-gen", "-p", "--ppath", folder, *(MESSAGES / name for name in ("rate_t.lcm", "channel_t.lcm"))], check=True)
    sys.path.insert(0, str(folder))
    import ifog
    rate, channel = ifog.rate_t(), ifog.channel_t()
    rate.axes, rate.sensor_time_ns, rate.merged, rate.dt = 1, -1, 1, 1e-3
    channel.name = "hull_degC"
    for name in ("raw", "compensated", "denoised", "variance", "delta_theta", "covered", "angle", "innovation", "innovation_variance", "gain"):
        setattr(rate, name, [0.0])
    body, raw_at = bytearray(rate.encode()), 8 + 4 * 8 + 8 + 3 * 4 + 1  # after hash, times, dt, integers, axes
    draw = random.Random(22)

    def event(number, name, content):
        head = struct.pack(">IqqII", 0xEDA1DA01, number, 1000 * number, len(name), len(content))
        return b"".join((head, name, content))

    with open(lcm_log_of(folder, rows), "wb") as out:
        for i in range(rows):
            if i % 1000 == 0:
                channel.value = 25 + 1e-6 * i
                out.write(event(i, b"HULL", channel.encode()))
            struct.pack_into(">q", body, 8, 1700000000000000 + 1000 * i)
            struct.pack_into(">d", body, raw_at, draw.gauss(7.3e-5, 2e-5))
            out.write(event(i, b"IFOG_NOSE", body))


def lcm_log_of(folder, rows):
    return folder / f"log_{rows}.lcm"
