# SPDX-License-Identifier: Apache-2.0
"""Improvement of a model during operation, in the box: a gyro with an undeclared temperature effect is recorded for two accelerated
days. ifogd-diagnose.timer fires at 02:30, the first night proposes a model, it is adopted during the second day, and the gain of
that day agrees with the promise. Checks of the box (run.py).

The days are generated before the machine starts. Samples carry their times, so that the daemon sees a slow day at any speed.
"""
import csv
import io
import json
import math
import os
import subprocess
import sys
import threading
import time

import frames
from machine import Failure

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "field"))
import slow_gyro  # noqa: E402

HZ = 2
ROWS = 1 << 15  # of a day, 4.6 h
MEANS_S = 100
PER_HOUR = 180 / math.pi * 3600
# Speed factor: 2000 rows per second, which the emulated processor can process; half as many with a receiver of every message.
SPEED = {1: 1000, 2: 500}
# Accuracy of a ratio of two errors, from some 49 means in the promise and 163 in the measurement, of coloured noise.
RATIO_WITHIN = 0.45


def options(dbc):
    return {"dbc": dbc, "signal": "Rate_x", "counter": "Counter", "rate_hz": HZ, "environment": "temperature_degC=Temperature"}


def configuration():
    """On one processor, because Linux may exchange the order on the loopback of data sent from two."""
    words = "\n".join(f"{key} = {json.dumps(value)}" for key, value in options("/opt/test/slow_gyro.dbc").items())
    return f"""[daemon]
[[sensor]]
name = "nose"
driver = "dbc"
[sensor.transport]
type = "file"
path = "/run/ifog-test/gyro"
format = "candump"
[sensor.options]
{words}
[sensor.filter]
process_noise = 5e-18
measurement_noise = 1.25e-15
[sensor.realtime]
reader_priority = 50
filter_priority = 49
ring_slots = 16384
reader_cpus = [0]
filter_cpus = [0]
[sensor.record]
folder = "/var/lib/ifogd/record"
file_s = 3
"""


def make_days(build, folder):
    """Two successive days of one gyro as CAN frames with times."""
    ifog = os.path.join(build, "tools/ifog/ifog")
    here = os.path.dirname(os.path.abspath(__file__))
    dbc = os.path.abspath(os.path.join(here, "../../../drivers/dbc/examples/ifogd_gyro.dbc"))
    environment = dict(os.environ, IFOG_PLUGIN_PATH=os.path.join(build, "plugins"))
    with open(os.path.join(folder, "gyro.toml"), "w") as file:
        file.write(slow_gyro.scenario(HZ, 2 * ROWS / HZ))
    both = os.path.join(folder, "days")
    words = [word for key, value in options(dbc).items() for word in ("--option", f"{key}={value}")]
    for command in (["simulate", os.path.join(folder, "gyro.toml"), "--seed", "41", "--output", both + ".csv"],
                    ["convert", both + ".csv", both + ".log", "--driver", "dbc", *words]):
        subprocess.run([ifog, *command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
    with open(both + ".log") as file:
        lines = file.readlines()
    days = []
    for day in (0, 1):
        days.append(os.path.join(folder, f"day{day + 1}.log"))
        with open(days[-1], "w") as file:
            file.writelines(lines[day * len(lines) // 2:(day + 1) * len(lines) // 2])
    return [dbc, *days]


def rms_of_means(text):
    """RMS of means of the compensated rate about their mean in the output of `ifog denoise`, rad/s."""
    rows = csv.DictReader(line for line in io.StringIO(text) if not line.startswith("#"))
    values = [float(row["compensated_radps"]) for row in rows]
    width = MEANS_S * HZ
    means = [sum(values[i:i + width]) / width for i in range(0, len(values) - width + 1, width)]
    mean = sum(means) / len(means)
    return math.sqrt(sum((each - mean) ** 2 for each in means) / len(means))


class Loop:
    """Used by the box: machine, lines, journal_since(), says()."""

    def json_of(self, command):
        self.machine.run(f"rm -f /tmp/loop.json; ifog {command} --json /tmp/loop.json", 120)
        return json.loads(self.machine.run("cat /tmp/loop.json"))

    def published(self):
        return self.json_of("status")["sensors"][0].get("books", {}).get("samples_published", 0)

    def until(self, condition, what, seconds):
        deadline = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > deadline:
                raise Failure(f"{what}: not within {seconds} s; the log: "
                              + self.machine.run("journalctl -u ifogd -u ifogd-diagnose -n 15 -o cat --no-pager"))
            time.sleep(0.5)

    def feed(self, day):
        """Sends a day into the FIFO; /tmp/fed shows the end."""
        self.machine.run(f"rm -f /tmp/fed; (ifog replay /opt/test/day{day}.log --speed {SPEED[day]} --to fifo:/run/ifog-test/gyro; echo $? >/tmp/fed) "
                         "</dev/null >/tmp/feeder 2>&1 &")

    def day_is_over(self, day):
        self.until(lambda: self.machine.run("cat /tmp/fed 2>/dev/null || true").strip() != "", f"day {day} is sent", 150)
        self.machine.run("[ \"$(cat /tmp/fed)\" = 0 ] || { cat /tmp/feeder; exit 1; }")
        self.until(lambda: self.published() >= day * ROWS, f"day {day} is published", 60)
        self.machine.run("for i in $(seq 100); do ls /var/lib/ifogd/record/nose/*.open >/dev/null 2>&1 || exit 0; sleep 0.2; done; exit 1")

    def night(self):
        """Sets the clock to 02:30; the timer starts the night. Returns its result for the sensor."""
        before = self.machine.run("systemctl show -P ExecMainStartTimestampMonotonic ifogd-diagnose.service").strip()
        lines = self.journal_since("ifogd-diagnose")
        self.machine.run("date -s \"$(date -d 'tomorrow 02:29:57' '+%F %T')\"")
        self.until(lambda: self.machine.run("systemctl show -P ExecMainStartTimestampMonotonic ifogd-diagnose.service").strip() != before,
                   "ifogd-diagnose.timer fires", 30)
        self.until(lambda: self.machine.run("systemctl show -P ActiveState ifogd-diagnose.service").strip() in ("inactive", "failed"),
                   "the night ends", 120)
        trigger, result = self.machine.run("systemctl show -P LastTriggerUSec ifogd-diagnose.timer; "
                                           "systemctl show -P Result ifogd-diagnose.service").strip().splitlines()
        said = [line for line in lines().splitlines() if line.startswith("nose: ")]
        if result != "success" or " 02:30:" not in trigger or not said:
            raise Failure(f"the night ended with {result}, the timer fired at {trigger!r}, and said {said}")
        return said

    def check_recorded_to_the_last_second_through_a_kill(self):
        """Records a gyro on the USB line under systemd and kills the service during transmission. The recording has the sent data
        bit for bit, except the last second."""
        hertz, count, flushed_s = 200, 1600, 1.5
        self.machine.run("rm -rf /tmp/kept /var/lib/ifogd/record; "
                         # Time to look at the files before the next start closes them.
                         "mkdir -p /run/systemd/system/ifogd.service.d; printf '[Service]\\nRestartSec=5\\n' >/run/systemd/system/ifogd.service.d/late.conf; "
                         "systemctl daemon-reload; cat >/etc/ifogd/ifogd.toml <<'END'\n"
                         '[[sensor]]\nname = "usb"\ndriver = "kvh1750"\n[sensor.transport]\ntype = "serial"\ndevice = "/dev/ttyUSB0"\nbaud = 921600\n'
                         f"[sensor.options]\nrate_hz = {hertz}\n[sensor.filter]\nprocess_noise = 1e-6\nmeasurement_noise = 1e-9\n"
                         '[sensor.record]\nfolder = "/var/lib/ifogd/record"\nEND\nsystemctl restart ifogd', 60)
        self.until(lambda: self.machine.run("ls /var/lib/ifogd/record/usb 2>/dev/null || true").strip() or
                   self.machine.run("ls -l /proc/$(pidof ifogd)/fd | grep -c /dev/ttyUSB0 || true").strip() == "1", "the line is open", 20)
        line = self.lines["usb"]
        packed = [frames.kvh1750(line.next + n, hertz) for n in range(count)]
        sent = []
        stop = threading.Event()

        def send():
            begin = time.monotonic()
            for number, frame in enumerate(packed):
                time.sleep(max(0.0, begin + number / hertz - time.monotonic()))
                if stop.is_set():
                    return
                line.link.sendall(frame)
                sent.append(time.monotonic())

        sending = threading.Thread(target=send, daemon=True)
        sending.start()
        time.sleep(0.7 * count / hertz)
        killing = time.monotonic()
        self.machine.run("systemctl kill -s KILL ifogd; while pidof ifogd >/dev/null; do :; done; cp -r /var/lib/ifogd/record/usb /tmp/kept")
        stop.set()
        sending.join(30)
        line.next += len(sent)
        due = sum(at < killing - flushed_s for at in sent)
        said = self.machine.run("ls /tmp/kept; ifog replay /tmp/kept --speed 0 --to file:/tmp/kept.bin 2>&1", 60)
        kept = bytes.fromhex(self.machine.run("od -An -v -tx1 /tmp/kept.bin | tr -d ' \\n'").strip())
        everything = b"".join(packed)
        if everything[:len(kept)] != kept:
            raise Failure(f"{len(kept)} bytes recorded are not those sent: {kept[:80].hex()}")
        if len(kept) < 36 * due:
            raise Failure(f"{len(kept)} bytes recorded, {36 * due} were sent {flushed_s} s before the kill: {said}")
        if "open" not in said.split("\n")[0]:
            raise Failure(f"the killed daemon left no open file: {said}")
        self.until(lambda: self.machine.run("cd /var/lib/ifogd/record/usb; ls *.ifr 2>/dev/null || true").strip(), "the next start closes the file", 30)
        self.machine.run("rm -r /run/systemd/system/ifogd.service.d; systemctl daemon-reload")
        return (f"killed after {len(sent)} frames of {hertz} Hz: {len(kept)} bytes readable, each as sent; "
                f"{(36 * len(sent) - len(kept)) / 36 / hertz:.2f} s of the line not on the disk yet")

    def check_loop_closes_in_the_field(self):
        """Two days with an adoption."""
        self.machine.run("systemctl stop ifogd; date -s 12:00; "
                         # After the host stopped the machine, all pending data arrives at once.
                         "sysctl -q net.core.netdev_max_backlog=100000; rm -rf /var/lib/ifogd/* /run/ifog-test; mkdir -p /run/ifog-test; mkfifo -m 644 /run/ifog-test/gyro; "
                         f"cat >/etc/ifogd/ifogd.toml <<'END'\n{configuration()}END\n"
                         # The installed timer without its random delay of half an hour.
                         "mkdir -p /etc/systemd/system/ifogd-diagnose.timer.d; "
                         "printf '[Timer]\\nRandomizedDelaySec=0\\nAccuracySec=1s\\n' >/etc/systemd/system/ifogd-diagnose.timer.d/at-once.conf; "
                         "systemctl daemon-reload; systemctl start ifogd; systemctl enable --now ifogd-diagnose.timer 2>&1", 120)
        # Keeps the FIFO open between the days.
        self.machine.run("sleep 3600 <>/run/ifog-test/gyro >/dev/null 2>&1 & echo $! >/tmp/holder")
        try:
            return self.two_days()
        finally:
            self.machine.run("kill $(cat /tmp/holder); pkill -x lcm_record; systemctl disable --now ifogd-diagnose.timer 2>&1; true")

    def two_days(self):
        self.feed(1)
        self.day_is_over(1)
        first = self.night()
        if not any("proposes model" in line and "temperature_degC" in line for line in first):
            raise Failure(f"the first night proposes nothing: {first}")
        listed = self.json_of("proposals")["proposals"]
        if len(listed) != 1 or listed[0]["stale"] or self.json_of("status")["sensors"][0]["model"]:
            raise Failure(f"expected one proposal that waits and no model in use: {listed}")
        proposal = json.loads(self.machine.run("cat /var/lib/ifogd/nose.proposal.json"))
        exact, adopted = self.second_day()
        second = self.night()
        if not any(": the promise came true: " in line for line in second) or any("proposes" in line for line in second):
            raise Failure(f"the second night: {second}")
        sensor = self.json_of("status")["sensors"][0]
        if sensor["model"] != proposal["model"]["identity"] or not sensor["books"]["balanced"] or any(sensor["losses"].values()):
            raise Failure(f"status after the second day: {sensor}")
        return f"{self.better(proposal)}; {adopted}; over the adoption {exact}"

    def second_day(self):
        denoise = "ifog denoise /opt/test/day2.log --config /etc/ifogd/ifogd.toml --sensor nose --output"
        self.machine.run(f"{denoise} /tmp/without.csv", 120)
        self.machine.run("chrt -f 10 /opt/test/lcm_record 'udpm://239.255.76.67:7667?ttl=0&recv_buf_size=8000000' IFOG_NOSE /tmp/day2.lcm </dev/null >/tmp/recorder 2>&1 &\n"
                         "for i in $(seq 100); do grep -q recording /tmp/recorder && exit 0; sleep 0.1; done; exit 1")
        self.feed(2)
        self.until(lambda: self.published() > ROWS, "day 2 begins", 30)
        said = self.machine.run("ifog adopt nose --watch 6 --json /tmp/adopted.json 2>&1", 90)
        verdict = json.loads(self.machine.run("cat /tmp/adopted.json"))["verdict"]
        if verdict != "kept":
            raise Failure(f"the adoption: {verdict}: {said}")
        self.day_is_over(2)
        self.machine.run(f"pkill -TERM -x lcm_record; for i in $(seq 100); do pidof lcm_record >/dev/null || break; sleep 0.1; done; {denoise} /tmp/with.csv", 120)
        return (self.machine.run("/opt/test/log_reload /tmp/day2.lcm IFOG_NOSE /tmp/without.csv /tmp/with.csv", 60).strip(),
                "adopted while the second day ran, the promise came true")

    def better(self, proposal):
        """Gain on the second day compared with the promise, computed here from the output of the daemon's chain."""
        before, after = (rms_of_means(self.machine.run(f"cut -d, -f3 /tmp/{which}.csv", 60)) for which in ("without", "with"))
        promised = next(each for each in proposal["gain"][0]["errors"] if each["averaging_s"] == MEANS_S)
        expected = promised["after_radps"] / promised["before_radps"]
        text = (f"RMS of {MEANS_S} s means promised {promised['before_radps'] * PER_HOUR:.4f} -> {promised['after_radps'] * PER_HOUR:.4f} °/h, "
                f"second day {before * PER_HOUR:.4f} -> {after * PER_HOUR:.4f}")
        if after > 0.3 * before or abs(after / before / expected - 1.0) > RATIO_WITHIN:
            raise Failure(text)
        return text
