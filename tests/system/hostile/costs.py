#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Files far larger or deeper than intended: each is rejected in seconds with a clear line. A program can be ended at once while it
reads.

usage: costs.py BUILD

One line per check, `ok` or `FAILED`.
"""
import json
import signal
import socket
import subprocess
import time

from place import CONFIG, main_of

MANY = 50_000
SECONDS = 15  # an idle processor needs 1 to 3 for the largest file
SENSOR = '[[sensor]]\nname = "s{0}"\ndriver = "kvh1750"\n[sensor.transport]\ntype = "file"\npath = "a{0}"\n'


def write(name, text):
    with open(name, "w") as file:
        file.write(text)


def chain():
    """A DBC file of nested multiplexors."""
    lines = ['VERSION ""', "BU_: A", "BO_ 291 M: 64 A", ' SG_ S0 M : 0|8@1+ (1,0) [0|0] "" A']
    lines += [f' SG_ S{i} m1M : 0|8@1+ (1,0) [0|0] "" A' for i in range(1, MANY)]
    lines += [' SG_ Rate m1 : 8|16@1- (0.001,0) [0|0] "deg/s" A']
    lines += [f"SG_MUL_VAL_ 291 S{i} S{i - 1} 1-1;" for i in range(1, MANY)]
    return "\n".join([*lines, f"SG_MUL_VAL_ 291 Rate S{MANY - 1} 1-1;", ""])


def wide(names):
    return ",".join(names) + "\n" + "".join(f"{row * 0.1}" + ",0.1" * (len(names) - 1) + "\n" for row in range(3))


def ends(place, what, words, code, said, seconds=SECONDS):
    began = time.monotonic()
    try:
        done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        place.check(False, f"{what}: did not end in {seconds} s")
        return
    lines = (done.stdout + done.stderr).strip().splitlines()
    place.check(done.returncode == code and said in lines[-1], f"{what}: {time.monotonic() - began:.1f} s, {lines[-1][:160]}")


def large_files(place):
    write("many.toml", "".join(SENSOR.format(i) for i in range(MANY)))
    ends(place, f"{MANY} sensors", [place.ifogd, "--check", "--config", "many.toml"], 2, "expected at most 256")
    write("keys.toml", "[daemon]\n" + "".join(f"key{i} = 1\n" for i in range(1_000_000)))
    ends(place, "a configuration of a million keys", [place.ifogd, "--check", "--config", "keys.toml"], 2, "")
    write("chain.dbc", chain())
    write("can.log", "(1.0) can0 123#0100000000000000\n" * 3)
    ends(place, f"a chain of {MANY} multiplexors", [place.ifog, "convert", "can.log", "x.csv", "--dbc", "chain.dbc", "--option", "signal=Rate"], 1,
         "more than 64 multiplexors")
    write("lot.toml", 'type = "t"\n' + "".join(f'[[gyro]]\nserial = "g{i}"\ncaptures = ["none{i}.csv"]\n' for i in range(MANY)))
    ends(place, f"{MANY} gyros without captures", [place.ifog, "fleet", "lot.toml", "--engine", "local"], 1, "cannot open: No such file or directory")
    write("one.toml", 'type = "t"\n[[gyro]]\nserial = "g"\ncaptures = [' + ",\n".join(f'"none{i}.csv"' for i in range(MANY)) + "]\n")
    ends(place, f"a gyro without {MANY} captures", [place.ifog, "fleet", "one.toml", "--engine", "local"], 1, "cannot open: No such file or directory")
    write("lot2.toml", 'type = "t"\n' + "".join(f'[[gyro]]\nserial = "g{i}"\ncaptures = ["none{i}.csv"]\n' for i in range(70_000)))
    ends(place, "more captures than a lot may have", [place.ifog, "fleet", "lot2.toml", "--engine", "local"], 1, "gyro.captures: more than 65536 in all")
    for what, names in (("named", ["time_s", "rate_radps"] + [f"c{i}_V" for i in range(100_000)]), ("foreign", ["Timestamp", "GyroX"] + [f"Sensor {i} id" for i in range(100_000)]),
                        ("a rate each", ["time_s"] + [f"rate_{i}_radps" for i in range(100_000)])):
        write("wide.csv", wide(names))
        ends(place, f"3 rows of 100000 columns, {what}", [place.ifog, "diagnose", "wide.csv"], 1, " more than ")
        write("wide.csv", wide(names[:4096]))
        ends(place, f"3 rows of 4096 columns, {what}", [place.ifog, "diagnose", "wide.csv"], 1, "")
    write("records.txt", "".join(f"w{record},{row},0.1\n" for record in range(20_000) for row in range(4)))
    ends(place, "records of 20000 names", [place.ifog, "allan", "records.txt"], 1, "no header line", seconds=4)


def ended(place, what, words, asked):
    """While it reads a configuration that takes a second or two."""
    process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(0.15)
    reading = process.poll() is None
    began = time.monotonic()
    process.send_signal(asked)
    try:
        code = process.wait(20)
    except subprocess.TimeoutExpired:
        process.kill()
        code = process.wait()
    took = time.monotonic() - began
    place.check(reading and code == -asked and took < 0.5, f"{asked.name} while {what}: ended in {took:.2f} s, {code}")


def signals(place):
    write("long.toml", CONFIG + "".join(f"[[other]]\nkey{i} = [1, 2, 3, 'text']\n" for i in range(300_000)))
    for asked in (signal.SIGTERM, signal.SIGINT):
        ended(place, "ifogd reads its configuration", [place.ifogd, "--config", "long.toml"], asked)
        ended(place, "ifogd checks one", [place.ifogd, "--check", "--config", "long.toml"], asked)
        for command in ("adopt", "revert"):
            ended(place, f"ifog {command} reads it", [place.ifog, command, "nose", "--config", "long.toml"], asked)


def other_ports(place):
    """Datagrams of another program on the sensor's host are not accepted."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    gyro, other = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
    for each in (gyro, other):
        each.bind(("127.0.0.1", 0))
    for key, first, seconds in (("", gyro, 2.5), (f"host_port = {gyro.getsockname()[1]}\n", other, 2.5)):
        write("udp.toml", CONFIG.replace('type = "file"\npath = "gyro"\n', f'type = "udp"\nport = {port}\nhost = "127.0.0.1"\n{key}')
              .replace('"ifogd.toml"', '"udp.toml"'))
        daemon = place.start("udp.toml", "udp.log")
        # The first part of a line counts from the previous line end.
        first.sendto(b"\r\n", ("127.0.0.1", port))
        gyro.sendto(b"\r\n", ("127.0.0.1", port))
        time.sleep(0.1)
        sent = 0
        for _ in range(int(seconds * 100)):
            gyro.sendto(b"   0.001000 1\r\n", ("127.0.0.1", port))
            other.sendto(b"  45.000000 1\r\n", ("127.0.0.1", port))
            sent += 1
            time.sleep(0.01)
        time.sleep(1.5)
        place.ran("status", "--config", "udp.toml", "--json", "udp.json", code=0)
        with open("udp.json") as file:
            sensor = json.load(file)["sensors"][0]
        daemon.terminate()
        daemon.wait(30)
        place.check(sensor["books"]["samples_in"] == sent and sensor["losses"]["log_faults"] > 200,
                    f"{'the port that sent first' if not key else 'host_port'}: {sensor['books']['samples_in']} of {sent} of the sensor's, {sensor['losses']['log_faults']} others dropped")


if __name__ == "__main__":
    main_of(__doc__, large_files, signals, other_ports)
