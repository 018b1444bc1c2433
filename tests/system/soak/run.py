#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The daemon for many hours of a gyro's time at full speed: a day at 1 kHz takes some minutes.

usage: run.py BUILD [--hours H] [--hertz R] default: 24 hours at 1000 Hz

In its own network namespace. A FIFO delivers frames of a KVH 1750 from a repeated block; SIGHUP reloads the filter every two
seconds. Prints one line per check, `ok`, `FAILED` or `skipped`: every sample is published, the angle is correct, memory and
descriptors do not increase from the first to the last tenth.
"""
import argparse
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "box"), os.path.join(HERE, "..")]
import frames  # noqa: E402
import private_network  # noqa: E402

BLOCK = 12800  # samples: a hundred rollovers of the frame's counter, so that blocks follow each other
LAST = 36 * 100  # bytes
# Normal variation: a log line's buffer, a page of the allocator.
LEEWAY_KB = 1024


def held(pid):
    """Resident memory in kB and open descriptors."""
    with open(f"/proc/{pid}/status") as file:
        memory = int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1))
    return memory, len(os.listdir(f"/proc/{pid}/fd"))


class Soak:
    def __init__(self, build, hours, hertz):
        self.build, self.hertz = os.path.abspath(build), hertz
        self.blocks = max(20, round(hours * 3600 * hertz / BLOCK))
        self.work = tempfile.mkdtemp()
        self.fed, self.looks = 0, []

    def start(self):
        fifo = os.path.join(self.work, "gyro")
        os.mkfifo(fifo)
        with open(os.path.join(self.work, "ifogd.toml"), "w") as file:
            file.write(f'[daemon]\nplugin_folder = "{self.build}/plugins"\nlock_memory = false\n[[sensor]]\nname = "soak"\ndriver = "kvh1750"\n'
                       f'nominal_rate_hz = {self.hertz}\n[sensor.transport]\ntype = "file"\npath = "gyro"\nawait_writer = false\n'
                       "[sensor.filter]\nprocess_noise = 1e-10\nmeasurement_noise = 1e-8\n")
        self.counter = subprocess.Popen([os.path.join(self.build, "tests/system/lcm_count"), "86400", "IFOG_SOAK"], stdout=subprocess.PIPE, text=True)
        time.sleep(0.5)
        self.said = open(os.path.join(self.work, "said"), "w+")
        self.daemon = subprocess.Popen([os.path.join(self.build, "daemon/ifogd"), "--config", os.path.join(self.work, "ifogd.toml")], stderr=self.said)
        self.feeder = threading.Thread(target=self.feed, args=(fifo,), daemon=True)
        self.feeder.start()

    def feed(self, fifo):
        block = b"".join(frames.kvh1750(n, self.hertz) for n in range(BLOCK))
        with open(fifo, "wb", buffering=0) as line:
            for _ in range(self.blocks):
                # The subscriber is slower: the last samples are sent when it has processed the others, before the daemon treats
                # the silence as a loss (2 s).
                # before the daemon takes the silence for a loss (2 s).
                last = self.fed == self.blocks - 1
                parts = (block[:-LAST], block[-LAST:]) if last else (block,)
                for part in parts:
                    if part is parts[-1] and last:
                        time.sleep(1.5)
                    rest = memoryview(part)
                    while rest:
                        rest = rest[line.write(rest):]
                self.fed += 1

    def watch(self):
        looked, reloaded = 0.0, time.monotonic() + 1.0
        while self.daemon.poll() is None:
            time.sleep(0.1)
            if time.monotonic() - looked > 1.0:
                looked = time.monotonic()
                try:
                    self.looks.append((self.fed, *held(self.daemon.pid)))
                except (FileNotFoundError, AttributeError):
                    break
            if time.monotonic() - reloaded > 2.0 and self.fed < self.blocks:
                reloaded = time.monotonic()
                self.daemon.send_signal(signal.SIGHUP)
        self.daemon.wait()
        time.sleep(2)
        self.counter.send_signal(signal.SIGTERM)
        self.count = json.loads(self.counter.communicate()[0]).get("IFOG_SOAK", {"angle": math.nan})
        self.said.seek(0)
        self.log = self.said.read()

    def judge(self):
        samples = self.blocks * BLOCK
        want = f"{samples} samples read, {samples} published, 0 missing, 0 merged"
        yield "every sample", self.daemon.returncode == 0 and want in self.log, f"{want}; {self.log.count('reloaded')} reloads" if want in self.log else self.log[-600:]
        expected = self.blocks * frames.angle(0, BLOCK, self.hertz)
        # Besides the rounding of this sum itself.
        good = abs(self.count["angle"] - expected) < 1e-9
        yield "angle", good, f"{self.count['angle']!r} rad, sent {expected!r}"
        warm = [look for look in self.looks if look[0] > self.blocks / 10] or self.looks
        late = [look for look in warm if look[0] > 0.9 * self.blocks] or warm[-1:]
        for what, index, leeway in (("memory", 1, LEEWAY_KB), ("descriptors", 2, 0)):
            first, last = warm[0][index], max(look[index] for look in late)
            yield what, last <= first + leeway, f"{first} after the first tenth, {last} at most in the last, of {len(self.looks)} looks"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("--hours", type=float, default=24)
    parser.add_argument("--hertz", type=int, default=1000)
    given = parser.parse_args()
    private_network.enter()
    soak = Soak(given.build, given.hours, given.hertz)
    began, failed = time.monotonic(), 0
    try:
        soak.start()
        soak.watch()
        for what, good, seen in soak.judge():
            failed += not good
            print(f"{'ok      ' if good else 'FAILED  '} soak, {what}: {seen}", flush=True)
        print(f"{soak.blocks * BLOCK / given.hertz / 3600:.2f} hours in {time.monotonic() - began:.0f} s")
    finally:
        for process in (soak.daemon, soak.counter):
            if process.poll() is None:
                process.kill()
        shutil.rmtree(soak.work, ignore_errors=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
