#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Kills the daemon at random times while it records, and compares the recording with the sent bytes.

usage: tests/bench/kills/run.py [--kills 1000] [--jobs 4] [--seed 1] [BUILD_FOLDER]

Each job is one daemon, restarted after each kill with the same folder, that reads a FIFO at some 500 frames per second. After
each kill `ifog replay --to file:` reads the recording since the start, which must be:

  - a prefix of the data sent to this run, bit for bit;
  - complete up to 1.2 s before the kill, if the daemon was already reading (it writes within three quarters of a second);
  - free of reported damage and losses.

Prints one line per job and the total; exit 1 at the first wrong recording.
"""

import argparse
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

FRAME = 36
RATE_HZ = 500
FLUSHED_S = 1.2
CONFIG = """[daemon]
plugin_folder = "{build}/plugins"
lock_memory = false
lcm_url = "memq://"

[[sensor]]
name = "nose"
driver = "kvh1750"
[sensor.transport]
type = "file"
path = "line"
[sensor.options]
format = "a"
[sensor.record]
folder = "record"
bytes = 4_000_000
file_bytes = 100_000
"""


def frames(ifog, folder, count):
    """Bytes of `count` samples in the device's format."""
    csv = os.path.join(folder, "sent.csv")
    with open(csv, "w") as out:
        out.write("time_s,rate_x_radps,rate_y_radps,rate_z_radps\n")
        for n in range(count):
            out.write(f"{n * 1e-3:.3f},{n * 7919 % 1000 * 1e-4:.4f},{n * 31 % 77 * 1e-3:.3f},{n % 10 * 1e-2:.2f}\n")
    raw = os.path.join(folder, "sent.bin")
    subprocess.run([ifog, "convert", csv, raw, "--driver", "kvh1750", "--option", "format=a"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(raw, "rb") as data:
        return data.read()


class Job:
    def __init__(self, number, build, data, seed, kills):
        self.number, self.data, self.kills = number, data, kills
        self.random = random.Random(f"{seed}/{number}")
        self.daemon = os.path.join(build, "daemon", "ifogd")
        self.ifog = os.path.join(build, "tools", "ifog", "ifog")
        self.folder = tempfile.mkdtemp(prefix="ifog-kills-")
        self.flaw, self.done, self.bytes, self.tail, self.opened, self.held = None, 0, 0, 0, 0, 0
        with open(os.path.join(self.folder, "ifogd.toml"), "w") as out:
            out.write(CONFIG.format(build=build))
        os.mkfifo(os.path.join(self.folder, "line"))
        self.environment = dict(os.environ, IFOG_PLUGIN_PATH=os.path.join(build, "plugins"))

    def recordings(self):
        folder = os.path.join(self.folder, "record", "nose")
        return sorted(os.listdir(folder)) if os.path.isdir(folder) else []

    def run(self):
        try:
            while self.done < self.kills and self.flaw is None:
                self.once()
                self.done += 1
        except Exception as error:
            self.flaw = f"{type(error).__name__}: {error}"
        if self.flaw is None:
            shutil.rmtree(self.folder)

    def once(self):
        before = [name for name in self.recordings()]
        log = open(os.path.join(self.folder, "said"), "wb")
        process = subprocess.Popen([self.daemon, "--config", os.path.join(self.folder, "ifogd.toml")], stderr=log,
                                   env=self.environment)
        line = os.open(os.path.join(self.folder, "line"), os.O_RDWR | os.O_NONBLOCK)
        sent, history, reading = 0, [], None
        end = time.monotonic() + self.random.uniform(0.05, 4.0)
        while time.monotonic() < end:
            # In pieces that are not frames.
            piece = self.data[sent:sent + self.random.randint(1, 2 * FRAME)]
            try:
                n = os.write(line, piece)
            except BlockingIOError:
                n = 0
            sent += n
            history.append((time.monotonic(), sent))
            if reading is None and self.says("reading"):
                reading = time.monotonic()
            time.sleep(len(piece) / FRAME / RATE_HZ)
        process.send_signal(signal.SIGKILL)
        killed = time.monotonic()
        process.wait()
        os.close(line)
        log.close()
        # The FIFO loses the unread data when its last reader and writer close it.
        # Data sent while the daemon was starting, which takes seconds on a busy machine, arrives when it begins to read.
        begun = reading is not None and reading < killed - FLUSHED_S
        self.judge(before, sent, max([n for at, n in history if begun and at < killed - FLUSHED_S], default=0))

    def says(self, word):
        with open(os.path.join(self.folder, "said"), encoding="utf-8") as said:
            return word in said.read()

    def judge(self, before, sent, due):
        fresh = os.path.join(self.folder, "fresh")
        shutil.rmtree(fresh, ignore_errors=True)
        os.mkdir(fresh)
        old = {name.removesuffix(".open") for name in before}
        for name in self.recordings():
            if name.removesuffix(".open") not in old:
                shutil.copy(os.path.join(self.folder, "record", "nose", name), fresh)
                self.opened += name.endswith(".open")
        if not os.listdir(fresh):
            if due > 0:
                self.flaw = f"no recording of {due} bytes"
            return
        again = os.path.join(self.folder, "again")
        if os.path.exists(again):
            os.unlink(again)
        told = subprocess.run([self.ifog, "replay", fresh, "--speed", "0", "--to", "file:" + again],
                              env=self.environment, capture_output=True, text=True)
        if told.returncode != 0 or not os.path.exists(again):
            if due > 0 or not re.search("nothing in it to send|is no flight recording", told.stderr):
                self.flaw = f"replay: {told.stderr.strip()} ({due} bytes were due)"
            return
        if re.search("damaged|missing|lost|deliveries", told.stderr):
            self.flaw = "replay tells of loss: " + told.stderr.strip()
        with open(again, "rb") as data:
            recorded = data.read()
        if recorded != self.data[:len(recorded)] or len(recorded) > sent:
            self.flaw = f"{len(recorded)} bytes recorded are not those sent"
        if len(recorded) < due:
            self.flaw = f"{len(recorded)} bytes recorded, {due} were due"
        self.bytes += len(recorded)
        self.held += due > 0
        self.tail = max(self.tail, sent - len(recorded))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", nargs="?", default="build/release")
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    build = os.path.abspath(options.build)
    os.environ.setdefault("IFOG_PLUGIN_PATH", os.path.join(build, "plugins"))
    with tempfile.TemporaryDirectory(prefix="ifog-kills-") as folder:
        data = frames(os.path.join(build, "tools", "ifog", "ifog"), folder, 20_000)
    share = [options.kills // options.jobs + (n < options.kills % options.jobs) for n in range(options.jobs)]
    jobs = [Job(n, build, data, options.seed, share[n]) for n in range(options.jobs)]
    threads = [threading.Thread(target=job.run) for job in jobs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for job in jobs:
        print(f"job {job.number}: {job.done} kills, {job.opened} found a file open, {job.held} had something due, {job.bytes} bytes recorded as sent, at most "
              f"{job.tail} not on the disk yet" + (f"; FLAW: {job.flaw} ({job.folder})" if job.flaw else ""))
    print(f"{sum(job.done for job in jobs)} kills, {sum(job.flaw is not None for job in jobs)} flaws")
    sys.exit(any(job.flaw for job in jobs))


main()
