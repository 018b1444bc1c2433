#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Many sensors in one daemon: every sample is published, memory is locked; measures the locked memory per sensor.

usage: run.py BUILD [--sensors N] [--hertz R] [--seconds S] [--json F] default: 24 sensors at 1000 Hz and 64 at 100 Hz

In its own network namespace. FIFOs deliver frames of KVH 1750s at their times. The daemon uses SCHED_FIFO if allowed and locks
its memory; the memory per sensor is the slope between two sensors and all. Prints one line per check, `ok` or `FAILED`. Exit 0
success, 1 failure, 77 if memory cannot be locked.
"""
import argparse
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "box"), os.path.join(HERE, "..")]
import frames  # noqa: E402
import private_network  # noqa: E402

ROUND = 128  # rollover of the KVH 1750's counter, frames
MOST_LOCKED_KIB = 2048  # per sensor
FEW = 2


def may_run_in_real_time():
    try:
        before = os.sched_getscheduler(0)
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        os.sched_setscheduler(0, before, os.sched_param(0))
        return True
    except PermissionError:
        return False


def memory_kib(pid):
    with open(f"/proc/{pid}/status") as file:
        said = file.read()
    return {key: int(re.search(rf"{key}:\s+(\d+)", said).group(1)) for key in ("VmLck", "VmRSS")}


class Many:
    def __init__(self, build, sensors, hertz):
        self.build, self.sensors, self.hertz = os.path.abspath(build), sensors, hertz
        self.work = tempfile.mkdtemp(prefix="ifog-many-")
        self.fifos = [os.path.join(self.work, f"gyro{i}") for i in range(sensors)]

    def __enter__(self):
        real_time = may_run_in_real_time()
        text = f'[daemon]\nplugin_folder = "{self.build}/plugins"\nlock_memory = true\n'
        for i, fifo in enumerate(self.fifos):
            os.mkfifo(fifo)
            text += (f'[[sensor]]\nname = "gyro{i}"\ndriver = "kvh1750"\nnominal_rate_hz = {self.hertz}\n[sensor.transport]\n'
                     f'type = "file"\npath = "{fifo}"\n[sensor.filter]\nprocess_noise = 1e-10\nmeasurement_noise = 1e-8\n')
            if real_time:
                text += "[sensor.realtime]\nreader_priority = 50\nfilter_priority = 49\n"
        with open(os.path.join(self.work, "ifogd.toml"), "w") as file:
            file.write(text)
        self.said = open(os.path.join(self.work, "said"), "w+")
        self.daemon = subprocess.Popen([os.path.join(self.build, "daemon/ifogd"), "--config", os.path.join(self.work, "ifogd.toml")],
                                       stderr=self.said)
        self.lines = [os.open(fifo, os.O_WRONLY) for fifo in self.fifos]
        return self

    def __exit__(self, *_):
        for line in self.lines:
            os.close(line)
        if self.daemon.poll() is None:
            self.daemon.kill()
            self.daemon.wait()
        self.said.close()
        shutil.rmtree(self.work, ignore_errors=True)

    def log(self):
        self.said.seek(0)
        return self.said.read()

    def feed(self, seconds):
        """Frame n of every sensor at n / rate after the first."""
        block = [frames.kvh1750(n, self.hertz) for n in range(ROUND)]
        begin = time.monotonic() + 0.2
        for n in range(round(seconds * self.hertz)):
            wait = begin + n / self.hertz - time.monotonic()
            if wait > 0:
                time.sleep(wait)
            frame = block[n % ROUND]
            for line in self.lines:
                os.write(line, frame)
        return round(seconds * self.hertz)

    def stop(self):
        time.sleep(0.5)
        self.daemon.send_signal(signal.SIGTERM)
        return self.daemon.wait(timeout=30)


def locked(build, sensors, hertz):
    """KiB of a daemon that has published for a second; None if memory cannot be locked."""
    with Many(build, sensors, hertz) as many:
        many.feed(1.0)
        found = memory_kib(many.daemon.pid)
        many.stop()
        return None if "memory not locked" in many.log() else found


def judge(build, sensors, hertz, seconds, figures):
    few = locked(build, FEW, hertz)
    if few is None:
        return None
    with Many(build, sensors, hertz) as many:
        sent = many.feed(seconds)
        found = memory_kib(many.daemon.pid)
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        status = many.stop()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        log = many.log()
    cpu_us = 1e6 * (after.ru_utime + after.ru_stime - used.ru_utime - used.ru_stime) / (sent * sensors)
    want = f"{sent} samples read, {sent} published, 0 missing, 0 merged"
    whole = sum(f"gyro{i}: {want}" in log for i in range(sensors))
    each = (found["VmLck"] - few["VmLck"]) / (sensors - FEW)
    resident = (found["VmRSS"] - few["VmRSS"]) / (sensors - FEW)
    figures.append({"sensors": sensors, "hertz": hertz, "seconds": seconds, "whole": whole, "locked_KiB_a_sensor": round(each),
                    "resident_KiB_a_sensor": round(resident), "processor_us_a_sample": round(cpu_us, 2)})
    what = f"{sensors} sensors at {hertz} Hz"
    return [(f"{what}, every sample", status == 0 and whole == sensors,
             f"{whole} of {sensors}: {want}; {cpu_us:.1f} us of a processor each" if whole == sensors else log[-900:]),
            (f"{what}, memory", max(each, resident) <= MOST_LOCKED_KIB, f"{each:.0f} KiB locked and {resident:.0f} KiB resident a sensor")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("--sensors", type=int)
    parser.add_argument("--hertz", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--json")
    given = parser.parse_args()
    if given.sensors is not None and given.sensors <= FEW:
        parser.error(f"--sensors is {given.sensors}, expected more than {FEW}: what one takes is the slope between so many and all")
    private_network.enter()
    plans = [(given.sensors, given.hertz)] if given.sensors else [(24, 1000), (64, 100)]
    failed, figures = 0, []
    for sensors, hertz in plans:
        judged = judge(given.build, sensors, hertz, given.seconds, figures)
        if judged is None:
            print("SKIPPED: memory cannot be locked; runs as root or with `ulimit -l unlimited`")
            return 77
        for what, good, seen in judged:
            failed += not good
            print(f"{'ok      ' if good else 'FAILED  '} {what}: {seen}", flush=True)
    if given.json:
        with open(given.json, "w") as out:
            json.dump(figures, out, indent=1)
            out.write("\n")
    return 1 if failed else 0


sys.exit(main())
