#!/usr/bin/env python3
"""A second decoder, in another language and by the definitions, against `ifog convert`.

Takes a made-up capture through `ifog convert` to KVH bytes and to candump logs, decodes those here (the KVH manual's
table, CRC by long division, DBC signals one bit at a time), and compares with the capture and with what `ifog convert`
makes of the same files.   usage: run.py PATH_OF_IFOG SOURCE_DIR
"""
import csv
import math
import pathlib
import random
import re
import struct
import subprocess
import sys
import tempfile

ifog, source = sys.argv[1], pathlib.Path(sys.argv[2])
work = tempfile.TemporaryDirectory()
folder = pathlib.Path(work.name)
RATE_HZ = 250
random.seed(20)


def convert(*arguments):
    subprocess.run([ifog, "convert", *map(str, arguments)], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)


def columns(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def as_float(value):
    return struct.unpack(">f", struct.pack(">f", value))[0]


def same(what, expected, found, tolerance=0.0):
    assert len(expected) == len(found), f"{what}: {len(expected)} values expected, {len(found)} found"
    for i, (a, b) in enumerate(zip(expected, found)):
        ok = (math.isnan(a) and math.isnan(b)) or abs(a - b) <= tolerance * max(1.0, abs(a))
        assert ok, f"{what}: value {i} is {b!r}, expected {a!r}"


# The capture: three axes, a temperature at every row, 20 rows missing in the middle.
rows = []
for k in range(1200):
    if 500 <= k < 520:
        continue
    rows.append([k / RATE_HZ] + [random.gauss(0.0, 0.3) for _ in "xyz"] + [round(20.0 + 5.0 * math.sin(k / 300.0))])
capture = folder / "capture.csv"
with open(capture, "w", newline="") as file:
    writer = csv.writer(file)
    writer.writerow(["time_s", "rate_x_radps", "rate_y_radps", "rate_z_radps", "temperature_degC"])
    writer.writerows(rows)


def crc(data):
    remainder = 0xFFFFFFFF
    for byte in data:
        for bit in range(7, -1, -1):
            top = (remainder >> 31) ^ (byte >> bit & 1)
            remainder = (remainder << 1 & 0xFFFFFFFF) ^ (0x04C11DB7 if top else 0)
    return remainder


def check_kvh():
    assert crc(b"123456789") == 0x0376E6E7
    convert(capture, folder / "b.kvh", "--driver", "kvh1750", "--option", "format=b")
    data = (folder / "b.kvh").read_bytes()
    assert len(data) == 40 * len(rows)
    for i, row in enumerate(rows):
        frame = data[40 * i:40 * i + 40]
        fields = struct.unpack(">4s6fIBBhI", frame)
        assert fields[0] == bytes([0xFE, 0x81, 0xFF, 0x56]) and fields[11] == crc(frame[:36]), f"frame {i}"
        same(f"gyro of frame {i}", [as_float(value) for value in row[1:4]], fields[1:4])
        assert fields[7] == round(row[0] * 1e6) and fields[8] == 0x07, f"time or status of frame {i}"
        assert fields[9] == round(row[0] * RATE_HZ) % 128 and fields[10] == row[4], f"sequence or temperature of {i}"
    convert(folder / "b.kvh", folder / "b.csv", "--driver", "kvh1750", "--option", "format=b",
            "--option", f"rate_hz={RATE_HZ}")
    back = columns(folder / "b.csv")
    same("time", [row[0] for row in rows], back["time_s"])
    for axis, name in enumerate("xyz"):
        same(name, [as_float(row[1 + axis]) for row in rows], back[f"rate_{name}_radps"])
    same("temperature", [row[4] for row in rows], back["temperature_degC"])


SIGNAL = re.compile(r'^ SG_ (\w+) *: (\d+)\|(\d+)@([01])([+-]) \(([^,]+),([^)]+)\)')


def read_dbc(path):
    """{(id, signal): (start, length, little_endian, signed, factor, offset, is_float)}"""
    signals, floats, message = {}, set(), None
    for line in path.read_text().splitlines():
        if match := re.match(r"BO_ (\d+) ", line):
            message = int(match[1])
        elif match := SIGNAL.match(line):
            signals[message, match[1]] = (int(match[2]), int(match[3]), match[4] == "1", match[5] == "-",
                                          float(match[6]), float(match[7]))
        elif match := re.match(r"SIG_VALTYPE_ (\d+) (\w+) *: *1;", line):
            floats.add((int(match[1]), match[2]))
    return {key: (*value, key in floats) for key, value in signals.items()}


def value_of(signal, data):
    start, length, little, signed, factor, offset, is_float = signal
    raw, at = 0, start
    for i in range(length):
        bit = data[at // 8] >> at % 8 & 1
        if little:
            raw |= bit << i
            at += 1
        else:
            raw = raw << 1 | bit
            at = at + 15 if at % 8 == 0 else at - 1
    if is_float:
        return struct.unpack(">f", struct.pack(">I", raw))[0] * factor + offset
    if signed and raw >> (length - 1):
        raw -= 1 << length
    return raw * factor + offset


def frames(path):
    for line in path.read_text().splitlines():
        match = re.fullmatch(r"\((\d+\.\d{6})\) vcan0 ([0-9A-F]{3})#([0-9A-F]*)", line)
        assert match, line
        yield float(match[1]), int(match[2], 16), bytes.fromhex(match[3])


def check_dbc(name, options, axes, temperature, counter, scale):
    """axes: [(capture column, id, signal)]; scale: rad/s per unit of these signals."""
    path = source / "drivers/dbc/examples" / name
    signals = read_dbc(path)
    arguments = ["--dbc", path]
    for option in options:
        arguments += ["--option", option]
    single = folder / "single.csv"
    used = capture
    if len(axes) == 1:
        with open(single, "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["time_s", "rate_radps", "temperature_degC"])
            writer.writerows([row[0], row[1], row[4]] for row in rows)
        used = single
    convert(used, folder / "can.log", *arguments)
    found = {key: [] for key in [*axes, "temperature", "counter"]}
    for _, can_id, data in frames(folder / "can.log"):
        for key in axes:
            if can_id == key[1]:
                found[key].append(value_of(signals[key[1:]], data) * scale)
        if can_id == temperature[0]:
            found["temperature"].append(value_of(signals[temperature], data))
        if counter and can_id == counter[0]:
            found["counter"].append(value_of(signals[counter], data))
    same(f"{name} temperature", [row[4] for row in rows], found["temperature"])
    if counter:
        modulus = 1 << signals[counter][1]
        same(f"{name} counter", [round(row[0] * RATE_HZ) % modulus for row in rows], found["counter"])
    convert(folder / "can.log", folder / "can.csv", *arguments, "--option", f"rate_hz={RATE_HZ}")
    back = columns(folder / "can.csv")
    for key in axes:
        original = [row[1 + "xyz".index(key[0])] for row in rows]
        same(f"{name} {key[2]}", original, found[key], 1e-7)
        column = f"rate_{key[0]}_radps" if len(axes) > 1 else next(c for c in back if c.startswith("rate_"))
        same(f"{name} {column} by ifog", found[key], back[column], 1e-15)


check_kvh()
check_dbc("ifogd_gyro.dbc", ["x=Rate_x", "y=Rate_y", "z=Rate_z", "counter=Counter",
                             "environment=temperature_degC=Temperature"],
          [("x", 256, "Rate_x"), ("y", 257, "Rate_y"), ("z", 258, "Rate_z")], (272, "Temperature"), (256, "Counter"), 1.0)
# Big-endian floats, deg/s, a scaled temperature in another frame, no counter.
check_dbc("racelogic_yaw03.dbc", ["z=Yaw_Rate", "environment=temperature_degC=Temp"],
          [("x", 1536, "Yaw_Rate")], (1537, "Temp"), None, math.pi / 180.0)
print("KVH bytes and CAN frames: the second decoder reads the same")
