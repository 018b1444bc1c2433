#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""An independent decoder in another language, written from the definitions, compared with `ifog convert`.

Packs CAN frames bit by bit from a handwritten DBC file, in both formats of candump, and compares the result of `ifog convert`.
Converts a generated capture with `ifog convert` to KVH bytes and to candump logs, decodes them here (the KVH manual's table, CRC
by long division, DBC signals bit by bit), and compares with the capture and with the result of `ifog convert` for the same files.
usage: run.py PATH_OF_IFOG SOURCE_DIR
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


# A bus in handwritten form: comments, several signals per line, nodes and receivers on further lines, statements
# without ';', an unreadable line, a name by attribute.
BY_HAND = """// a bench
VERSION "1"
BU_:
  Box // on the next line
BO_ 1073741824 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX
BO_ 291 Rates: 8 Box SG_ Which M : 0|8@1+ (1,0) [0|0] "" X SG_ Count : 8|8@1+ (1,0) [0|0] ""
  X,
  Y
 SG_ Yaw_Rate_0001 m1 : 16|32@1- (1,0) [0|0] "\xb0/sec" X
 SG_ Pitch_Rate m : 23|20@0- (0.002,0) [0|0] "mrad/s" X // Motorola
 SG_ Broken : 0|33x@1- (1,0) [0|0] "rad/s" X
CM_ BO_ 291 "no end here"
BO_ 292 More: 8 Box
 SG_ Temperature : 7|12@0- (0.1,5) [0|0] "degC" X
BA_ "SystemSignalLongSymbol" SG_ 291 Yaw_Rate_0001 "Yaw_Rate_Of_The_Bench_With_A_Long_Name";
SG_MUL_VAL_ 291 Pitch_Rate Which 2-2, 7-7
SIG_VALTYPE_ 291 Yaw_Rate_0001 : 1"""


def pack(data, start, length, little, value):
    """Writes the low bits of value into a bytearray."""
    at = start
    for i in range(length):
        bit = value >> i & 1 if little else value >> (length - 1 - i) & 1
        data[at // 8] = data[at // 8] & ~(1 << at % 8) | bit << at % 8
        at = at + 1 if little else (at + 15 if at % 8 == 0 else at - 1)


def screen_line(stamp, can_id, data, characters):
    """As printed by candump: sprintf in can-utils' lib.c."""
    text = "".join(chr(byte) if 0x20 < byte < 0x7F else "." for byte in data)
    return (f" ({stamp:010.6f})" if stamp is not None else "") + f"  can0  {can_id:03X}   [{len(data)}]  " + \
        " ".join(f"{byte:02X}" for byte in data) + (f"   '{text}'" if characters else "") + "\n"


def check_by_hand():
    path = folder / "by_hand.dbc"
    path.write_bytes(BY_HAND.encode("latin-1"))
    rng = random.Random(12)
    yaw, pitch, temperature, sent = [], [], [], []
    for k in range(600):
        single = struct.unpack("<I", struct.pack("<f", rng.gauss(0.0, 20.0)))[0]
        steps, tenths = rng.randrange(-1 << 19, 1 << 19), rng.randrange(-300, 600)
        yaw.append(math.radians(struct.unpack("<f", struct.pack("<I", single))[0]))
        pitch.append(steps * 0.002 * 1e-3)
        temperature.append(tenths * 0.1 + 5)
        warm, first, second = bytearray(8), bytearray(8), bytearray(8)
        pack(warm, 7, 12, False, tenths)
        for data, which in ((first, 1), (second, rng.choice((2, 7)))):
            pack(data, 0, 8, True, which)
            pack(data, 8, 8, True, k)
        pack(first, 16, 32, True, single)
        pack(second, 23, 20, False, steps)
        sent.append((0.004 * k, 292, warm))
        sent.append((0.004 * k + 0.0005, 291, first))
        sent.append((0.004 * k + 0.001, 291, second))
    arguments = ["--dbc", path, "--option", "x=Yaw_Rate_Of_The_Bench_With_A_Long_Name", "--option", "y=Rates.Pitch_Rate",
                 "--option", "counter=Count", "--option", f"rate_hz={RATE_HZ}",
                 "--option", "environment=temperature_degC=Temperature"]
    for kind in ("log", "zero", "difference", "absolute", "none"):
        log, before = folder / f"{kind}.candump", 0.0
        with open(log, "w") as file:
            for i, (time, can_id, data) in enumerate(sent):
                stamp = {"zero": time, "difference": time - before, "absolute": 1436509052 + time, "none": None}.get(kind)
                before = time
                if kind == "log":
                    file.write(f"({1436509052 + time:.6f}) can0 {can_id:03X}#{data.hex().upper()}\n")
                else:
                    file.write(screen_line(stamp, can_id, data, i % 2 == 0))
        convert(log, folder / f"{kind}.csv", *arguments)
        back = columns(folder / f"{kind}.csv")
        same(f"{kind} yaw", yaw, back["rate_x_radps"], 1e-15)
        same(f"{kind} pitch", pitch, back["rate_y_radps"], 1e-15)
        same(f"{kind} temperature", temperature, back["temperature_degC"], 1e-15)
        # Without the counter the lines' times are used, from the first sample's last frame on.
        timed = [option for pair in zip(arguments[::2], arguments[1::2]) if pair[1] not in
                 ("counter=Count", f"rate_hz={RATE_HZ}") for option in pair]
        if kind != "none":
            convert(log, folder / "timed.csv", *timed)
            began = 0.001 + (1436509052 if kind in ("log", "absolute") else 0)
            same(f"{kind} time", [began + 0.004 * k for k in range(600)], columns(folder / "timed.csv")["time_s"], 1e-6)
    refused = subprocess.run([ifog, "convert", log, folder / "no.csv", "--dbc", path, "--option", "x=Broken"],
                             capture_output=True, text=True)
    assert refused.returncode == 1 and f"{path}:11: " in refused.stderr, refused.stderr


check_kvh()
check_by_hand()
check_dbc("ifogd_gyro.dbc", ["x=Rate_x", "y=Rate_y", "z=Rate_z", "counter=Counter",
                             "environment=temperature_degC=Temperature"],
          [("x", 256, "Rate_x"), ("y", 257, "Rate_y"), ("z", 258, "Rate_z")], (272, "Temperature"), (256, "Counter"), 1.0)
# Big-endian floats, deg/s, a scaled temperature in another frame, no counter.
check_dbc("racelogic_yaw03.dbc", ["z=Yaw_Rate", "environment=temperature_degC=Temp"],
          [("x", 1536, "Yaw_Rate")], (1537, "Temp"), None, math.pi / 180.0)
print("KVH bytes and CAN frames: the second decoder reads the same")
