# SPDX-License-Identifier: Apache-2.0
"""Replays a flight recording to a serial line: the output is the recorded data, each delivery at its time, and a daemon that
reads it publishes the angle of the first run. Checks of the box (run.py)."""
import json
import os
import sys
import threading
import time

import frames
from machine import Failure

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import flight_file  # noqa: E402

HERTZ, COUNT = 50, 425  # not a whole number of the motion's periods, whose angle would be zero
ANGLE_RAD = 1e-12
# The emulated processor is slower by a factor of 1000, and the host sometimes stops it for a while; the share allows for that.
# the share allows.
ON_TIME_S, ON_TIME_SHARE, MEDIAN_S = 0.02, 0.95, 0.01


def sensor(name, device, baud, record):
    return (f'[[sensor]]\nname = "{name}"\ndriver = "kvh1750"\n[sensor.transport]\ntype = "serial"\ndevice = "{device}"\nbaud = {baud}\n'
            f"[sensor.options]\nrate_hz = {HERTZ}\n[sensor.filter]\nprocess_noise = 1e-6\nmeasurement_noise = 1e-9\n"
            "[sensor.realtime]\nreader_priority = 50\nfilter_priority = 49\nreader_cpus = [0]\nfilter_cpus = [0]\n"
            + ('[sensor.record]\nfolder = "/var/lib/ifogd/record"\n' if record else ""))


class Again:
    """Used by the box: machine, lines, counting(), until()."""

    def of_one_line(self, name, text):
        self.machine.run("systemctl stop ifogd; cat >/etc/ifogd/ifogd.toml <<'END'\n" + text + "END\nsystemctl start ifogd", 60)
        device = {"usb": "/dev/ttyUSB0", "serial": "/dev/ttyS1"}[name]
        self.until(lambda: self.machine.run(f"ls -l /proc/$(pidof ifogd)/fd | grep -c {device} || true").strip() == "1", "the line is open", 20)

    def relay(self, stop, came):
        """Copies the output of the USB line to the other line and records the times."""
        self.lines["usb"].link.settimeout(0.2)
        try:
            while not stop.is_set():
                try:
                    got = self.lines["usb"].link.recv(65536)
                except TimeoutError:
                    continue
                came.append((time.monotonic(), got))
                self.lines["serial"].link.sendall(got)
        finally:
            self.lines["usb"].link.settimeout(None)

    def unevenly(self, packed):
        begin = time.monotonic()
        for number, frame in enumerate(packed):
            due = begin + number / HERTZ + frames.late_by(number, 1 / HERTZ)
            time.sleep(max(0.0, due - time.monotonic()))
            self.lines["usb"].link.sendall(frame)

    def check_recording_sent_again_onto_a_serial_line(self):
        # First run: recorded from the USB line.
        self.machine.run("systemctl stop ifogd; rm -rf /var/lib/ifogd/record /tmp/again")
        self.of_one_line("usb", sensor("usb", "/dev/ttyUSB0", 921600, True))
        counts, line = self.counting("usb"), self.lines["usb"]
        begin, packed = line.next, [frames.kvh1750(line.next + n, HERTZ) for n in range(COUNT)]
        line.next += COUNT
        self.unevenly(packed)
        time.sleep(2)
        first = counts()["usb"]
        self.machine.run("systemctl stop ifogd; cp -r /var/lib/ifogd/record/usb /tmp/again", 30)
        recorded = []
        for name in self.machine.run("ls /tmp/again").split():
            content = bytes.fromhex(self.machine.run(f"od -An -v -tx1 /tmp/again/{name} | tr -d ' \\n'").strip())
            recorded += [(time_ns / 1e9, payload) for time_ns, _, payload in flight_file.deliveries(content)]
        sent = b"".join(packed)
        if b"".join(payload for _, payload in recorded) != sent:
            raise Failure(f"{sum(len(payload) for _, payload in recorded)} bytes in the recording are not the {len(sent)} sent")

        # Second run: sent on the USB line, and received by a daemon on the other one.
        self.of_one_line("serial", sensor("serial", "/dev/ttyS1", 115200, False))
        counts, stop, came = self.counting("serial"), threading.Event(), []
        relaying = threading.Thread(target=self.relay, args=(stop, came), daemon=True)
        relaying.start()
        self.machine.run("taskset -c 1 ifog replay /tmp/again --to serial:/dev/ttyUSB0 --realtime --json /tmp/again.json", 120)
        time.sleep(2)
        stop.set()
        relaying.join(10)
        second = counts()["serial"]
        report = json.loads(self.machine.run("cat /tmp/again.json"))
        if b"".join(got for _, got in came) != sent:
            raise Failure(f"{sum(len(got) for _, got in came)} bytes came out of the line, not the {len(sent)} recorded")
        expected = frames.angle(begin, COUNT, HERTZ)
        for which, count in (("first", first), ("second", second)):
            if count["messages"] != COUNT or count["missing"] or abs(count["angle"] - expected) > ANGLE_RAD:
                raise Failure(f"{which} daemon: {count}, the angle sent is {expected!r}")
        if second["angle"] != first["angle"]:
            raise Failure(f"the angle is {second['angle']!r} of what was sent again, {first['angle']!r} the first time")
        late = frames.off_time(recorded, list(self.arrivals(recorded, came)))
        on_time, median = sum(each <= ON_TIME_S for each in late) / len(late), sorted(late)[len(late) // 2]
        text = (f"{len(sent)} bytes in {len(recorded)} deliveries as recorded, {100 * on_time:.1f} % within {ON_TIME_S * 1e3:g} ms of when they came (median "
                f"{median * 1e3:.1f} ms, at most {max(late) * 1e3:.0f}; the program's own lateness {report['lateness_us']['p50'] / 1e3:.1f} ms median); "
                f"angle {second['angle']!r} rad both times, {abs(second['angle'] - expected):.1e} from what was sent")
        if on_time < ON_TIME_SHARE or median > MEDIAN_S:
            raise Failure(text)
        return text

    @staticmethod
    def arrivals(recorded, came):
        """Arrival time of the last byte of each delivery."""
        end = here = 0
        pieces = iter(came)
        for _, payload in recorded:
            end += len(payload)
            while here < end:
                at, got = next(pieces)
                here += len(got)
            yield (at,)
