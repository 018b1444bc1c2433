#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the Debian package under systemd in an emulated navigation computer: kernel, SocketCAN, serial lines.

usage: run.py BUILD PACKAGES WORK [--pulls N] [--kills N] [--seconds S] [--only WORD]...

Prints one line for each check: `ok`, `FAILED` or `skipped`, its name, and the result. --pulls: how often the USB cable is pulled
(5; the promised 100 take some ten minutes). --kills: how often the service is killed (3; promised 20). --seconds: run time of the
sensors (60). --only: checks with this word in their name, besides the necessary ones.
"""
import argparse
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import threading
import time
import traceback

import frames
from again import Again
from faults import Faults, complaints
from loop import Loop, make_days
from machine import Failure, Machine, connect

HERE = os.path.dirname(os.path.abspath(__file__))
CHANNELS = {"serial": "IFOG_SERIAL", "usb": "IFOG_USB", "can": "IFOG_CAN"}
# From the kernel's detection of the device until the daemon has it open.
SLOWEST_RETURN_S = 1.0
# 36 bytes of 10 bits each at 115200 baud make 320 frames a second at most.
SERIAL_LIMIT = 300
RATES = (200, 300, 400, 500, 700, 1000)
HIGHEST_EXPOSURE = {"ifogd": 1.8, "ifogd-diagnose": 2.0}
# Checks that prepare others.
NEEDED = ("check_systemd_comes_up", "check_package_installs", "check_virtual_can_by_networkd", "check_service_starts")


def configuration(hertz):
    """Three gyros at once. The ring is longer than on a real computer, because the host may stop this machine for a second and
    then all pending data arrives at once. Each sender is on one processor, because Linux may exchange the order of data sent
    from two. The noise is given, as by `ifog tune`, because learning it would take too long here."""
    def sensor(name, transport, options):
        return f'[[sensor]]\nname = "{name}"\ndriver = "{"dbc" if name == "can" else "kvh1750"}"\n' \
               f'[sensor.transport]\n{transport}\n[sensor.options]\n{options}\n' \
               f'[sensor.realtime]\nreader_priority = 50\nfilter_priority = 49\nring_slots = 16384\nreader_cpus = [0]\nfilter_cpus = [0]\n' \
               f'[sensor.filter]\nprocess_noise = 1e-6\nmeasurement_noise = 1e-9\n'
    return "\n".join([
        sensor("serial", 'type = "serial"\ndevice = "/dev/ttyS1"\nbaud = 115200', f'rate_hz = {min(hertz, SERIAL_LIMIT)}'),
        sensor("usb", 'type = "serial"\ndevice = "/dev/ttyUSB0"\nbaud = 921600', f'rate_hz = {hertz}'),
        sensor("can", 'type = "can"\ninterface = "vcan0"', 'dbc = "/etc/ifogd/gyro.dbc"\nsignal = "Rate"\ncounter = "Counter"\n'
               f'status = "Status"\nenvironment = "temperature_degC=Temperature"\nrate_hz = {hertz}')])


class Line:
    """The host's end of a serial line, with a continuous sequence. A pause of whole rollovers at the stated rate cannot be
    distinguished from their loss, and the daemon reports one. Therefore half a rollover passes between two transmissions."""

    def __init__(self, path):
        self.link, self.next = connect(path, 10), 0
        self.round_s = self.ended = None

    def at_rate(self, hertz):
        self.round_s = 128 / hertz

    def send_behind_silence(self, packed, hertz):
        if self.ended is not None and self.round_s is not None:
            time.sleep((self.ended - time.monotonic() + self.round_s / 2) % self.round_s)
        frames.send_paced(self.link, packed, hertz)
        self.ended = time.monotonic()

    def send(self, count, hertz):
        packed = self.pack(count, hertz)
        sending = threading.Thread(target=self.send_behind_silence, args=(packed, hertz), daemon=True)
        sending.start()
        return sending

    def pack(self, count, hertz):
        packed = [frames.kvh1750(self.next + i, hertz) for i in range(count)]
        self.next += count
        return packed

    def goes_on(self, count, hertz):
        """Sends like a gyro that has measured all the time; returns the number of samples that were not received."""
        unheard = round((time.monotonic() - self.ended) * hertz) if self.ended is not None else 0
        self.next += unheard
        frames.send_paced(self.link, self.pack(count, hertz), hertz)
        self.ended = time.monotonic()
        return unheard


class Box(Faults, Again, Loop):
    def __init__(self, build, packages, work, given):
        self.build, self.packages, self.work = build, packages, work
        self.pulls, self.kills, self.seconds = given.pulls, given.kills, given.seconds
        self.machine, self.lines = None, {}
        self.hertz = RATES[0]

    def overlay(self):
        """Files added to the image: the command port, the package, and the programs that send data and observe."""
        root = os.path.join(self.work, "overlay")
        shutil.rmtree(root, ignore_errors=True)

        def put(source, target, mode=0o644):
            target = os.path.join(root, target)
            os.makedirs(os.path.dirname(target), exist_ok=True)
            shutil.copyfile(source, target)
            os.chmod(target, mode)

        put(os.path.join(HERE, "guest", "ifog-shell"), "usr/local/sbin/ifog-shell", 0o755)
        put(os.path.join(HERE, "guest", "ifog-shell.service"), "etc/systemd/system/ifog-shell.service")
        wants = os.path.join(root, "etc/systemd/system/multi-user.target.wants")
        os.makedirs(wants)
        os.symlink("../ifog-shell.service", os.path.join(wants, "ifog-shell.service"))
        for package in glob.glob(os.path.join(self.packages, "*.deb")):
            put(package, "opt/test/" + os.path.basename(package))
        for program in ("lcm_count", "device_return", "lcm_record", "log_reload"):
            put(os.path.join(self.build, "tests/system", program), "opt/test/" + program, 0o755)
        with open(os.path.join(root, "opt/test/gyro.dbc"), "w") as file:
            file.write(frames.DBC)
        dbc, *days = make_days(self.build, self.work)
        put(dbc, "opt/test/slow_gyro.dbc")
        for day in days:
            put(day, "opt/test/" + os.path.basename(day))
        return root

    def configure(self, hertz):
        self.hertz = hertz
        self.lines["usb"].at_rate(hertz)
        self.lines["serial"].at_rate(min(hertz, SERIAL_LIMIT))
        self.machine.run(f"cat >/etc/ifogd/ifogd.toml <<'END'\n{configuration(hertz)}\nEND")

    def counting(self, *names, seconds=600):
        """Starts the subscriber in the machine; the returned function ends it and returns its counts."""
        channels = " ".join(CHANNELS[name] for name in names)
        self.machine.run(f"rm -f /tmp/count; (/opt/test/lcm_count {seconds} {channels} >/tmp/count.part 2>&1; mv /tmp/count.part /tmp/count) "
                         "</dev/null >/dev/null 2>&1 &\nfor i in $(seq 50); do pgrep -x lcm_count >/dev/null && break; sleep 0.1; done; sleep 0.5")

        def counts():
            said = self.machine.run("pkill -TERM -x lcm_count; for i in $(seq 100); do [ -e /tmp/count ] && break; sleep 0.1; done; cat /tmp/count")
            got = json.loads(said)
            return {name: got.get(CHANNELS[name], {"messages": 0}) for name in names}

        return counts

    def send_can(self, count, hertz, player):
        """Sends frames to vcan0 with `canplayer` or `ifog replay`; returns a function that waits for the end."""
        self.machine.run(f"cat >/tmp/can.log <<'END'\n{frames.candump(count, hertz, 'vcan0')}END", 120)
        command = {"canplayer": "canplayer -I /tmp/can.log", "ifog replay": "ifog replay /tmp/can.log --to can:vcan0"}[player]

        def started():
            # On one processor, because vcan may exchange frames sent from two.
            self.machine.run(f"rm -f /tmp/played; (taskset -c 0 chrt -f 60 {command}; echo $? >/tmp/played) </dev/null >/tmp/player 2>&1 &")

        def ended():
            self.machine.run(f"for i in $(seq {int(count / hertz) + 60}); do [ -e /tmp/played ] && break; sleep 1; done; "
                             "[ \"$(cat /tmp/played)\" = 0 ] || { cat /tmp/player; exit 1; }", count / hertz + 100)

        return started, ended

    def all_sensors(self, seconds, hertz, player):
        """Sends for some seconds on every line; returns the sent and received counts by sensor."""
        slow = min(hertz, SERIAL_LIMIT)
        counts = self.counting(*CHANNELS)
        start, ended = self.send_can(int(seconds * hertz), hertz, player)
        start()
        sending = [self.lines["serial"].send(int(seconds * slow), slow), self.lines["usb"].send(int(seconds * hertz), hertz)]
        ended()
        for thread in sending:
            thread.join(300)
        # Data that the machine has not read yet; the host may be faster.
        time.sleep(5)
        sent = {"serial": int(seconds * slow), "usb": int(seconds * hertz), "can": int(seconds * hertz)}
        return {name: (sent[name], got) for name, got in counts().items()}

    # --- the checks, in order ---

    def check_systemd_comes_up(self):
        state = self.machine.run("systemctl is-system-running --wait", 400, check=False).strip()
        if state != "running":
            raise Failure(f"the system is {state}, expected running: " + self.machine.run("systemctl --failed --no-legend", check=False))
        # LCM needs a route for its multicast; here it must not leave the machine.
        # The receive buffer is what LCM's documentation advises for receivers.
        self.machine.run("ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo; "
                         "sysctl -q net.core.rmem_max=8388608 net.core.rmem_default=8388608")
        return self.machine.run("uname -r").strip()

    def check_package_installs(self):
        names = "ifogd ifog ifogd-dev ifog-drivers"
        self.machine.run("dpkg -i /opt/test/*.deb", 300)
        # The service is not enabled before it is configured. Removal leaves only the user, and installation works again.
        self.machine.run("! systemctl is-enabled --quiet ifogd && systemctl enable --quiet ifogd && systemctl is-enabled --quiet ifogd")
        self.machine.run(f"dpkg -P {names} && ! systemctl cat ifogd >/dev/null 2>&1 && ! find /usr/lib /usr/bin /usr/share /etc/systemd -name '*ifog*' "
                         "! -path '/usr/local/*' ! -name 'ifog-shell*' | grep .", 300)
        self.machine.run("dpkg -i /opt/test/*.deb", 300)
        self.machine.run("install -D -m 644 /opt/test/gyro.dbc /etc/ifogd/gyro.dbc")
        return self.machine.run(f"dpkg-query -W {names}; id ifogd").strip().replace("\n", ", ")

    def check_virtual_can_by_networkd(self):
        self.machine.run("cp /usr/share/doc/ifogd/examples/network/80-ifogd-vcan0.* /etc/systemd/network/ && systemctl start systemd-networkd && "
                         "for i in $(seq 100); do ip -br link show vcan0 2>/dev/null | grep -q UP && break; sleep 0.2; done; ip -br link show vcan0 | grep UP", 200)
        return self.machine.run("(sleep 5; cansend vcan0 123#1122334455667788) & timeout 30 candump -n 1 vcan0").strip()

    def check_unit_verifies(self):
        # The image has no man; the package test checks the pages.
        said = self.machine.run("systemd-analyze verify --man=no ifogd.service ifogd-diagnose.timer ifogd-diagnose.service 2>&1", 60).strip()
        if said:
            raise Failure(said)
        return "systemd-analyze verify has nothing to say"

    def check_exposure(self):
        levels = []
        for unit, highest in HIGHEST_EXPOSURE.items():
            said = self.machine.run(f"systemd-analyze security --offline=true /usr/lib/systemd/system/{unit}.service --no-pager | tail -n 1", 200)
            levels.append(float(re.search(r"([0-9.]+) [A-Z]+", said).group(1)))
            if levels[-1] > highest:
                raise Failure(f"exposure of {unit} {levels[-1]}, expected at most {highest}")
        return f"exposure {levels[0]}, of the night {levels[1]}"

    def check_wrong_configuration_is_one_line(self):
        self.machine.run("printf '[[sensor]]\\nname = \"a\"\\ndriver = \"kvh1750\"\\nspeed = 3\\n[sensor.transport]\\ntype = \"can\"\\ninterface = \"vcan0\"\\n' >/tmp/wrong.toml")
        said = self.machine.run("ifogd --config /tmp/wrong.toml --check; echo exit $?", check=False).strip().splitlines()
        if said[-1] == "exit 0" or not any("wrong.toml:4" in line and "speed" in line for line in said):
            raise Failure(f"expected a line that names wrong.toml:4 and speed, and a non-zero exit; got {said}")
        return said[0]

    def check_service_starts(self):
        self.configure(RATES[0])
        self.machine.run("systemctl start ifogd", 200)
        properties = dict(line.split("=", 1) for line in self.machine.run(
            "systemctl show ifogd -p Type -p ActiveState -p SubState -p User -p MainPID -p WatchdogUSec").split())
        if (properties["Type"], properties["ActiveState"], properties["SubState"]) != ("notify", "active", "running"):
            raise Failure(f"{properties}")
        threads = self.machine.run(f"chrt -a -p {properties['MainPID']} | grep -c SCHED_FIFO || true").strip()
        if int(threads) < 2 * len(CHANNELS):
            raise Failure(f"{threads} threads run under SCHED_FIFO, expected two a sensor")
        return f"Type=notify, user {properties['User']}, {threads} threads under SCHED_FIFO, watchdog {properties['WatchdogUSec']}"

    def complains(self, hertz):
        """Errors of a short run at this rate, by sensor; empty if every sample was received."""
        self.configure(hertz)
        self.machine.run("systemctl restart ifogd", 200)
        time.sleep(1)
        result = self.all_sensors(6, hertz, "canplayer")
        return "; ".join(f"{name}: {wrong}" for name, each in result.items() if (wrong := complaints(*each)))

    def check_highest_rate(self):
        """Not checked above 200 Hz: finds the rate of the long runs, from above."""
        wrong = self.complains(RATES[0])
        if wrong:
            raise Failure(wrong)
        carried = next((hertz for hertz in reversed(RATES[1:]) if not self.complains(hertz)), RATES[0])
        # The long runs use the next lower rate, because of the host's other work.
        self.hertz = max((rate for rate in RATES if rate < carried), default=RATES[0])
        self.configure(self.hertz)
        self.machine.run("systemctl restart ifogd", 200)
        return f"{carried} Hz on USB and CAN, {min(carried, SERIAL_LIMIT)} Hz on the 8250"

    def long_run(self, player):
        """The highest rate without losses, from the one that the probes suggest down to 200 Hz. It depends on other work of the
        host; losses are printed."""
        lost = []
        for hertz in sorted((rate for rate in RATES if rate <= self.hertz), reverse=True):
            if lost:
                self.configure(hertz)
                self.machine.run("systemctl restart ifogd", 200)
                time.sleep(1)
            result = self.all_sensors(self.seconds, hertz, player)
            wrong = [f"{name}: {complaints(*each)}" for name, each in result.items() if complaints(*each)]
            if not wrong:
                self.hertz = hertz
                return f"at {hertz} Hz for {self.seconds:.0f} s: " + ", ".join(
                    f"{name} {sent} of {sent}" for name, (sent, _) in result.items()) + "".join(f"; {each}" for each in lost)
            lost.append(f"not carried at {hertz} Hz ({', '.join(wrong)})")
        raise Failure("; ".join(lost))

    def check_every_sample_with_canplayer(self):
        return self.long_run("canplayer")

    def check_every_sample_with_ifog_replay(self):
        return self.long_run("ifog replay")

    def check_killed_service_is_back(self):
        before, restarts = self.machine.run("systemctl show -P MainPID ifogd; systemctl show -P NRestarts ifogd").split()
        self.machine.run(f"kill -9 {before}")
        took = self.machine.run("for i in $(seq 300); do p=$(systemctl show -P MainPID ifogd); [ \"$(systemctl is-active ifogd)\" = active ] && "
                                f"[ $p != 0 ] && [ $p != {before} ] && break; sleep 0.1; done; systemctl show -P MainPID ifogd; systemctl show -P NRestarts ifogd").split()
        if took[0] in ("0", before) or int(took[1]) != int(restarts) + 1:
            raise Failure(f"main process and restarts are {took}, before {before} and {restarts}")
        counts = self.counting("serial")
        self.lines["serial"].send(200, 200).join(30)
        time.sleep(1)
        got = counts()["serial"]
        if complaints(200, got):
            raise Failure(complaints(200, got))
        return f"pid {before} killed, {took[0]} reads on"

    def check_pulled_cable_is_back(self):
        self.machine.run("/opt/test/device_return /dev/ttyUSB0 ifogd </dev/null >/tmp/returns 2>&1 & echo $! >/tmp/returns.pid")
        # At the stated rate, because at another one the duration of a rollover is wrong.
        # One subscriber for all pulls: whole rollovers are reported only after the following data has excluded a delay.
        counts, unheard = self.counting("usb", seconds=3600), 0
        self.lines["usb"].send(200, self.hertz).join(60)  # interrupted by the first pull
        for _ in range(self.pulls):
            self.machine.pull("usbserial")
            self.machine.run("for i in $(seq 100); do [ -e /dev/ttyUSB0 ] || break; sleep 0.1; done; [ ! -e /dev/ttyUSB0 ]")
            self.machine.plug("usb-serial", id="usbserial", chardev="usbline", **{"always-plugged": True})
            # The daemon has the line again when the kernel counts its open file.
            self.machine.run("for i in $(seq 300); do ls -l /proc/$(pidof ifogd)/fd | grep -q /dev/ttyUSB0 && break; sleep 0.1; done")
            unheard += self.lines["usb"].goes_on(200, self.hertz)
            time.sleep(0.5)  # QEMU 7.2 crashes if bytes wait for a device that is removed
        # Idle until it is certain that no resource is leaking.
        unheard += self.lines["usb"].goes_on(1000, self.hertz)
        time.sleep(1)
        got = counts()["usb"]
        missing = got.pop("missing", 0)
        wrong = complaints(200 * (self.pulls + 1) + 1000, got)
        if wrong or missing != unheard:
            raise Failure(f"{wrong or 'every sample sent'}; {missing} told as missing of {unheard} that were measured while it was pulled")
        self.machine.run("kill $(cat /tmp/returns.pid)")
        took = [float(line) for line in self.machine.run("cat /tmp/returns").split()]
        if len(took) != self.pulls:
            raise Failure(f"{len(took)} returns were seen of {self.pulls}")
        if max(took) > SLOWEST_RETURN_S:
            raise Failure(f"back {max(took):.2f} s after the kernel had the device, expected at most {SLOWEST_RETURN_S} s")
        return (f"{self.pulls} pulls, every sample afterwards and each of the {unheard} before told as missing; open again after the device was there: "
                f"median {sorted(took)[len(took) // 2]:.3f} s, at most {max(took):.3f} s")

    def check_stop_drains(self):
        count = 2000
        counts = self.counting("can")
        start, ended = self.send_can(count, 5 * self.hertz, "canplayer")
        start()
        ended()
        self.machine.run("systemctl stop ifogd", 30)
        got = counts()["can"]
        if complaints(count, got):
            raise Failure(complaints(count, got))
        result = self.machine.run("systemctl show -P Result ifogd").strip()
        if result != "success":
            raise Failure(f"the service ended with {result}")
        return f"{count} frames, stopped at once, all published"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for what in ("build", "packages", "work"):
        parser.add_argument(what)
    parser.add_argument("--pulls", type=int, default=5)
    parser.add_argument("--kills", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--only", action="append")
    given = parser.parse_args()
    build, packages, work = given.build, given.packages, given.work
    os.makedirs(work, exist_ok=True)
    image = os.path.join(work, "image")
    subprocess.run([os.path.join(HERE, "make_image"), image], check=True, timeout=900)
    box = Box(build, packages, work, given)
    checks = [name for part in (Box, Faults, Again, Loop) for name in vars(part) if name.startswith("check_")]
    wanted = [name for name in checks if name in NEEDED or not given.only or any(word in name for word in given.only)]
    passed = failed = 0
    box.machine = Machine(image, box.overlay(), os.path.join(work, "machine"))
    try:
        box.lines = {"serial": Line(box.machine.path("ttyS1")), "usb": Line(box.machine.path("ttyUSB0"))}
        for name in wanted:
            title = name.removeprefix("check_").replace("_", " ")
            began = time.monotonic()
            try:
                seen = getattr(box, name)()
                passed += 1
                print(f"ok       {title}: {seen} ({time.monotonic() - began:.0f} s)", flush=True)
            except Exception as error:  # pylint: disable=broad-except
                failed += 1
                what = str(error) if isinstance(error, Failure) else traceback.format_exc()
                print(f"FAILED   {title}: {what}", flush=True)
                if box.machine.process.poll() is not None or "systemd comes up" in title or "package installs" in title:
                    print("the machine is not usable; the other checks were not made", flush=True)
                    break
    finally:
        if box.machine.process.poll() is None:
            try:
                with open(os.path.join(work, "journal.txt"), "w") as file:
                    file.write(box.machine.run("journalctl -b --no-pager -o short-monotonic", 120, check=False))
            except Failure:
                pass
        box.machine.stop()
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
