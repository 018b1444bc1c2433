#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Types of other programs on LCM. Ours have the hashes of the public definitions, whose members are listed here. A subscriber built
from those receives the messages of a real daemon with correct values, units and times, and their logs are captures for every
command. Oracle: the sent data, and lcm-gen's code for the public members.

usage: peers.py BUILD
"""
import importlib
import math
import os
import random
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, ".."))
import private_network  # noqa: E402
from lcm_log import read_log, write_log  # noqa: E402

URL = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4000000"
ROWS, RATE_HZ, EPOCH_us, G = 3000, 500, 1_700_000_000_000_000, 9.80665
INS = "double gyro[3]; double mag[3]; double accel[3]; double quat[4]; double pressure; double rel_alt;"
# ipab-slmc/lcm_catkin bot_core_lcmtypes, openhumanoids/microstrain, USYD-RowBot/acfr-lcm lcmdefs/senlcm: only the members.
PUBLIC = {
    "bot_core.ins_t": "int64_t utime; int64_t device_time; " + INS,
    "bot_core.kvh_raw_imu_t": "int64_t utime; int64_t packet_count; double delta_rotation[3]; double linear_acceleration[3];",
    "bot_core.kvh_raw_imu_batch_t": "int64_t utime; int32_t num_packets; kvh_raw_imu_t raw_imu[num_packets];",
    "microstrain.ins_t": INS + " double device_time; int64_t utime;",
    "senlcm.kvh1750_t": "int64_t utime; double angular[3]; double linear[3]; double temperature; int8_t status; int8_t sequence;",
    "senlcm.kvh_dsp3000_t": "int64_t utime; int8_t mode; double data;",
    "senlcm.IMU_t": "int64_t utime; double angRate[3]; double accel[3]; double deltaAngle[3]; double deltaVelocity[3];",
    "senlcm.raw_t": "int64_t utime; int32_t length; byte data[length];",
    "senlcm.raw_ascii_t": "int64_t utime; string msg;",
}
# JuliaRobotics/BotCoreLCMTypes.jl (test/runtests.jl) checks its types with these, as the bytes of the hash in reverse order.
JULIA = {"bot_core.ins_t": 4613985382350956424, "bot_core.kvh_raw_imu_t": 2860203241911737633, "bot_core.kvh_raw_imu_batch_t": 8667107086997737736}
CONFIG = f"""[daemon]
lock_memory = false
lcm_url = "{URL}"
[[sensor]]
name = "nose"
driver = "kvh1750"
[sensor.options]
format = "b"
rate_hz = {RATE_HZ}
[sensor.filter]
process_noise = 1e-10
measurement_noise = 1e-8
[sensor.transport]
type = "file"
path = "sent.kvh"
pace = "recorded"
bytes_per_second = {40 * RATE_HZ}
[[sensor.publish]]
type = "bot_core.ins_t"
channel = "INS"
[[sensor.publish]]
type = "microstrain.ins_t"
channel = "MICROSTRAIN"
[[sensor.publish]]
type = "bot_core.kvh_raw_imu_batch_t"
channel = "BATCH"
[[sensor.publish]]
type = "ifog.inertial_t"
channel = "FORCE"
"""
failed = 0


def check(good, what):
    global failed
    print("ok      " if good else "FAILED  ", what, flush=True)
    failed += not good


def rates(row):
    return [round(0.01 + 1e-5 * row, 9), round(-0.02 + 3e-6 * row, 9), round(0.03 * math.sin(row / 200), 9)]


def forces(row):
    return [round(0.2 + 1e-4 * row, 9), round(-0.5, 9), round(G + 0.01 * math.cos(row / 100), 9)]


def near(got, sent, part=1e-6):
    """A float32 on the wire, and a period in whole µs."""
    return all(abs(a - b) <= part * max(1e-3, abs(b)) for a, b in zip(got, sent))


def types_of(texts, folder):
    """The module of each package from lcm-gen, and the hash of each type."""
    os.makedirs(folder)
    for name, text in texts.items():
        with open(f"{folder}/{name}.lcm", "w") as file:
            file.write(text)
    files = [f"{folder}/{name}.lcm" for name in texts]
    subprocess.run(["lcm-gen", "--python", "--ppath", folder, "--cpp", "--cpp-hpath", folder, *files], check=True, stdout=subprocess.DEVNULL)
    sys.path.insert(0, folder)
    modules = {package: importlib.import_module(package) for package in {name.split(".")[0] for name in texts}}
    hashes = {name: modules[name.split(".")[0]].__dict__[name.split(".")[1]]()._get_packed_fingerprint() for name in texts}
    sys.path.pop(0)
    for loaded in [name for name in sys.modules if name.split(".")[0] in modules]:
        del sys.modules[loaded]
    return modules, hashes


def ran(build, *words):
    done = subprocess.run([os.path.join(build, "tools/ifog/ifog"), *words], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, done.stdout + done.stderr


def capture(build, log, *words):
    """Exit status, output, header and rows."""
    code, said = ran(build, "convert", log, log + ".csv", *words)
    if code != 0:
        return code, said, [], []
    with open(log + ".csv") as file:
        lines = [line.strip().split(",") for line in file if not line.startswith("#")]
    return code, said, lines[0], [[float(cell) if cell else math.nan for cell in line] for line in lines[1:]]


def hashes(modules):
    public, mine = modules
    check(public == mine and len(mine) == len(PUBLIC), f"the hashes of {len(mine)} types are those of the public members")
    backwards = {name: struct.unpack("<q", public[name])[0] for name in JULIA}
    check(backwards == JULIA, "and those that another project holds its own to")


def published(build):
    """A daemon, a peer's subscriber and a logger."""
    with open("sent.csv", "w") as file:
        file.write("time_s,rate_x_radps,rate_y_radps,rate_z_radps,accel_x_mps2,accel_y_mps2,accel_z_mps2,temperature_degC\n")
        file.writelines(f"{row / RATE_HZ},{','.join(map(repr, rates(row) + forces(row)))},25\n" for row in range(ROWS))
    code, said = ran(build, "convert", "sent.csv", "sent.kvh", "--driver", "kvh1750", "--option", "format=b", "--option", f"rate_hz={RATE_HZ}")
    assert code == 0, said
    with open("ifogd.toml", "w") as file:
        file.write(CONFIG)
    flags = subprocess.run(["pkg-config", "--cflags", "--libs", "lcm"], capture_output=True, text=True, check=True).stdout.split()
    subprocess.run(["c++", "-std=c++17", "-Ipublic", os.path.join(HERE, "peer_subscriber.cpp"), "-o", "peer", *flags], check=True)
    with open("heard", "w") as heard:
        peer = subprocess.Popen(["./peer", URL, "60"], stdin=subprocess.DEVNULL, stdout=heard)
        recorder = subprocess.Popen([os.path.join(build, "tests/system/lcm_record"), URL, ".*", "all.lcm"], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        time.sleep(1)
        began = time.time()
        daemon = subprocess.run([os.path.join(build, "daemon/ifogd"), "--config", "ifogd.toml"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                timeout=60, check=False)
        ended = time.time()
        check(daemon.returncode == 0 and "publishing bot_core.ins_t on INS" in daemon.stdout + daemon.stderr, "the daemon says what it publishes where")
        assert peer.wait(60) == 0
        recorder.terminate()
        assert recorder.wait(20) == 0
    by_channel = {"INS": [], "MICROSTRAIN": [], "BATCH": []}
    with open("heard") as file:
        for line in file:
            channel, *numbers = line.split()
            by_channel[channel].append([float(number) for number in numbers])
    for channel, second in (("INS", 1e6), ("MICROSTRAIN", 1.0)):
        judge_ins(channel, second, by_channel[channel], began, ended)
    judge_batches(by_channel["BATCH"])


def judge_ins(channel, second, messages, began, ended):
    check(len(messages) >= ROWS - 1, f"{channel}: a peer hears {len(messages)} of {ROWS} samples")
    behind = ROWS - len(messages)
    # The daemon does not know the duration of the first sample before the second.
    good = [near(m[2:5], rates(n + behind)) and near(m[5:8], forces(n + behind)) for n, m in enumerate(messages)]
    check(sum(good) == len(good) > 0, f"{channel}: rates in rad/s and specific force in m/s² of {sum(good)} are those that were sent")
    check(all(value == 0 for m in messages for value in m[8:]), f"{channel}: what a gyro does not know is 0")
    steps = [(b[1] - a[1]) / second for a, b in zip(messages, messages[1:])]
    check(all(abs(step - 1 / RATE_HZ) < 1e-9 for step in steps), f"{channel}: the device's clock goes on by {1 / RATE_HZ} s a message")
    times = [m[0] * 1e-6 for m in messages]
    step = statistics.median(b - a for a, b in zip(times, times[1:]))
    check(all(began - 1 <= t <= ended + 1 for t in times) and abs(step * RATE_HZ - 1) < 0.02,
          f"{channel}: the time of each is the wall clock's, mostly {1e3 * step:.4f} ms a message")


def judge_batches(messages):
    packets = [[m[at:at + 8] for at in range(1, len(m), 8)] for m in messages]
    check(len(messages) >= ROWS - 1 and max(map(len, packets)) == 15, f"BATCH: {len(messages)} batches of up to 15 packets")
    check(all(p[0][0] == m[0] and all(a[1] == b[1] + 1 and a[0] > b[0] for a, b in zip(p, p[1:])) for m, p in zip(messages, packets)),
          "BATCH: the newest packet is the first, counts and times go back from it")
    behind = ROWS - len(messages)
    good = [near([x * RATE_HZ for x in p[0][2:5]], rates(n + behind), 1e-5) and near(p[0][5:8], forces(n + behind)) for n, p in enumerate(packets)]
    check(sum(good) == len(good) > 0, f"BATCH: angle in rad a packet and specific force of {sum(good)} are what was sent")


def judge_capture(what, found, columns, part, samples=range(ROWS), by_period=False):
    """The rows are these samples in this order. Their times are the daemon's fit of arrival times, which a busy machine delays;
    by_period: the rates are angles divided by the period of those times."""
    code, said, header, rows = found
    if code != 0:
        return check(False, f"{what}: {said.strip()}")
    check(header == ["time_s"] + columns, f"{what}: {','.join(header)}")
    check(len(rows) == len(samples), f"{what}: {len(rows)} samples, expected {len(samples)}")
    period = statistics.median(row[1] / rates(n)[0] for n, row in zip(samples, rows)) if by_period else 1
    check(abs(period - 1) < 0.05, f"{what}: the period is known to {abs(period - 1):.1g}")
    bad = [n for n, row in zip(samples, rows) if not near([rate / period for rate in row[1:4]], rates(n), part) or not near(row[4:7], forces(n), 1e-5)]
    check(not bad, f"{what}: rates and specific force are those that were sent{'' if not bad else f', not {len(bad)} as {bad[:3]}'}")
    steps = [b[0] - a[0] for a, b in zip(rows, rows[1:])]
    check(min(steps) > 0 and abs(statistics.median(steps) * RATE_HZ - 1) < 0.02, f"{what}: the time goes on, mostly by {statistics.median(steps):.6f} s")
    return None


COLUMNS = ["rate_x_radps", "rate_y_radps", "rate_z_radps", "accel_x_mps2", "accel_y_mps2", "accel_z_mps2"]


def logged(build):
    """Messages of the daemon from a log; a batch log that loses datagrams."""
    events = read_log("all.lcm")
    first = ROWS - len([1 for channel, _, _ in events if channel == "INS"])
    published = range(first, ROWS)
    for channel, part in (("INS", 1e-6), ("MICROSTRAIN", 1e-6), ("BATCH", 1e-4)):
        judge_capture(f"log {channel}", capture(build, "all.lcm", "--channel", channel), COLUMNS, part, published, channel == "BATCH")
    judge_capture("log FORCE", capture(build, "all.lcm", "--channel", "FORCE"), COLUMNS + ["temperature_degC"], 1e-6, published)
    batches = [event for event in events if event[0] == "BATCH"]
    dice = random.Random(7)
    lost = {at + k for at in dice.sample(range(50, len(batches) - 50, 40), 30) for k in range(14)}
    write_log("lossy.lcm", [event for n, event in enumerate(batches) if n not in lost])
    found = capture(build, "lossy.lcm")
    judge_capture(f"{len(lost)} of {len(batches)} datagrams lost, never 15 in a row", found, COLUMNS, 1e-4, published, True)
    check("missing" not in found[1], "nothing is said to be missing")
    write_log("more.lcm", [event for n, event in enumerate(batches) if not 1000 <= n < 1020])
    found = capture(build, "more.lcm")
    judge_capture("20 datagrams lost in a row", found, COLUMNS, 1e-4, [*published[:1000], *published[1006:]], True)
    check("6 samples on BATCH are missing by their counts" in found[1], "the six that were in no other are counted: " + found[1].strip().split("\n")[-1])
    code, said = ran(build, "allan", "all.lcm", "--channel", "INS", "--axis", "x", "--moving", "keep")
    check(code == 0, "allan takes it: " + said.strip().split("\n")[0])
    code, said, _, _ = capture(build, "lossy.lcm", "--channel", "NONE")
    check(code == 1 and "no message on channel NONE" in said, "another channel is refused: " + said.strip())


def foreign(build, modules):
    """Logs of acfr-lcm, made with lcm-gen's code for the public members."""
    senlcm = modules["senlcm"]
    frames, lines, imus = [], [], []
    for row in range(ROWS):
        utime = EPOCH_us + row * 1_000_000 // RATE_HZ
        frame, line, imu = senlcm.kvh1750_t(), senlcm.kvh_dsp3000_t(), senlcm.IMU_t()
        frame.utime = line.utime = imu.utime = utime
        frame.angular, frame.linear = rates(row), [force / G for force in forces(row)]
        frame.temperature, frame.status, frame.sequence = 25, 0x77 if row != 77 else 0x76, row % 128
        imu.angRate, imu.accel = rates(row), forces(row)
        line.mode, line.data = 1, rates(row)[0]
        if not 1000 <= row < 1300:
            frames.append(("KVH1750", utime, frame.encode()))
        lines.append(("KVH", utime, line.encode()))
        imus.append(("IMU", utime, imu.encode()))
    write_log("kvh1750.lcm", frames)
    code, said, header, rows = capture(build, "kvh1750.lcm")
    check(code == 0 and header == ["time_s"] + COLUMNS + ["temperature_degC"] and len(rows) == ROWS - 300, f"kvh1750_t: {len(rows)} rows of {','.join(header)}")
    check("300 samples on KVH1750 are missing by their counts" in said, "kvh1750_t: two rollovers and 44 are counted: " + said.strip().split("\n")[-1])
    numbers = [round(row[0] * RATE_HZ) for row in rows]
    check(all(near(row[2:4], rates(n)[1:], 1e-9) and near(row[4:7], forces(n), 1e-9) for n, row in zip(numbers, rows)), "kvh1750_t: rad/s and g become rad/s and m/s²")
    check([n for n, row in zip(numbers, rows) if math.isnan(row[1])] == [77], "kvh1750_t: an axis that the status says is invalid is missing")
    write_log("imu.lcm", imus)
    judge_capture("senlcm.IMU_t", capture(build, "imu.lcm"), COLUMNS, 1e-9)
    write_log("two.lcm", lines + imus)
    code, said = ran(build, "convert", "two.lcm", "two.csv")
    check(code == 1 and "expected --channel with one of IMU, KVH" in said, "two channels must be chosen from: " + said.strip())
    wrong = modules["bot_core"].ins_t()
    for wrong.utime, wrong.device_time, good in ((2**63 - 1, 0, False), (-2**63, 0, False), (EPOCH_us, -2**63, True)):
        write_log("time.lcm", [("INS", EPOCH_us, wrong.encode())])
        code, said = ran(build, "convert", "time.lcm", "time.csv")
        check((code == 0) if good else "is no bot_core.ins_t that can be" in said, f"a time of {wrong.utime} µs: " + said.strip())
    again = []
    for row in range(800):  # the sensor is switched on again at the 300th
        batch, count = modules["bot_core"].kvh_raw_imu_batch_t(), row if row < 300 else row - 300
        for age in range(min(15, count + 1)):
            packet = modules["bot_core"].kvh_raw_imu_t()
            packet.utime, packet.packet_count = EPOCH_us + (row - age) * 2000, count - age
            packet.delta_rotation, packet.linear_acceleration = [rate / RATE_HZ for rate in rates(row - age)], forces(row - age)
            batch.raw_imu.append(packet)
        batch.utime, batch.num_packets = EPOCH_us + row * 2000, len(batch.raw_imu)
        again.append(("BATCH", batch.utime, batch.encode()))
    write_log("again.lcm", again)
    judge_capture("a sensor that was switched on again", capture(build, "again.lcm"), COLUMNS, 1e-9, range(800))
    batch = modules["bot_core"].kvh_raw_imu_batch_t().encode()
    for name, data in [("senlcm.IMU_t", imus[0][2][:-8])] + [("bot_core.kvh_raw_imu_batch_t", batch[:16] + struct.pack(">i", n)) for n in (-1, 1, 2**31 - 1)]:
        write_log("cut.lcm", [("IMU", EPOCH_us, data)])
        code, said = ran(build, "convert", "cut.lcm", "cut.csv")
        check(code == 1 and f"is no {name} that can be" in said, "bytes that are none are refused: " + said.strip())


def dsp3000(build, senlcm):
    """kvh_dsp3000_t in its three modes."""
    modes, angle = {"rate": [], "delta": [], "angle": []}, 0.0
    for row in range(ROWS):
        utime, rate = EPOCH_us + row * 1_000_000 // RATE_HZ, rates(row)[0]
        angle += rate / RATE_HZ
        for mode, (name, data) in enumerate((("rate", rate), ("delta", rate / RATE_HZ), ("angle", angle)), 1):
            line = senlcm.kvh_dsp3000_t()
            line.utime, line.mode, line.data = utime + (row % 3 * 100 if mode > 1 else 0), mode, data  # a host's stamps jitter
            if mode < 3 or not 1000 <= row < 1010:
                modes[name].append(("KVH", utime, line.encode()))
    for name in ("rate", "delta"):
        write_log(f"{name}.lcm", modes[name])
        code, said, header, rows = capture(build, f"{name}.lcm")
        check(code == 0 and header == ["time_s", "rate_radps"] and len(rows) == ROWS and all(near([row[1]], [rates(n)[0]], 1e-4) for n, row in enumerate(rows)),
              f"kvh_dsp3000_t, {name}: {len(rows)} rates")
    write_log("angle.lcm", modes["angle"])
    code, said, header, rows = capture(build, "angle.lcm")
    after = [row[1] for row in rows[1:1000] + rows[1001:]]
    check(code == 0 and len(rows) == ROWS - 10 and all(near([rate], [rates(n)[0]], 1e-4) for n, rate in zip([*range(1, 1000), *range(1011, ROWS)], after)),
          f"kvh_dsp3000_t, integrated angle: {len(rows)} rates")
    check(code == 0 and near([rows[1000][1]], [rates(1005)[0]], 1e-3), "and over ten lost messages their mean rate")


def raw_bytes(build, modules):
    """Bytes of a device, published by another program in pieces that end anywhere, through one of our drivers."""
    with open("sent.kvh", "rb") as file:
        sent = file.read()
    dice, pieces, at = random.Random(3), [], 0
    while at < len(sent):
        piece = modules["senlcm"].raw_t()
        piece.data = sent[at:at + dice.randrange(1, 90)]
        piece.length, piece.utime = len(piece.data), EPOCH_us + at // 40 * 1_000_000 // RATE_HZ
        pieces.append(("KVH_RAW", piece.utime, piece.encode()))
        at += piece.length
    lines = []
    for row in range(ROWS):
        line = modules["senlcm"].raw_ascii_t()
        line.utime, line.msg = EPOCH_us + row * 10_000, f" {math.degrees(rates(row)[0]):.6f}  1" + ("\r\n" if row < ROWS // 2 else "")
        lines.append(("DSP", line.utime, line.encode()))
    write_log("raw.lcm", pieces)
    write_log("lines.lcm", lines)
    write_log("both.lcm", pieces + lines)
    driver = ["--driver", "kvh1750", "--option", "format=b", "--option", f"rate_hz={RATE_HZ}"]
    judge_capture("senlcm.raw_t through kvh1750", capture(build, "raw.lcm", *driver), COLUMNS + ["temperature_degC"], 1e-6)
    judge_capture("one channel of two", capture(build, "both.lcm", "--channel", "KVH_RAW", *driver), COLUMNS + ["temperature_degC"], 1e-6)
    code, said, header, rows = capture(build, "lines.lcm", "--driver", "dsp3000", "--option", "output=rate", "--option", "rate_hz=100")
    # The first line may be truncated, so the driver waits for the next.
    check(code == 0 and header == ["time_s", "rate_radps"] and len(rows) == ROWS - 1 and all(near([row[1]], [rates(n + 1)[0]], 1e-5) for n, row in enumerate(rows)),
          f"senlcm.raw_ascii_t through dsp3000, with and without ends of lines: {len(rows)} rates {said.strip()}")
    check(len(rows) == ROWS - 1 and abs(rows[-1][0] - (ROWS - 2) / 100) < 0.02, "their times are those of their arrival")
    with open("sent.bin", "wb") as file:
        file.write(sent)
    for source in ("raw.lcm", "sent.bin"):
        code, said = ran(build, "denoise", source, "--output", source + ".denoised.csv", *driver)
        check(code == 0, f"denoise takes {source}: " + said.strip().split("\n")[-1])
    with open("raw.lcm.denoised.csv") as log, open("sent.bin.denoised.csv") as plain:
        check(log.read() == plain.read(), "denoise makes of the log what it makes of the bytes")
    with open("raw.lcm", "rb") as log, open("damaged.lcm", "wb") as damaged:
        whole = log.read()
        damaged.write(whole[:len(whole) // 2] + bytes(1000) + whole[len(whole) // 2 + 1000:])
    code, said, _, rows = capture(build, "damaged.lcm", *driver)
    check(code == 0 and ROWS - 40 < len(rows) < ROWS and "are no messages and are dropped" in said, f"of a damaged log {len(rows)} are read, and it is said: " + said.strip().split("\n")[-1])
    for words, log, expected in ((driver, "both.lcm", "expected --channel with one of DSP, KVH_RAW"), ([], "raw.lcm", "has bytes of a device on KVH_RAW, expected --driver NAME"),
                                 (driver, "imu.lcm", "no channel carries bytes of a device"),
                                 ([*driver, "--channel", "IMU"], "imu.lcm", "message 1 on IMU is no senlcm.raw_t")):
        code, said = ran(build, "convert", log, "no.csv", *words)
        check(code == 1 and expected in said, said.strip())


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    build = os.path.abspath(sys.argv[1])
    private_network.enter()
    source = os.path.abspath(os.path.join(HERE, "../../../msgs/peers"))
    work = tempfile.mkdtemp()
    os.chdir(work)
    try:
        mine = {}
        for name in os.listdir(source):
            with open(os.path.join(source, name)) as file:
                text = file.read()
            mine[text.split("package ")[1].split(";")[0] + "." + text.split("\nstruct ")[1].split(" ")[0]] = text
        _, my_hashes = types_of(mine, "mine")
        modules, public = types_of({name: f"package {name.split('.')[0]};\nstruct {name.split('.')[1]} {{ {members} }}\n" for name, members in PUBLIC.items()}, "public")
        hashes((public, my_hashes))
        published(build)
        logged(build)
        foreign(build, modules)
        dsp3000(build, modules["senlcm"])
        raw_bytes(build, modules)
    finally:
        os.chdir("/")
        shutil.rmtree(work, ignore_errors=True)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
