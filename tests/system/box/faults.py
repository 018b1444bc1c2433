# SPDX-License-Identifier: Apache-2.0
"""Faults of a navigation computer: clocks are set, interfaces and cables removed, sensors send garbage, the disk is full, a
process hangs. Checks of the box (run.py), after those that set it up."""
import random
import re
import threading
import time

import frames
from machine import Failure

# Largest error of an angle: float64 sums of some thousand increments.
ANGLE_RAD = 1e-9


def complaints(sent, got):
    """The error in a count, or nothing."""
    wrong = []
    if got["messages"] != sent:
        wrong.append(f"{got['messages']} messages of {sent} sent")
    wrong += [f"{name} {got[name]}" for name in ("missing", "out_of_order", "merged") if got.get(name)]
    return ", ".join(wrong)


class Faults:
    """Used by the box: machine, lines, counting(), send_can(), configure(), kills, pulls."""

    # --- helpers of the checks ---

    def journal_since(self, unit="ifogd"):
        """Returns a function that gives the service's log lines from now on."""
        cursor = self.machine.run("journalctl -n 0 --show-cursor -o cat | sed -n 's/^-- cursor: //p'").strip()
        return lambda: self.machine.run(f"journalctl -u {unit} --after-cursor '{cursor}' -o cat --no-pager")

    def says(self, lines, text, seconds=10):
        """Waits for a line in the log."""
        deadline = time.monotonic() + seconds
        while True:
            said = lines()
            if text in said:
                return
            if time.monotonic() > deadline:
                raise Failure(f"the log does not say {text!r} within {seconds} s: {said.strip()[-1200:]}")
            time.sleep(0.3)

    def counts(self, lines, counter, expected, seconds=10):
        """Waits until the counter has increased by this amount, logged in one line or, at the end of a second, in two."""
        deadline = time.monotonic() + seconds
        while (moved := sum(map(int, re.findall(re.escape(counter) + r" \+(\d+)", said := lines())))) < expected and time.monotonic() < deadline:
            time.sleep(0.3)
        if moved != expected:
            raise Failure(f"the log tells {counter} +{moved} within {seconds} s, expected {expected}: {said.strip()[-1200:]}")

    def restart(self):
        self.machine.run("systemctl restart ifogd", 60)
        time.sleep(1)
        return self.machine.run("systemctl show -P MainPID ifogd").strip()

    def same_process(self, pid):
        now = self.machine.run("systemctl show -P MainPID ifogd").strip()
        if now != pid:
            # The reason in one line from systemd; then the daemon's last lines.
            why = self.machine.run("{ journalctl -u ifogd _PID=1 -n 8 -o cat --no-pager; journalctl -u ifogd _PID=%s -p crit -o cat --no-pager; }" % pid)
            why = why.strip().replace("\n", "; ")
            raise Failure(f"process {pid} has become {now}: {why}\n{self.machine.run('journalctl -u ifogd -n 20 -o cat --no-pager')}")

    def all_come(self, name, count, hertz=100, paused=False):
        """Sends some samples to one sensor: each must be published. paused: the gyro has measured since the daemon's last sample,
        although nothing was sent."""
        counts = self.counting(name)
        if paused:
            self.lines[name].goes_on(count, hertz)
        elif name == "can":
            start, ended = self.send_can(count, hertz, "canplayer")
            start()
            ended()
        else:
            self.lines[name].send(count, hertz).join(60)
        time.sleep(1.5)
        got = counts()[name]
        if complaints(count, got):
            raise Failure(f"{name}: {complaints(count, got)}")

    def end_of_rubbish(self):
        """The data may end with a possible beginning of a frame; further samples show the daemon that it is none."""
        self.lines["usb"].send(5, 100).join(10)
        time.sleep(1)

    # --- the checks, in order ---

    def check_date_set_both_ways(self):
        """The angle is correct, nothing is missing, the times of day follow the clock, and the step is logged."""
        self.configure(200)
        self.restart()
        lines, counts = self.journal_since(), self.counting("serial")
        begin, count, hertz = self.lines["serial"].next, 2400, 200
        sending = self.lines["serial"].send(count, hertz)
        for step in ("+1 hour", "-3 hours", "+2 hours"):
            time.sleep(2.5)
            self.machine.run(f"date -s '{step}'")
        sending.join(60)
        time.sleep(1.5)
        got = counts()["serial"]
        expected = frames.angle(begin, count, hertz)
        if complaints(count, got) or got["gap_flags"] or abs(got["angle"] - expected) > ANGLE_RAD:
            raise Failure(f"{complaints(count, got)}; {got['gap_flags']} gaps; angle {got['angle']!r}, sent {expected!r}")
        if got["clock_steps"] != 3 or got["time_backwards"] != 1:
            raise Failure(f"{got['clock_steps']} messages flag a set clock, expected 3; {got['time_backwards']} times of day go back, expected 1")
        told = lines().count("serial: the wall clock was set")
        if told != 3:
            raise Failure(f"the log tells of {told} sets of the clock, expected 3")
        return f"3 sets, {count} of {count} samples, angle right within {abs(got['angle'] - expected):.1e} rad, flagged and told 3 times"

    def check_interface_down_up_and_removed(self):
        pid, lines = self.restart(), self.journal_since()
        for number, (gone, back) in enumerate((("ip link set vcan0 down", "ip link set vcan0 up"),
                                               ("ip link del vcan0", "ip link add vcan0 type vcan && ip link set vcan0 txqueuelen 1000 up"))):
            self.all_come("can", 200)
            self.machine.run(gone)
            self.says(lines, ("Network is down", "No such device")[number])
            self.machine.run(back)
            # The kernel shows when the daemon listens again.
            self.machine.run("for i in $(seq 100); do grep -q 'vcan0 *120' /proc/net/can/rcvlist_* && break; sleep 0.1; done; sleep 0.2; grep -q 120 /proc/net/can/rcvlist_*")
        self.all_come("can", 200)
        self.same_process(pid)
        return "every sample before, between and after, the same process"

    def check_bus_off(self):
        """vcan cannot be bus-off, so the error frame of a controller's driver is sent instead: CAN_ERR_FLAG with CAN_ERR_BUSOFF,
        followed by CAN_ERR_RESTARTED."""
        pid, lines = self.restart(), self.journal_since()
        self.machine.run("cansend vcan0 20000040#0000000000000000; cansend vcan0 20000100#0000000000000000")
        self.counts(lines, "can_error_frames", 2)
        self.all_come("can", 200)
        self.same_process(pid)
        return "2 error frames counted, every sample afterwards"

    def check_babbling_sensors(self):
        """Garbage on the USB line and a flood of its own id on the CAN bus, both at full speed: the third sensor loses nothing,
        and the two recover afterwards."""
        pid, lines = self.restart(), self.journal_since()
        rubbish = random.Random(3).randbytes(1 << 16)
        stop = time.monotonic() + 8

        def babble():
            while time.monotonic() < stop:
                self.lines["usb"].link.sendall(rubbish)

        babbling = threading.Thread(target=babble, daemon=True)
        babbling.start()
        self.machine.run("timeout 8 cangen vcan0 -g 0 -I 120 -L 8 -D r -i </dev/null >/dev/null 2>&1 &")
        self.lines["serial"].send(600, 100).join(60)
        babbling.join(60)
        self.says(lines, "bytes_skipped +", 15)
        # Both emulated processors were busy; wait until all is processed.
        said = None
        while said != (said := lines()):
            time.sleep(3)
        self.same_process(pid)
        self.end_of_rubbish()
        self.all_come("usb", 200, paused=True)
        self.says(lines, "sequence_missing +")
        self.all_come("can", 200)
        self.same_process(pid)
        # Not from the messages, because those of the flood fill the subscriber's socket.
        self.machine.run("systemctl stop ifogd", 30)
        self.says(lines, "serial: 600 samples read, 600 published, 0 missing")
        self.restart()
        flood = re.findall(r"can: (\d+) samples read", lines())[-1]
        return f"600 of 600 samples of the sensor beside a flood of {flood} frames, and every one of the two afterwards"

    def check_wrong_baud_rate(self):
        """QEMU's lines have no speed, so this makes the bytes that a UART reads at half and twice the sender's speed."""
        pid, lines = self.restart(), self.journal_since()
        line = self.lines["usb"]
        good = b"".join(frames.kvh1750(n, 100) for n in range(300))
        counts = self.counting("usb")
        for read_baud in (460800, 1843200):
            read = frames.misread(good, 921600, read_baud)
            if len(read) < 1000:
                raise Failure(f"only {len(read)} bytes are misread")
            line.link.sendall(read)
            time.sleep(1.5)
        self.says(lines, "bytes_skipped +")
        got = counts()["usb"]
        if got["messages"] != 0:
            raise Failure(f"{got['messages']} samples were made of misread bytes")
        self.end_of_rubbish()
        self.all_come("usb", 200, paused=True)
        self.says(lines, "sequence_missing +")
        self.same_process(pid)
        return "no sample made of misread bytes, which are counted; every one afterwards"

    def check_disk_full(self):
        """The daemon logs to a full journal disk, which also contains its own folder, and continues."""
        pid = self.restart()
        self.machine.run("dd if=/dev/zero of=/run/ballast bs=1M 2>/dev/null; dd if=/dev/zero of=/run/ballast2 bs=1k 2>/dev/null; true", 300)
        try:
            left = int(self.machine.run("df --output=avail /run | tail -n 1"))
            if left > 64:
                raise Failure(f"/run still has {left} kB")
            # Causes a message that the journal cannot store.
            self.lines["usb"].link.sendall(bytes(5000))
            self.end_of_rubbish()
            for name in ("serial", "usb", "can"):
                self.all_come(name, 300, paused=name == "usb")
            self.same_process(pid)
        finally:
            self.machine.run("rm -f /run/ballast /run/ballast2; systemctl restart systemd-journald")
        return f"/run full to the last {left} kB: every sample, the same process"

    def check_watchdog_ends_a_stuck_process(self):
        pid, lines = self.restart(), self.journal_since()
        restarts = int(self.machine.run("systemctl show -P NRestarts ifogd"))
        self.machine.run(f"kill -STOP {pid}")
        self.says(lines, "Failed with result 'watchdog'", 30)
        self.machine.run("for i in $(seq 100); do [ \"$(systemctl is-active ifogd)\" = active ] && break; sleep 0.1; done")
        now, after = self.machine.run("systemctl show -P MainPID ifogd; systemctl show -P NRestarts ifogd").split()
        if now in ("0", pid) or int(after) != restarts + 1:
            raise Failure(f"process {now} after {pid}, {after} restarts after {restarts}")
        time.sleep(1)
        self.all_come("serial", 200)
        return f"stopped process {pid}: result=watchdog, {now} reads on"

    def check_killed_again_and_again(self):
        """--kills: after each kill the service must restart and read."""
        took = []
        for number in range(self.kills):
            before = self.machine.run("systemctl show -P MainPID ifogd").strip()
            said = self.machine.run(
                f"t=$(date +%s%N); kill -9 {before}; for i in $(seq 300); do p=$(systemctl show -P MainPID ifogd); "
                f"[ \"$(systemctl is-active ifogd)\" = active ] && [ $p != 0 ] && [ $p != {before} ] && break; sleep 0.05; done; "
                "echo $p $((($(date +%s%N) - t) / 1000000))").split()
            if said[0] in ("0", before):
                raise Failure(f"kill {number + 1}: process {before} has become {said[0]}")
            took.append(int(said[1]) / 1000)
            time.sleep(0.5)
            if number % 5 == 4 or number == self.kills - 1:
                self.all_come("serial", 100)
        return f"{self.kills} times; back after {sorted(took)[len(took) // 2]:.2f} s (median), {max(took):.2f} s at most, in emulated time"
