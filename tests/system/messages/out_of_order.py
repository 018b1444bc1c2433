#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""LCM does not guarantee order: messages of a real daemon are logged and repeated with exchanged neighbours, and together with a
second publisher. Readers of the log and of the network lose nothing of the first and report the second. Oracle: the original log.

usage: out_of_order.py BUILD
"""
import json
import os
import random
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import private_network  # noqa: E402
from lcm_log import read_log, write_log  # noqa: E402

GROUP, PORT = "239.255.76.67", 7667
DBC = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../drivers/dbc/examples/ifogd_gyro.dbc"))
URL = f"udpm://{GROUP}:{PORT}?ttl=0&recv_buf_size=4000000"
ROWS, SWAPS = 6000, 300
CONFIG = f"""[daemon]
lock_memory = false
lcm_url = "{URL}"
[[sensor]]
name = "nose"
driver = "dbc"
[sensor.options]
dbc = "{DBC}"
signal = "Rate_x"
counter = "Counter"
rate_hz = 200
[sensor.transport]
type = "file"
path = "gyro.log"
format = "candump"
pace = "recorded"
speed = 40
"""


def in_order(events):
    """With stamps in the order of arrival."""
    return [(channel, utime, data) for (channel, _, data), utime in zip(events, sorted(event[1] for event in events))]


class Books:
    def __init__(self, build):
        self.ifog, self.ifogd, self.record = (os.path.join(build, path) for path in ("tools/ifog/ifog", "daemon/ifogd", "tests/system/lcm_record"))
        self.failed = 0

    def check(self, good, what):
        print("ok      " if good else "FAILED  ", what, flush=True)
        self.failed += not good

    def ran(self, *words):
        done = subprocess.run([self.ifog, *words], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120, check=False)
        return done.returncode, done.stdout + done.stderr

    def logged(self, name, seed):
        """Messages of the daemon for a capture, as logged by lcm-logger."""
        dice = random.Random(seed)
        with open("gyro.csv", "w") as file:
            file.write("time_s,rate_radps\n" + "".join(f"{i / 200},{dice.gauss(0, 1e-4)!r}\n" for i in range(ROWS)))
        code, said = self.ran("convert", "gyro.csv", "gyro.log", "--dbc", DBC, "--option", "signal=Rate_x", "--option", "counter=Counter", "--option", "rate_hz=200")
        assert code == 0, said
        with open("ifogd.toml", "w") as file:
            file.write(CONFIG)
        recorder = subprocess.Popen([self.record, URL, "IFOG_NOSE", name], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        time.sleep(0.5)
        subprocess.run([self.ifogd, "--config", "ifogd.toml"], stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=120, check=True)
        recorder.terminate()
        assert recorder.wait(20) == 0
        events = read_log(name)
        assert len(events) == ROWS, len(events)
        return events

    def converted(self, name):
        """The rows of the log, and the messages."""
        code, said = self.ran("convert", name, name + ".csv")
        with open(name + ".csv") as file:
            return code, said, [line for line in file if not line.startswith("#")]

    def recorded(self, events):
        """Messages stored by `ifog record` at the speed of a gyro of 2 kHz."""
        shutil.rmtree("kept", ignore_errors=True)
        recorder = subprocess.Popen([self.ifog, "record", "--output", "kept", "--lcm-url", URL], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                    stderr=subprocess.STDOUT, text=True)
        time.sleep(1)
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        for number, (channel, _, data) in enumerate(events):
            out.sendto(struct.pack(">II", 0x4C433032, number) + channel.encode() + b"\0" + data, (GROUP, PORT))
            time.sleep(0.0005)
        time.sleep(1)
        recorder.send_signal(signal.SIGINT)
        return recorder.communicate(timeout=30)[0]


def swapped(events):
    out, dice = list(events), random.Random(5)
    for at in dice.sample(range(100, ROWS // 2 - 100), SWAPS):
        out[2 * at], out[2 * at + 1] = out[2 * at + 1], out[2 * at]
    return out


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    books = Books(os.path.abspath(sys.argv[1]))
    private_network.enter()
    work = tempfile.mkdtemp()
    os.chdir(work)
    try:
        events = books.logged("nose.lcm", 1)
        write_log("swapped.lcm", in_order(swapped(events)))
        (code, said, rows), (other_code, other_said, other_rows) = books.converted("nose.lcm"), books.converted("swapped.lcm")
        books.check(code == other_code == 0 and rows == other_rows and len(rows) == ROWS + 1, f"convert: {len(other_rows) - 1} of {ROWS} samples, the same as in order")
        books.check("lost" not in other_said and "missing" not in other_said, "convert: nothing is said to be lost: " + other_said.strip().replace("\n", " | "))
        said = books.recorded(swapped(events))
        books.check(f"{ROWS} messages" in said and "0 lost here, 0 lost on LCM" in said, "record: all are kept, none is said to be lost: " + said.strip().replace("\n", " | "))
        (folder,) = [each for each, _, files in os.walk("kept") if files]
        _, said, kept = books.converted(folder)
        books.check([row.split(",")[1] for row in kept[1:]] == [row.split(",")[1] for row in rows[1:]], f"record: {len(kept) - 1} rates, the same as in order")
        again = books.logged("again.lcm", 2)
        both = [event for pair in zip(events, again[1000:] + again[:1000]) for event in pair]
        write_log("both.lcm", in_order(both))
        _, said, _ = books.converted("both.lcm")
        books.check("two publishers sent on IFOG_NOSE" in said, "convert: two publishers are named: " + said.strip().replace("\n", " | ")[:300])
        said = books.recorded(both)
        books.check("two publishers sent on IFOG_NOSE" in said, "record: two publishers are named: " + said.strip().replace("\n", " | ")[:300])
    finally:
        os.chdir("/")
        shutil.rmtree(work, ignore_errors=True)
    sys.exit(books.failed > 0)


if __name__ == "__main__":
    main()
