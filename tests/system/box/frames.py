# SPDX-License-Identifier: Apache-2.0
"""Frames according to the makers' descriptions, packed here without the project's encoders."""
import math
import struct
import time

CAN_ID = 0x120
DBC = f"""VERSION ""
BS_:
BU_: GYRO
BO_ {CAN_ID} Gyro: 8 GYRO
 SG_ Rate : 0|32@1- (1E-09,0) [-2|2] "rad/s" GYRO
 SG_ Counter : 32|16@1+ (1,0) [0|65535] "" GYRO
 SG_ Status : 48|8@1+ (1,0) [0|255] "" GYRO
 SG_ Temperature : 56|8@1- (1,0) [-128|127] "degC" GYRO
"""


def crc32_mpeg2(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte << 24
        for _ in range(8):
            crc = (crc << 1 ^ 0x04C11DB7 if crc & 0x80000000 else crc << 1) & 0xFFFFFFFF
    return crc


assert crc32_mpeg2(b"123456789") == 0x0376E6E7


def rate(sample, hertz):
    """A rotation of 0.1 rad/s at 0.5 Hz with a noise of 3e-5 rad/s (Knuth's multiplicative hash)."""
    noise = (sample * 2654435761 % 2**32 / 2**32 - 0.5) * 1e-4
    return 0.1 * math.sin(math.pi * sample / hertz) + noise


def kvh1750_of(sample, rates, temperature_degC=25):
    """Format A of the KVH 1750 IMU, 36 bytes; all sensors valid."""
    body = b"\xfe\x81\xff\x55" + struct.pack(">6fBBh", *rates, 0.0, 0.0, 1.0, 0x77, sample % 128, temperature_degC)
    return body + struct.pack(">I", crc32_mpeg2(body))


def kvh1750(sample, hertz):
    """With the rate() of that sample."""
    return kvh1750_of(sample, (rate(sample, hertz), 0.001, -0.001))


def angle(begin, count, hertz):
    """Angle about axis x of `count` samples from number `begin` on, each rate as float32."""
    return sum(struct.unpack(">f", struct.pack(">f", rate(n, hertz)))[0] / hertz for n in range(begin, begin + count))


def misread(sent, sent_baud, read_baud):
    """Bytes that a UART reads at read_baud from data sent at sent_baud, 8N1: it samples in the middle of each bit. A byte with a
    low stop bit has a framing error and is passed on, as in the 8250."""
    line = bytearray()
    for byte in sent:
        line += bytes([0] + [byte >> bit & 1 for bit in range(8)] + [1])
    step, at, got = sent_baud / read_baud, 0.0, bytearray()
    while True:
        start = line.find(0, int(at))
        last = start + 9.5 * step
        if start < 0 or last >= len(line):
            return bytes(got)
        got.append(sum(line[int(start + (1.5 + bit) * step)] << bit for bit in range(8)))
        at = last
        if line[int(last)] == 0:  # the next start bit follows the next high level
            at = line.find(1, int(last))
            if at < 0:
                return bytes(got)


def candump(samples, hertz, interface, start=1_700_000_000.0):
    """A candump log of the gyro DBC describes."""
    lines = []
    for sample in range(samples):
        data = struct.pack("<iHBb", round(rate(sample, hertz) / 1e-9), sample % 65536, 0, 25)
        lines.append(f"({start + sample / hertz:.6f}) {interface} {CAN_ID:03X}#{data.hex().upper()}\n")
    return "".join(lines)


def late_by(sample, period):
    """Delay of a sample relative to an even clock, s: pseudo-random, and every 500th delays the following ones for ten periods."""
    wait = (sample * 2654435761 % 2**32 / 2**32) * 0.4 * period
    return max(wait, (10 - sample % 500) * period)


def unevenly(log):
    """A candump log whose frames are delayed by late_by(), in the same order."""
    lines = log.splitlines()
    stamps = [float(line[1:line.index(")")]) for line in lines]
    period = (stamps[-1] - stamps[0]) / (len(stamps) - 1)
    return "".join(f"({stamp + late_by(n, period):.6f}){line[line.index(')') + 1:]}\n" for n, (stamp, line) in enumerate(zip(stamps, lines)))


def heard(path):
    """(time in s, frame as text) of each line of a candump log."""
    with open(path) as file:
        return [(float(stamp.strip("()")), frame) for stamp, _, frame in (line.split() for line in file)]


def off_time(recorded, again, stops=()):
    """Delay of each arrival relative to its recorded time, s, from (time, ...) lists of equal length. The earliest tenth
    determines the offset of the clocks, because disturbances only delay. Ignores the times when the machine was stopped,
    (from, to), and the same duration afterwards."""
    apart = [b[0] - a[0] for a, b in zip(recorded, again)]
    shift = sorted(apart)[len(apart) // 10]
    kept, stops = [], sorted(stops)
    for (due, *_), each in zip(recorded, apart):
        while stops and 2 * stops[0][1] - stops[0][0] < due + shift:
            stops.pop(0)
        if not stops or due + shift < stops[0][0] - 0.001:
            kept.append(abs(each - shift))
    return kept


def send_paced(link, frames, hertz):
    """Sends each frame at its own time with absolute deadlines."""
    begin = time.monotonic()
    for index, frame in enumerate(frames):
        ahead = begin + index / hertz - time.monotonic()
        if ahead > 0:
            time.sleep(ahead)
        link.sendall(frame)
